//! The arm whose hand holds a tool.

use nalgebra::Vector3;

/// Lengths as fractions of stature (Drillis & Contini, 1966); the last one is from the wrist to the centre of the grip.
pub(super) const UPPER_ARM: f64 = 0.186;
pub(super) const FOREARM: f64 = 0.146;
const GRIP: f64 = 0.055;

/// Share of its length to which an arm is stretched, since it is not locked.
pub(super) const STRETCHED: f64 = 0.99;

/// Direction in which the elbow hangs, in the person's frame; 1 is left and −1 right.
pub(super) fn elbow_side(side: f64) -> Vector3<f64> {
    Vector3::new(-0.3, 0.4 * side, -1.0)
}

/// An arm from the shoulder to the centre of the grip, with a straight wrist.
///
/// ```
/// use simulated_people::Arm;
/// use nalgebra::Vector3;
///
/// let arm = Arm::of_stature(1.75);
/// let (shoulder, object) = (Vector3::new(0.0, -0.2, 1.4), Vector3::new(0.4, -0.1, 1.1));
/// let [elbow, wrist] = arm.leading_to(&object, &shoulder, &-Vector3::z());
/// assert!((elbow - shoulder).norm() < 0.33 && elbow.z < wrist.z);
/// // The grip is at the object, as far from the wrist as a hand is long.
/// assert!(((object - wrist).norm() - 0.055 * 1.75).abs() < 1e-12);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arm {
    upper: f64,
    forearm: f64,
    grip: f64,
}

impl Arm {
    /// Creates the arm of an average person of this stature \[m\].
    pub fn of_stature(stature: f64) -> Self {
        Self { upper: UPPER_ARM * stature, forearm: FOREARM * stature, grip: GRIP * stature }
    }

    /// The largest distance of the grip from the shoulder \[m\].
    pub fn reach(&self) -> f64 {
        STRETCHED * (self.upper + self.forearm + self.grip)
    }

    /// Elbow and wrist for the grip at a point, or as far towards it as the arm reaches \[m\]. The elbow is on the side
    /// of the direction `aside`.
    pub fn leading_to(
        &self,
        grip: &Vector3<f64>,
        shoulder: &Vector3<f64>,
        aside: &Vector3<f64>,
    ) -> [Vector3<f64>; 2] {
        let hand = self.forearm + self.grip;
        let grip = shoulder + (grip - shoulder).cap_magnitude(self.reach());
        let elbow = bend(*shoulder, grip, self.upper, hand, *aside);
        [elbow, elbow + (grip - elbow) * (self.forearm / hand)]
    }

    /// The place of the grip for this elbow and wrist \[m\].
    pub fn grip(&self, elbow: &Vector3<f64>, wrist: &Vector3<f64>) -> Vector3<f64> {
        wrist + (wrist - elbow).try_normalize(1e-9).unwrap_or_default() * self.grip
    }
}

/// The middle joint of two segments between `root` and `tip`, on the side of `towards`.
pub(super) fn bend(
    root: Vector3<f64>,
    tip: Vector3<f64>,
    first: f64,
    second: f64,
    towards: Vector3<f64>,
) -> Vector3<f64> {
    let span = tip - root;
    let length = span.norm().clamp(1e-6, first + second);
    let axis = span / span.norm().max(1e-6);
    let along = (length * length + first * first - second * second) / (2.0 * length);
    let out = (first * first - along * along).max(0.0).sqrt();
    let normal = (towards - axis * axis.dot(&towards)).try_normalize(1e-9).unwrap_or_default();
    root + axis * along + normal * out
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn point(reach: f64) -> impl Strategy<Value = Vector3<f64>> {
        prop::array::uniform3(-reach..reach).prop_map(Vector3::from)
    }

    proptest! {
        #[test]
        fn grip_reaches_as_near_as_possible(
            stature in 1.5..2.0_f64, shoulder in point(2.0), away in point(1.0),
        ) {
            let (arm, object) = (Arm::of_stature(stature), shoulder + away);
            // Nobody works with the hand at the shoulder.
            prop_assume!(away.norm() > 0.15);
            let [elbow, wrist] = arm.leading_to(&object, &shoulder, &Vector3::y());
            prop_assert!(((elbow - shoulder).norm() - arm.upper).abs() < 1e-9);
            prop_assert!(((wrist - elbow).norm() - arm.forearm).abs() < 1e-9);
            let left = (object - arm.grip(&elbow, &wrist)).norm();
            prop_assert!((left - (away.norm() - arm.reach()).max(0.0)).abs() < 1e-9, "{left}");
        }
    }
}
