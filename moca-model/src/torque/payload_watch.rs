//! Detection of an undeclared payload.

use nalgebra::Vector3;

/// Time for which a force must last to be a weight \[s\]. A person leans on a robot that yields for a shorter time.
const LASTS: f64 = 1.5;
/// Largest deviation from vertical \[-\]: the sine of 20°.
const ASIDE: f64 = 0.34;
/// Largest deviation from its mean, as a share of that.
const VARIES: f64 = 0.2;
/// \[m/s²\]
const GRAVITY: f64 = 9.81;

/// Watches the force at the tool of a robot that yields. A lasting downward force is the weight of a payload.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct PayloadWatch {
    mean: Vector3<f64>,
    /// Time for which the force has been close to its mean \[s\].
    lasts: f64,
}

impl PayloadWatch {
    /// Takes the force of a tick \[N, world\], `period` \[s\] after the last one; `None` for a robot that does not
    /// yield. Returns the mass that explains it \[kg\], if it is a weight.
    pub(crate) fn update(&mut self, force: Option<&Vector3<f64>>, period: f64) -> Option<f64> {
        let Some(force) = force else {
            *self = Self::default();
            return None;
        };
        let is_like_before = (force - self.mean).norm() <= VARIES * self.mean.norm();
        let points_down = force.z < 0.0 && force.xy().norm() <= ASIDE * force.norm();
        if !(is_like_before && points_down) {
            *self = Self { mean: *force, lasts: 0.0 };
            return None;
        }
        self.lasts += period;
        // The mean is over about the last second.
        let share = period / self.lasts.min(1.0);
        self.mean += (force - self.mean) * share;
        (self.lasts >= LASTS).then_some(-self.mean.z / GRAVITY)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn watched(force: impl Fn(f64) -> Vector3<f64>, time: f64) -> Option<f64> {
        let mut watch = PayloadWatch::default();
        let mut mass = None;
        let mut now = 0.0;
        while now < time {
            mass = watch.update(Some(&force(now)), 1e-3);
            now += 1e-3;
        }
        mass
    }

    #[test]
    fn a_weight_is_told_with_its_mass() {
        let weight = |now: f64| Vector3::new(2.0, 0.0, -49.05 + 3.0 * (40.0 * now).sin());
        assert_eq!(watched(weight, 1.0), None);
        let mass = watched(weight, 2.0).unwrap();
        assert!((mass - 5.0).abs() < 0.1, "{mass}");
    }

    #[test]
    fn a_push_is_no_weight() {
        assert_eq!(watched(|_| Vector3::new(60.0, 0.0, -20.0), 5.0), None, "aside");
        assert_eq!(watched(|_| Vector3::new(0.0, 0.0, 70.0), 5.0), None, "upwards");
        let leans = |now: f64| Vector3::new(0.0, 0.0, -60.0 * (0.5 + 0.5 * (6.0 * now).sin()));
        assert_eq!(watched(leans, 5.0), None, "it varies");
    }
}
