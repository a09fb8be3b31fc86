//! Where one camera frame says that the person stands, and which way the person faces.

use nalgebra::{Point2, Point3, Vector2};

use super::{
    keypoints::{Body, Body25},
    settings::TrackerSettings,
};

/// Further from the origin nothing is a person in a room (m).
const FARTHEST: f64 = 1e3;

/// Below this length the line through shoulders and hips has no direction to speak of (m).
const SHORTEST_LEFT: f64 = 0.05;

/// The joints of a body that can be trusted.
pub(super) struct Seen<'body> {
    body: &'body Body,
    least_confidence: f64,
}

impl<'body> Seen<'body> {
    pub(super) fn new(body: &'body Body, settings: &TrackerSettings) -> Self {
        Self { body, least_confidence: settings.least_confidence }
    }

    pub(super) fn point(&self, joint: Body25) -> Option<Point3<f64>> {
        self.body
            .get(joint)
            .filter(|keypoint| keypoint.confidence.value() >= self.least_confidence)
            .map(|keypoint| keypoint.position)
            .filter(|point| point.iter().all(|coordinate| coordinate.abs() <= FARTHEST))
    }

    fn middle(&self, one: Body25, other: Body25) -> Option<Point3<f64>> {
        Some(nalgebra::center(&self.point(one)?, &self.point(other)?))
    }

    fn between(&self, from: Body25, to: Body25) -> Option<Vector2<f64>> {
        Some((self.point(to)? - self.point(from)?).xy())
    }

    /// The floor below the pelvis (m): below the mid hip, the middle of the hips or, with the
    /// pelvis hidden, the neck or the middle of the shoulders, which are above it in an upright
    /// person.
    pub(super) fn floor(&self) -> Option<Point2<f64>> {
        self.point(Body25::MidHip)
            .or_else(|| self.middle(Body25::LeftHip, Body25::RightHip))
            .or_else(|| self.point(Body25::Neck))
            .or_else(|| self.middle(Body25::LeftShoulder, Body25::RightShoulder))
            .map(|point| point.xy())
    }

    /// The yaw of the person's forward direction in (-π, π] (rad): left is from the right to the
    /// left shoulder plus from the right to the left hip, made horizontal; forward is left × up.
    /// Where a shoulder or a hip is hidden, the other pair serves alone.
    pub(super) fn heading(&self) -> Option<f64> {
        let shoulders = self.between(Body25::RightShoulder, Body25::LeftShoulder);
        let hips = self.between(Body25::RightHip, Body25::LeftHip);
        let left = match (shoulders, hips) {
            (Some(shoulders), Some(hips)) => shoulders + hips,
            (Some(pair), None) | (None, Some(pair)) => pair,
            (None, None) => return None,
        };
        (left.norm() > SHORTEST_LEFT).then(|| (-left.x).atan2(left.y))
    }
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
        Seen { body, least_confidence: 0.3 }
    }

    #[test]
    fn heading_is_left_cross_up() {
        // Left shoulder towards +y: the person looks along +x.
        let facing_x = body(&[
            (Body25::LeftShoulder, [1.0, 0.2, 1.4]),
            (Body25::RightShoulder, [1.0, -0.2, 1.5]),
        ]);
        assert_eq!(seen(&facing_x).heading(), Some(-0.0));
        // Left hip towards -x: the person looks along +y.
        let facing_y =
            body(&[(Body25::LeftHip, [-0.2, 0.0, 0.9]), (Body25::RightHip, [0.2, 0.0, 0.9])]);
        assert_eq!(seen(&facing_y).heading(), Some(std::f64::consts::FRAC_PI_2));
    }

    #[test]
    fn no_pair_means_no_heading() {
        let half =
            body(&[(Body25::LeftShoulder, [1.0, 0.2, 1.4]), (Body25::RightHip, [1.0, -0.2, 0.9])]);
        assert_eq!(seen(&half).heading(), None);
        let point =
            body(&[(Body25::LeftHip, [1.0, 0.0, 0.9]), (Body25::RightHip, [1.0, 0.01, 0.9])]);
        assert_eq!(seen(&point).heading(), None);
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
            let floor = seen(body).floor();
            assert!(floor.is_some_and(|floor| (floor.x - x).abs() < 1e-12), "{floor:?}");
        };
        expect(&person, 1.0);
        person.set(Body25::MidHip, None);
        expect(&person, 1.1);
        person.set(Body25::LeftHip, None);
        expect(&person, 1.2);
        person.set(Body25::Neck, None);
        assert_eq!(seen(&person).floor(), None);
    }

    #[test]
    fn doubtful_and_impossible_joints_are_not_seen() {
        for position in [[f64::NAN, 0.0, 0.9], [0.0, f64::INFINITY, 0.9], [1e300, 0.0, 0.9]] {
            assert_eq!(seen(&body(&[(Body25::MidHip, position)])).floor(), None);
        }
        let mut doubtful = body(&[(Body25::MidHip, [1.0, 0.0, 0.9])]);
        doubtful.set(
            Body25::MidHip,
            doubtful
                .get(Body25::MidHip)
                .map(|hip| Keypoint { confidence: Confidence::ZERO, ..hip }),
        );
        assert_eq!(seen(&doubtful).floor(), None);
    }
}
