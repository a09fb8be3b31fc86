//! Rotation vectors: the logarithm on SO(3) and its derivative.

use nalgebra::{Matrix3, UnitQuaternion, Vector3};

/// Returns log(R), the rotation vector of `rotation` with an angle in [0, π] \[rad\].
///
/// ```
/// use ahqp_core::rotation_log;
/// use nalgebra::{UnitQuaternion, Vector3};
///
/// let turn = Vector3::new(0.0, 0.0, 0.3);
/// assert!((rotation_log(&UnitQuaternion::from_scaled_axis(turn)) - turn).norm() < 1e-15);
/// ```
pub fn rotation_log(rotation: &UnitQuaternion<f64>) -> Vector3<f64> {
    let vector = rotation.imag();
    let (sine, cosine) = (vector.norm(), rotation.scalar());
    if sine == 0.0 {
        return Vector3::zeros();
    }
    // q and −q are the same rotation. This takes the smaller angle.
    let (sine_signed, cosine) = if cosine < 0.0 { (-sine, -cosine) } else { (sine, cosine) };
    vector * (2.0 * sine_signed.atan2(cosine) / sine)
}

/// Returns J_l⁻¹(φ), the inverse left Jacobian of SO(3). φ̇ = J_l⁻¹(φ) ω for R = exp(φ) that turns
/// at ω in the fixed frame \[rad, rad/s\].
///
/// It is finite for |φ| < 2π. See e.g. Solà, Deray, Atchuthan, "A micro Lie theory for state
/// estimation in robotics", eq. 146.
pub fn left_jacobian_inverse(rotation_vector: &Vector3<f64>) -> Matrix3<f64> {
    let cross = rotation_vector.cross_matrix();
    let angle = rotation_vector.norm();
    let factor = if angle < 1e-4 {
        1.0 / 12.0 + angle * angle / 720.0
    } else {
        let half = 0.5 * angle;
        (1.0 - half * half.cos() / half.sin()) / (angle * angle)
    };
    Matrix3::identity() - 0.5 * cross + factor * cross * cross
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn vector(size: f64) -> impl Strategy<Value = Vector3<f64>> {
        prop::array::uniform3(-1.0..1.0_f64).prop_map(move |v| Vector3::from(v) * size)
    }

    proptest! {
        #[test]
        fn the_logarithm_undoes_the_exponential(v in vector(1.8)) {
            let rotation = UnitQuaternion::from_scaled_axis(v);
            prop_assert!((rotation_log(&rotation) - v).norm() < 1e-12);
            let other_cover = UnitQuaternion::new_unchecked(-rotation.into_inner());
            prop_assert!((rotation_log(&other_cover) - v).norm() < 1e-12);
        }

        #[test]
        fn the_inverse_left_jacobian_is_the_derivative(v in vector(1.7), omega in vector(1.0)) {
            let step = 1e-6;
            let rotation = UnitQuaternion::from_scaled_axis(v);
            let at = |h: f64| rotation_log(&(UnitQuaternion::from_scaled_axis(omega * h) * rotation));
            let difference = (at(step) - at(-step)) / (2.0 * step);
            prop_assert!((left_jacobian_inverse(&v) * omega - difference).norm() < 1e-7);
        }

        #[test]
        fn small_angles_join_smoothly(v in vector(1.0)) {
            prop_assume!(v.norm() > 1e-3);
            let (below, above) = (v.normalize() * 0.99999e-4, v.normalize() * 1.00001e-4);
            let gap = left_jacobian_inverse(&below) - left_jacobian_inverse(&above);
            prop_assert!(gap.norm() < 1e-8);
        }
    }
}
