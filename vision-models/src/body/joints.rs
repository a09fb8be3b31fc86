//! A body's joints over time.

use nalgebra::{Matrix3, Point3, Vector2, Vector3};

use super::{
    body_25::Body25,
    filter::{Measurement, Motion, PointFilter},
    keypoints::{Body, Keypoint},
    seen::Seen,
    segment::{BodySegment, ENDS},
    settings::{ACQUIRE_FRAMES, moving, outlier_distance},
};
use crate::confidence::Confidence;

/// Longest time for which a joint is known without a measurement (s).
const COAST: f64 = 0.2;

/// A joint is unknown if the sum of its variances over the axes is larger than this (m²).
const VAGUE: f64 = 0.03;

/// A segment may differ from its measured length by this (m) plus this many standard deviations of
/// its ends.
const TOLERANCE: f64 = 0.05;
const DEVIATIONS: f64 = 2.5;

/// Filters each joint of one person by a Kalman filter. This averages the errors of single frames
/// and keeps a joint known while it is missed for a moment. The positions of joints without a
/// covariance are not filtered. Their velocities come from the assumed covariance.
#[derive(Clone, Debug)]
pub(super) struct JointFilter {
    joints: [Option<Followed>; Body25::COUNT],
}

#[derive(Clone, Copy, Debug)]
struct Followed {
    filter: PointFilter<3>,
    time: f64,
    confidence: Confidence,
    /// Number of consecutive outliers.
    outliers: u32,
}

impl JointFilter {
    #[expect(clippy::large_stack_arrays, reason = "following people allocates nothing")]
    pub(super) fn new() -> Self {
        Self { joints: [None; Body25::COUNT] }
    }

    /// Returns the velocity of a joint at the time `now` (s), if it was seen recently.
    pub(super) fn velocity(&self, joint: Body25, now: f64) -> Option<JointVelocity> {
        let followed = self.joints[joint.index()]?;
        let elapsed = (now - followed.time).max(0.0);
        let filter = followed.filter.advanced(&moving(joint).moving(elapsed));
        let (mean, covariance) = (filter.velocity(), filter.velocity_covariance());
        (elapsed <= COAST).then_some(JointVelocity { mean, covariance })
    }

    /// Updates the filter with a frame and returns the joints at the frame's time. `walking` is the
    /// person's velocity over the floor (m/s). `length` returns the measured lengths of segments.
    pub(super) fn update(
        &mut self,
        body: &Body,
        seen: &Seen<'_>,
        time: f64,
        walking: Vector2<f64>,
        length: impl Fn(BodySegment) -> Option<f64>,
    ) -> Body {
        let doubted = doubted(seen, length);
        let mut out = Body::default();
        let joints = Body25::ALL.into_iter().zip(&mut self.joints).zip(doubted);
        for ((joint, followed), doubted) in joints {
            let motion = moving(joint);
            let measured = seen.place(joint).zip(body.get(joint)).filter(|_| !doubted);
            if let Some((at, keypoint)) = measured {
                if body.covariance(joint).is_none() {
                    out.set(joint, Some(keypoint));
                }
                let Some(covariance) = at.covariance else { continue };
                let measured =
                    Measurement { position: at.position, covariance, lasting: seen.lasting() };
                let before = followed.take().filter(|before| time - before.time <= COAST);
                *followed = Some(match before {
                    None => Followed::starting_at(&measured, keypoint, time, &motion).with(walking),
                    Some(before) => before.corrected(&measured, keypoint, time, &motion),
                });
            }
            let followed =
                followed.filter(|known| seen.is_measured() && time - known.time <= COAST);
            if let Some(known) = followed {
                let now = known.filter.advanced(&motion.moving(time - known.time));
                if now.position_covariance().trace() > VAGUE {
                    continue;
                }
                let position = Point3::from(now.position());
                let keypoint = Keypoint { position, confidence: known.confidence };
                out.set_measured(joint, keypoint, now.position_covariance());
            }
        }
        out
    }
}

/// The velocity of a joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointVelocity {
    /// Mean in the world frame (m/s).
    pub mean: Vector3<f64>,
    /// Covariance (m²/s²).
    pub covariance: Matrix3<f64>,
}

impl Followed {
    fn starting_at(
        measured: &Measurement<3>,
        keypoint: Keypoint,
        time: f64,
        motion: &Motion,
    ) -> Self {
        let filter = PointFilter::starting_at(measured, motion);
        Self { filter, time, confidence: keypoint.confidence, outliers: 0 }
    }

    /// Returns the same joint with the person's velocity.
    fn with(mut self, walking: Vector2<f64>) -> Self {
        self.filter = self.filter.with_velocity(walking.push(0.0));
        self
    }

    /// Returns the joint after a measurement. An outlier is left out. After enough consecutive
    /// outliers the joint restarts at the measurement.
    fn corrected(
        mut self,
        measured: &Measurement<3>,
        keypoint: Keypoint,
        time: f64,
        motion: &Motion,
    ) -> Self {
        let over = motion.moving(time - self.time);
        if self.filter.advanced(&over).distance_squared(measured) <= outlier_distance() {
            let filter = self.filter.corrected(measured, &over).0.no_faster_than(motion.max_speed);
            return Self { filter, time, confidence: keypoint.confidence, outliers: 0 };
        }
        self.outliers += 1;
        if self.outliers >= ACQUIRE_FRAMES {
            return Self::starting_at(measured, keypoint, time, motion);
        }
        self
    }
}

/// Returns true for each joint at the outer end of a segment whose length differs too much from the
/// expected one.
fn doubted(seen: &Seen<'_>, length: impl Fn(BodySegment) -> Option<f64>) -> [bool; Body25::COUNT] {
    let mut doubted = [false; Body25::COUNT];
    for (segment, from, to) in ENDS {
        if matches!(segment, BodySegment::Trunk | BodySegment::Shoulders) {
            continue;
        }
        let ends = seen.joint(from).zip(seen.joint(to)).filter(|_| !doubted[from.index()]);
        let (Some((near, far)), Some(expected)) = (ends, length(segment)) else { continue };
        let Some((one, other)) = near.covariance.zip(far.covariance) else { continue };
        let line = far.position - near.position;
        let direction = line.try_normalize(1e-9).unwrap_or_default();
        let sigma = direction.dot(&((one + other) * direction)).sqrt();
        let error = (line.norm() - expected).abs();
        doubted[to.index()] = error > TOLERANCE + DEVIATIONS * sigma;
    }
    doubted
}
