//! Position and heading of the person in one camera frame.

use nalgebra::{Matrix2, Matrix3, Vector2, Vector3, vector};

use super::{
    body_25::Body25,
    filter::{LASTING, Measurement},
    heading::Heading,
    keypoints::Body,
    lean::LeanInWorld,
    settings::{TrackerSettings, inflation},
};

/// Largest distance of a person from the origin (m).
const FARTHEST: f64 = 1e3;

/// Shortest line through shoulders and hips whose direction is used (m).
const SHORTEST_LEFT: f64 = 0.05;

/// Distances from the midpoint of the hips and of the shoulders to either joint, for adults (m),
/// and their relative uncertainty.
const HIP: f64 = 0.09;
const SHOULDER: f64 = 0.2;
const UNSURE: f64 = 0.1;

/// A covariance with a larger variance than this gives no information (m²).
const VAGUE: f64 = 10.0;

/// The joints of a body that are confident enough.
pub(super) struct Seen<'body> {
    body: &'body Body,
    least_confidence: f64,
    /// True if joints have covariances.
    measured: bool,
    /// Covariance of a joint whose covariance is unknown (m²).
    assumed: Matrix3<f64>,
    /// Share of the assumed covariance that lasts.
    lasting: f64,
    /// Factor of the variance of a mean of errors that all last.
    inflation: f64,
}

/// A point in the frame: its position (m) and, if known, its covariance (m²).
#[derive(Clone, Copy, Debug)]
pub(super) struct Joint {
    pub(super) position: Vector3<f64>,
    pub(super) covariance: Option<Matrix3<f64>>,
}

/// The known direction that a person faces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Facing {
    /// Angle (rad).
    pub(super) angle: f64,
    /// Variance (rad²).
    pub(super) variance: f64,
}

impl<'body> Seen<'body> {
    /// Creates the view of a body. `interval` is the time since the previous frame (s).
    pub(super) fn new(body: &'body Body, settings: &TrackerSettings, interval: f64) -> Self {
        let measured = Body25::ALL.into_iter().any(|joint| body.covariance(joint).is_some());
        Self {
            body,
            least_confidence: settings.least_confidence,
            measured,
            assumed: Matrix3::identity() * settings.position_sigma.powi(2),
            lasting: 0.0,
            inflation: inflation(interval),
        }
    }

    /// Sets the covariance on the floor of a joint whose covariance is unknown (m²), and the share of
    /// it that lasts.
    pub(super) fn with_noise(mut self, noise: Matrix2<f64>, lasting: f64) -> Self {
        self.assumed.fixed_view_mut::<2, 2>(0, 0).copy_from(&noise);
        self.lasting = lasting;
        self
    }

    /// Returns a joint that is seen.
    pub(super) fn joint(&self, joint: Body25) -> Option<Joint> {
        let keypoint = self.body.get(joint)?;
        let position = keypoint.position.coords;
        let near = position.iter().all(|coordinate| coordinate.abs() <= FARTHEST);
        let trusted = keypoint.confidence.value() >= self.least_confidence && near;
        let covariance = self.body.covariance(joint).filter(is_sound);
        trusted.then_some(Joint { position, covariance })
    }

    /// Returns the joint, with the assumed covariance if no joint has a covariance.
    pub(super) fn place(&self, joint: Body25) -> Option<Joint> {
        let assumed = (!self.measured).then_some(self.assumed);
        let joint = self.joint(joint)?;
        Some(Joint { covariance: joint.covariance.or(assumed), ..joint })
    }

    /// Returns true if joints come with covariances.
    pub(super) fn is_measured(&self) -> bool {
        self.measured
    }

    /// Returns the share of variances that lasts from frame to frame.
    pub(super) fn lasting(&self) -> f64 {
        if self.measured { LASTING } else { self.lasting }
    }

