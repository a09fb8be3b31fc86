//! Telling a weight that nobody told of from somebody who pushes.

use nalgebra::Vector3;

/// How long a force must last to be a weight \[s\]: longer than somebody leans on a robot that has just given way.
const LASTS: f64 = 1.5;
/// How far from straight down it may point \[-\]: the sine of 20°.
const ASIDE: f64 = 0.34;
/// How far it may differ from its mean, as a share of that.
const VARIES: f64 = 0.2;
/// \[m/s²\]
const GRAVITY: f64 = 9.81;

/// Watches the force at the tool of a robot that gives way: one that points down and lasts is the weight of something.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct PayloadWatch {
    mean: Vector3<f64>,
    /// How long the force has been like its mean \[s\].
    lasts: f64,
}

impl PayloadWatch {
    /// Takes the force of a tick \[N, world\], none for a robot that does not give way, `period` \[s\] after the one before.
    /// Returns the mass that explains it \[kg\], if it is a weight.
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
        // A mean over the last second or so, however long it lasts.
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
