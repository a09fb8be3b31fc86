//! Where one camera frame says that the person stands, and which way the person faces.

use nalgebra::{Matrix2, Matrix3, Vector2, Vector3, vector};

use super::{
    filter::Measurement,
    keypoints::{Body, Body25},
    lean::LeanInWorld,
    settings::TrackerSettings,
};

/// Further from the origin nothing is a person in a room (m).
const FARTHEST: f64 = 1e3;

/// Below this length the line through shoulders and hips has no direction to speak of (m).
const SHORTEST_LEFT: f64 = 0.05;

/// A covariance with a larger variance than this says nothing (m²).
const VAGUE: f64 = 10.0;

/// The joints of a body that can be trusted.
pub(super) struct Seen<'body> {
    body: &'body Body,
    least_confidence: f64,
    /// Where no covariance is known (m).
    position_sigma: f64,
    /// What errors that last from frame to frame make of a covariance.
    inflation: f64,
}

/// A point in the frame: where it is and, where known, how well (m, m²).
#[derive(Clone, Copy, Debug)]
pub(super) struct Joint {
    pub(super) position: Vector3<f64>,
    pub(super) covariance: Option<Matrix3<f64>>,
}

/// A heading in one frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Heading {
    /// In (-π, π] (rad).
    pub(super) angle: f64,
    /// Where it is known (rad²).
    pub(super) variance: Option<f64>,
}

impl<'body> Seen<'body> {
    /// `interval` is the time since the frame before (s).
    pub(super) fn new(body: &'body Body, settings: &TrackerSettings, interval: f64) -> Self {
        Self {
            body,
            least_confidence: settings.least_confidence,
            position_sigma: settings.position_sigma,
            inflation: settings.inflation(interval),
        }
    }

    /// A joint that is seen.
    pub(super) fn joint(&self, joint: Body25) -> Option<Joint> {
        let keypoint = self.body.get(joint)?;
        let position = keypoint.position.coords;
        let near = position.iter().all(|coordinate| coordinate.abs() <= FARTHEST);
        let trusted = keypoint.confidence.value() >= self.least_confidence && near;
        let covariance = self.body.covariance(joint).filter(is_sound);
        trusted.then_some(Joint { position, covariance })
    }

    /// Returns true if joints come with covariances.
    pub(super) fn is_measured(&self) -> bool {
        Body25::ALL.into_iter().any(|joint| self.body.covariance(joint).is_some())
    }

    /// What errors that last from frame to frame make of a covariance.
    pub(super) fn inflation(&self) -> f64 {
        self.inflation
    }

    /// The floor below the pelvis (m): below the mid hip and the middle of the hips or, with both
    /// hidden, the neck or the middle of the shoulders, which are above the pelvis but for the
    /// person's lean. All of them where their covariances are known, else the first.
    pub(super) fn floors(&self, lean: &LeanInWorld) -> [Option<Measurement<2>>; 3] {
        let found = [self.joint(Body25::MidHip), self.hips(), self.above()];
        let best = found.iter().position(Option::is_some);
        let mut index = 0;
        found.map(|joint| {
            let (first, above) = (best == Some(index), index == 2);
            index += 1;
            let joint = joint.filter(|joint| first || joint.is_measured())?;
            let mut floor = self.floor(&joint);
            if above && joint.is_measured() {
                floor.position -= lean.offset;
                floor.covariance += Matrix2::identity() * lean.variance;
            }
            Some(floor)
        })
    }

    /// The best measurement of the floor below the pelvis (m), without knowing the person.
    pub(super) fn best_floor(&self) -> Option<Measurement<2>> {
        self.floors(&LeanInWorld::default()).into_iter().flatten().next()
    }

    /// From the pelvis to the neck on the floor plan, and the variance of each axis, where both are
    /// measured (m, m²).
    pub(super) fn lean(&self) -> Option<(Vector2<f64>, f64)> {
        let pelvis = self.joint(Body25::MidHip).or_else(|| self.hips());
        let (pelvis, above) = (pelvis?, self.above()?);
        let covariance = pelvis.covariance? + above.covariance?;
        let variance = self.inflation * 0.5 * (covariance[(0, 0)] + covariance[(1, 1)]);
        Some(((above.position - pelvis.position).xy(), variance))
    }