    /// Returns measurements of the floor position below the pelvis (m): below the hips, and below
    /// neck and shoulders, corrected by the person's lean.
    ///
    /// Both are returned if their covariances are known, else the first. In a body without
    /// covariances all joints are equally certain. If the person's direction is known, one hip or
    /// shoulder gives the midpoint.
    pub(super) fn floors(
        &self,
        lean: &LeanInWorld,
        facing: Option<Facing>,
    ) -> [Option<Measurement<2>>; 2] {
        let hips = self.girdle(Body25::MidHip, [Body25::LeftHip, Body25::RightHip], HIP, facing);
        let above = self.above(facing);
        let best = hips.is_some();
        let hips = hips.map(|joint| self.floor(&joint));
        let above = above.filter(|joint| !best || joint.is_measured()).map(|joint| {
            let mut floor = self.floor(&joint);
            if joint.is_measured() {
                floor.position -= lean.offset;
                floor.covariance += Matrix2::identity() * lean.variance;
            }
            floor
        });
        [hips, above]
    }

    /// Returns the best measurement of the floor position below the pelvis (m), without the
    /// person's lean. It uses the person's direction only if nothing else gives a position.
    pub(super) fn best_floor(&self, facing: Option<Facing>) -> Option<Measurement<2>> {
        let best =
            |facing| self.floors(&LeanInWorld::default(), facing).into_iter().flatten().next();
        best(None).or_else(|| best(Some(facing?)))
    }

    /// Returns the horizontal offset from the pelvis to the neck (m) and the variance of each axis
    /// (m²), if both are measured.
    pub(super) fn lean(&self, facing: Option<Facing>) -> Option<(Vector2<f64>, f64)> {
        let hips = [Body25::LeftHip, Body25::RightHip];
        let pelvis = self.girdle(Body25::MidHip, hips, HIP, facing)?;
        let above = self.above(facing)?;
        let covariance = pelvis.covariance? + above.covariance?;
        let inflation = 1.0 + self.lasting() * (self.inflation - 1.0);
        let variance = inflation * 0.5 * (covariance[(0, 0)] + covariance[(1, 1)]);
        Some(((above.position - pelvis.position).xy(), variance))
    }

    fn above(&self, facing: Option<Facing>) -> Option<Joint> {
        let shoulders = [Body25::LeftShoulder, Body25::RightShoulder];
        self.girdle(Body25::Neck, shoulders, SHOULDER, facing)
    }

    /// Returns the midpoint of a pair of joints, each of which is `aside` away from it (m).
    ///
    /// It is the mean of the middle joint and of the points that each of the pair gives, weighted
    /// by their information. Where covariances or the person's direction are unknown, it is the
    /// middle joint or the midpoint of the pair.
    fn girdle(
        &self,
        middle: Body25,
        pair: [Body25; 2],
        aside: f64,
        facing: Option<Facing>,
    ) -> Option<Joint> {
        let (middle, pair) = (self.place(middle), pair.map(|joint| self.place(joint)));
        let [left, right] = pair;
        let alone = middle.or_else(|| Some(Joint::middle(&left?, &right?)));
        let Some(Facing { angle, variance }) = facing.filter(Facing::is_known) else {
            return alone;
        };
        let forwards = vector![angle.cos(), angle.sin(), 0.0];
        let aside_left = vector![-forwards.y, forwards.x, 0.0];
        // The distance varies between people. The error of the heading moves the point along the
        // person's direction.
        let unsure = Matrix3::identity() * (UNSURE * aside).powi(2)
            + forwards * forwards.transpose() * (variance * aside.powi(2));
        let moved = |joint: Option<Joint>, side: f64| {
            let joint = joint?;
            let position = joint.position - aside_left * (side * aside);
            Some(Joint { position, covariance: joint.covariance.map(|known| known + unsure) })
        };
        let places = [middle, moved(left, 1.0), moved(right, -1.0)];
        let known = places.into_iter().flatten().filter_map(|place| {
            let information = place.covariance?.try_inverse()?;
            Some((information, information * place.position))
        });
        let sum = known.reduce(|(one, a), (other, b)| (one + other, a + b));
        let Some((covariance, sum)) =
            sum.and_then(|(sum, place)| Some((sum.try_inverse()?, place)))
        else {
            return alone;
        };
        Some(Joint { position: covariance * sum, covariance: Some(covariance) })
    }

