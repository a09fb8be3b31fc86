//! Pairs in which the robot must not approach any possible position of the person.

use nalgebra::{Vector3, Vector6};

use crate::approach::bodies::{PersonBody, RobotBody};
use crate::approach::joint_motion::JointMotion;
use crate::distance::{Proximity, proximity};
use crate::separation::SeparationSettings;
use hrsw::Capsule;

/// Number of pairs that are remembered. If there are more, the robot brakes.
const ROOM: usize = 512;

/// Pairs of a tick that may not touch and violate the protective distance of a robot at rest.
#[derive(Debug, Clone)]
pub(super) struct SeparationViolations {
    pairs: Vec<Pair>,
    /// True if there are more pairs than can be remembered.
    overflows: bool,
    /// True if the person of a pair may be so near that no direction surely leads away.
    too_near: bool,
}

/// A body of the robot, and a part of the person at the place where it has moved since it was seen.
#[derive(Debug, Clone, Copy)]
struct Pair {
    robot: usize,
    joints: usize,
    /// Ends of the robot's segment, cut to the points that can be the nearest ones.
    ends: [Vector3<f64>; 2],
    /// Unit vector from the person to the robot.
    normal: Vector3<f64>,
    /// Sine of the largest error of the direction to the person, at most 1.
    sine: f64,
}

impl SeparationViolations {
    pub(super) fn new() -> Self {
        Self { pairs: Vec::with_capacity(ROOM), overflows: false, too_near: false }
    }

    pub(super) fn clear(&mut self) {
        self.pairs.clear();
        self.overflows = false;
        self.too_near = false;
    }

    /// Takes a pair that may not touch. It is nearer than the protective distance of a robot at rest
    /// from a part as fast as it may be.
    pub(super) fn take(
        &mut self,
        (robot, body): (usize, &RobotBody),
        part: &PersonBody,
        settings: &SeparationSettings,
    ) {
        let (moved, spread) = part.since_seen();
        let error = settings.human_uncertainty + spread;
        let too_near = error + settings.intrusion + settings.robot_uncertainty;
        let near = proximity(&body.capsule, &part.capsule.moved(&moved));
        self.too_near |= near.distance < too_near;
        if self.pairs.len() == ROOM {
            self.overflows = true;
            return;
        }
        let apart = (near.on_first - near.on_second).norm();
        // The distance already accounts for this, as a part of the shape.
        let error = error + part.uncertainty;
        self.pairs.push(Pair {
            robot,
            joints: body.joints,
            ends: nearest_ends(&body.capsule, &near, error),
            normal: near.normal,
            sine: if error < apart { error / apart } else { 1.0 },
        });
    }

    /// Returns true if no pair violates the protective distance of a robot at rest.
    pub(super) fn is_empty(&self) -> bool {
        self.pairs.is_empty()
    }

    pub(super) fn overflows(&self) -> bool {
        self.overflows
    }

    pub(super) fn is_too_near(&self) -> bool {
        self.too_near
    }

    /// Returns true if no pair approaches faster than `rounding` at `velocity`, n \[m/s\].
    pub(super) fn is_left_by(
        &self,
        motion: &JointMotion<'_>,
        velocity: &[f64],
        rounding: f64,
    ) -> bool {
        // Pairs of the same body follow each other.
        let (mut last, mut twist) = (None, Vector6::zeros());
        self.pairs.iter().all(|pair| {
            if last != Some(pair.robot) {
                (last, twist) = (Some(pair.robot), motion.twist(velocity, pair.joints));
            }
            pair.worst_approach(&twist, &motion.origin) <= rounding
        })
    }
}

impl Pair {
    /// Returns the largest speed at which an end approaches the person, over all possible
    /// directions to the person \[m/s\].
    fn worst_approach(&self, twist: &Vector6<f64>, origin: &Vector3<f64>) -> f64 {
        let (linear, angular) = (twist.fixed_rows::<3>(0), twist.fixed_rows::<3>(3));
        let cosine = (1.0 - self.sine * self.sine).sqrt();
        let worst = self.ends.map(|end| {
            let velocity = linear + angular.cross(&(end - origin));
            let approach = -velocity.dot(&self.normal);
            let across = (velocity + self.normal * approach).norm();
            let speed = approach.hypot(across);
            // The cone of possible directions contains the direction of the velocity, or does not.
            if approach > cosine * speed || self.sine >= 1.0 {
                speed
            } else {
                cosine * approach + self.sine * across
            }
        });
        worst[0].max(worst[1])
    }
}

/// Returns the ends of the segment of the capsule's points that can be nearest to the other
/// capsule. The other capsule may be displaced by up to `error` \[m\].
///
/// The vector z between the nearest points is the shortest one in the difference of two convex
/// sets. It moves by no more than these sets do. After a displacement e the nearest point is
/// therefore no farther than ‖z‖ + ‖e‖ from the displaced capsule. From the capsule as given it is
/// no farther than ‖z‖ + 2‖e‖. A point x of the segment is at least ‖z‖ + n·(x − p) away, where p
/// is the nearest point and n the normal.
fn nearest_ends(capsule: &Capsule, near: &Proximity, error: f64) -> [Vector3<f64>; 2] {
    [capsule.start(), capsule.end()].map(|end| {
        let along = end - near.on_first;
        let farther = near.normal.dot(&along);
        let share = if farther > 2.0 * error { 2.0 * error / farther } else { 1.0 };
        near.on_first + along * share
    })
}