    fn hips(&self) -> Option<Joint> {
        Some(Joint::middle(&self.joint(Body25::LeftHip)?, &self.joint(Body25::RightHip)?))
    }

    fn above(&self) -> Option<Joint> {
        let shoulders = || {
            let [left, right] = [Body25::LeftShoulder, Body25::RightShoulder];
            Some(Joint::middle(&self.joint(left)?, &self.joint(right)?))
        };
        self.joint(Body25::Neck).or_else(shoulders)
    }

    fn floor(&self, joint: &Joint) -> Measurement<2> {
        let position = joint.position.xy();
        match joint.covariance {
            None => Measurement::isotropic(position, self.position_sigma),
            Some(covariance) => {
                let covariance = covariance.fixed_view::<2, 2>(0, 0) * self.inflation;
                Measurement { position, covariance }
            }
        }
    }

    /// The person's forward direction: left is from the right to the left shoulder plus from the
    /// right to the left hip, made horizontal; forward is left × up. Where covariances are known the
    /// two count by how well they tell the direction. Where a shoulder or a hip is hidden, the other
    /// pair serves alone.
    pub(super) fn heading(&self) -> Option<Heading> {
        let pair = |right, left| {
            let (right, left) = (self.joint(right)?, self.joint(left)?);
            let covariance = right.covariance.zip(left.covariance).map(|(r, l)| r + l);
            Some((left.position.xy() - right.position.xy(), covariance))
        };
        let pairs = [
            pair(Body25::RightShoulder, Body25::LeftShoulder),
            pair(Body25::RightHip, Body25::LeftHip),
        ];
        let pairs = || pairs.iter().flatten();
        let unit = |left: Vector2<f64>| (left.norm() > SHORTEST_LEFT).then(|| left.normalize());
        let mut left = unit(pairs().map(|(left, _)| left).sum())?;
        let mut information = None;
        if pairs().all(|(_, covariance)| covariance.is_some()) {
            // Of each pair, how far the direction is off: across the line, over its length.
            let forwards = vector![left.y, -left.x];
            let mut sums = (Vector2::zeros(), 0.0);
            for (pair, covariance) in pairs() {
                let covariance = covariance.unwrap_or_default();
                let across = forwards.dot(&(covariance.fixed_view::<2, 2>(0, 0) * forwards));
                let length = pair.dot(&left).max(SHORTEST_LEFT);
                sums.0 += pair * (length / across);
                sums.1 += length * length / across;
            }
            left = unit(sums.0).unwrap_or(left);
            information = Some(sums.1);
        }
        let variance = information.map(|information| self.inflation / information);
        Some(Heading { angle: (-left.x).atan2(left.y), variance })
    }
}

impl Joint {
    fn is_measured(&self) -> bool {
        self.covariance.is_some()
    }

    fn middle(one: &Self, other: &Self) -> Self {
        let position = (one.position + other.position) * 0.5;
        let covariance = one.covariance.zip(other.covariance).map(|(a, b)| (a + b) * 0.25);
        Self { position, covariance }
    }
}

