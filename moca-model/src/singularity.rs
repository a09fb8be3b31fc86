//! Slowdown near singular configurations. There a small motion of the tool needs large joint motions, and the arm would
//! oscillate at its limits.

use nalgebra::{Matrix6, Matrix6xX};

/// Manipulability below which a posture counts as singular; it is then rounding.
pub(crate) const SINGULAR: f64 = 1e-6;

/// Share of the posture's manipulability below which joints slow down. MOCA has less only with a nearly stretched arm.
const SLOWS_BELOW: f64 = 0.35;
/// Least share of their speeds that joints keep, so that they can leave a singular configuration.
const SLOWEST: f64 = 0.05;

/// The share of their speeds that joints may use at this share of the posture's manipulability. NaN counts as singular.
pub(crate) fn speed_scale(share: f64) -> f64 {
    if share > 0.0 { (share / SLOWS_BELOW).clamp(SLOWEST, 1.0) } else { SLOWEST }
}

/// Yoshikawa's manipulability w = √det(J Jᵀ), 0 in singular configurations up to rounding (Int. J. Robotics Research
/// 4(2), 1985).
///
/// The Jacobian is that of the tool for all joints, 6 × n, linear, then angular \[m/s, rad/s\].
pub fn manipulability(jacobian: &Matrix6xX<f64>) -> f64 {
    manipulability_behind(jacobian, 0)
}

/// The manipulability of the joints behind the first ones alone.
pub(crate) fn manipulability_behind(jacobian: &Matrix6xX<f64>, first: usize) -> f64 {
    let mut gram = Matrix6::zeros();
    for column in jacobian.column_iter().skip(first) {
        gram.ger(1.0, &column, &column, 1.0);
    }
    gram.cholesky().map_or(0.0, |factor| factor.l_dirty().diagonal().product())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn joints_slow_down_with_the_manipulability() {
        for (share, scale) in
            [(0.8, 1.0), (0.175, 0.5), (0.01, 0.05), (0.0, 0.05), (f64::NAN, 0.05)]
        {
            assert!((speed_scale(share) - scale).abs() < 1e-12, "{share}");
        }
    }
}