    fn floor(&self, joint: &Joint) -> Measurement<2> {
        let covariance = joint.covariance.unwrap_or(self.assumed);
        let covariance = covariance.fixed_view::<2, 2>(0, 0).into_owned();
        Measurement { position: joint.position.xy(), covariance, lasting: self.lasting() }
    }

    /// Returns the person's forward direction: left × up. Left is the sum of right shoulder to left
    /// shoulder and right hip to left hip, made horizontal.
    ///
    /// If covariances are known, the two pairs are weighted by how accurately they give the
    /// direction. If a shoulder or a hip is hidden, the other pair alone is used.
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
            // The error of a pair's direction is the error across its line, divided by its length.
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
        let variance = information.map(f64::recip);
        Some(Heading { angle: (-left.x).atan2(left.y), variance, lasting: self.lasting() })
    }
}

impl Facing {
    fn is_known(&self) -> bool {
        self.angle.is_finite() && self.variance.is_finite()
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
    use crate::body::keypoints::Keypoint;
    use crate::confidence::Confidence;

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
        seen(body).best_floor(None).map(|measured| measured.position)
    }

    fn heading(body: &Body) -> Option<f64> {
        seen(body).heading().map(|heading| heading.angle)
    }

    #[test]
    fn heading_is_left_cross_up() {
        // The left shoulder is towards +y, so the person faces +x.
        let facing_x = body(&[
            (Body25::LeftShoulder, [1.0, 0.2, 1.4]),
            (Body25::RightShoulder, [1.0, -0.2, 1.5]),
        ]);
        assert_eq!(heading(&facing_x), Some(-0.0));
        // The left hip is towards -x, so the person faces +y.
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

    /// Compares the variance of the heading with the errors of each joint, one at a time.
    #[test]
    fn heading_variance_follows_from_joint_variances() {
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
        // Errors of frames so far apart are independent.
        let heading = |body: &Body| Seen::new(body, &TrackerSettings::default(), 1e3).heading();
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

    /// If the person's direction is known, one side gives the midpoint.
    #[test]
    fn one_hip_tells_where_the_pelvis_is() {
        let hip = [1.0, 0.5, 0.9];
        let mut person = Body::default();
        let keypoint = Keypoint { position: hip.into(), confidence: Confidence::ONE };
        person.set_measured(Body25::LeftHip, keypoint, Matrix3::identity() * 1e-4);
        let floors = |facing| seen(&person).floors(&LeanInWorld::default(), facing);
        assert!(floors(None)[0].is_none() && seen(&person).best_floor(None).is_none());
        // Left is -y for a person who faces -x.
        let angle = std::f64::consts::PI;
        let at = |variance| floors(Some(Facing { angle, variance }))[0].expect("one floor");
        let (sure, unsure) = (at(0.0), at(0.04));
        let expected = Vector2::new(1.0, 0.5 + HIP);
        assert!((sure.position - expected).norm() < 1e-9, "{}", sure.position);
        let position = |facing| seen(&person).best_floor(facing).map(|floor| floor.position);
        assert_eq!(position(Some(Facing { angle, variance: 0.0 })), Some(sure.position));
        assert!(sure.covariance[(0, 0)] > 1e-4, "less certain than the hip");
        // A turn by 0.2 rad would move the midpoint forwards or backwards, but not sideways.
        let more = unsure.covariance - sure.covariance;
        assert!((more[(0, 0)] - 0.04 * HIP * HIP).abs() < 1e-12 && more[(1, 1)].abs() < 1e-12);
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