fn is_sound(covariance: &Matrix3<f64>) -> bool {
    covariance.diagonal().iter().all(|variance| (1e-10..VAGUE).contains(variance))
        && covariance.cholesky().is_some()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Confidence, Keypoint};

    fn body(joints: &[(Body25, [f64; 3])]) -> Body {
        let mut body = Body::default();
        for &(joint, position) in joints {
            body.set(
                joint,
                Some(Keypoint { position: position.into(), confidence: Confidence::ONE }),
            );
        }
        body
    }

    fn seen(body: &Body) -> Seen<'_> {
        Seen::new(body, &TrackerSettings::default(), 0.05)
    }

    fn floor(body: &Body) -> Option<Vector2<f64>> {
        seen(body).best_floor().map(|measured| measured.position)
    }

    fn heading(body: &Body) -> Option<f64> {
        seen(body).heading().map(|heading| heading.angle)
    }

    #[test]
    fn heading_is_left_cross_up() {
        // Left shoulder towards +y: the person looks along +x.
        let facing_x = body(&[
            (Body25::LeftShoulder, [1.0, 0.2, 1.4]),
            (Body25::RightShoulder, [1.0, -0.2, 1.5]),
        ]);
        assert_eq!(heading(&facing_x), Some(-0.0));
        // Left hip towards -x: the person looks along +y.
        let facing_y =
            body(&[(Body25::LeftHip, [-0.2, 0.0, 0.9]), (Body25::RightHip, [0.2, 0.0, 0.9])]);
        assert_eq!(heading(&facing_y), Some(std::f64::consts::FRAC_PI_2));
    }

    #[test]
    fn no_pair_means_no_heading() {
        let half =
            body(&[(Body25::LeftShoulder, [1.0, 0.2, 1.4]), (Body25::RightHip, [1.0, -0.2, 0.9])]);
        assert_eq!(heading(&half), None);
        let point =
            body(&[(Body25::LeftHip, [1.0, 0.0, 0.9]), (Body25::RightHip, [1.0, 0.01, 0.9])]);
        assert_eq!(heading(&point), None);
    }

    /// The variance of the heading against errors of each joint, one at a time.
    #[test]
    fn the_variance_of_the_heading_follows_from_the_joints() {
        let joints = [
            (Body25::LeftShoulder, [1.0, 0.2, 1.4]),
            (Body25::RightShoulder, [1.05, -0.2, 1.4]),
            (Body25::LeftHip, [1.0, 0.1, 0.9]),
            (Body25::RightHip, [1.02, -0.1, 0.9]),
        ];
        let sigma = 1e-4;
        let covariance = Matrix3::identity() * sigma * sigma;
        let mut measured = body(&joints);
        for (joint, keypoint) in body(&joints).iter() {
            measured.set_measured(joint, keypoint, covariance);
        }
        let settings = TrackerSettings { correlation_time: 0.0, ..TrackerSettings::default() };
        let heading = |body: &Body| Seen::new(body, &settings, 0.05).heading();
        let Some(base) = heading(&measured) else { return };
        let mut expected = 0.0;
        for (joint, keypoint) in body(&joints).iter() {
            for axis in 0..3 {
                let mut moved = measured.clone();
                let mut position = keypoint.position;
                position[axis] += sigma;
                moved.set_measured(joint, Keypoint { position, ..keypoint }, covariance);
                let moved = heading(&moved).map_or(f64::NAN, |heading| heading.angle);
                expected += (moved - base.angle).powi(2);
            }
        }
        let variance = base.variance.unwrap_or_default();
        assert!((variance - expected).abs() < 0.05 * expected, "{variance} for {expected}");
    }

    #[test]
    fn floor_falls_back_from_pelvis_to_neck() {
        let mut person = body(&[
            (Body25::MidHip, [1.0, 0.0, 0.9]),
            (Body25::LeftHip, [1.1, 0.1, 0.9]),
            (Body25::RightHip, [1.1, -0.1, 0.9]),
            (Body25::Neck, [1.2, 0.0, 1.4]),
        ]);
        let expect = |body: &Body, x: f64| {
            let floor = floor(body);
            assert!(floor.is_some_and(|floor| (floor.x - x).abs() < 1e-12), "{floor:?}");
        };
        expect(&person, 1.0);
        person.set(Body25::MidHip, None);
        expect(&person, 1.1);
        person.set(Body25::LeftHip, None);
        expect(&person, 1.2);
        person.set(Body25::Neck, None);
        assert_eq!(floor(&person), None);
    }

    #[test]
    fn doubtful_and_impossible_joints_are_not_seen() {
        for position in [[f64::NAN, 0.0, 0.9], [0.0, f64::INFINITY, 0.9], [1e300, 0.0, 0.9]] {
            assert_eq!(floor(&body(&[(Body25::MidHip, position)])), None);
        }
        let mut doubtful = body(&[(Body25::MidHip, [1.0, 0.0, 0.9])]);
        doubtful.set(
            Body25::MidHip,
            doubtful
                .get(Body25::MidHip)
                .map(|hip| Keypoint { confidence: Confidence::ZERO, ..hip }),
        );
        assert_eq!(floor(&doubtful), None);
    }
}
