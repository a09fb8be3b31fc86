//! Pairs in which the robot may come no nearer, wherever the person is that they may be.

use nalgebra::{Vector3, Vector6};

use crate::approach::bodies::{PersonBody, RobotBody};
use crate::approach::joint_motion::JointMotion;
use crate::distance::{Proximity, proximity};
use crate::separation::SeparationSettings;
use hrsw::Capsule;

/// Pairs that are remembered; of more the robot brakes.
const ROOM: usize = 256;

/// The pairs of a tick that may not touch and are nearer than a robot at rest should be.
#[derive(Debug, Clone)]
pub(super) struct Undercut {
    pairs: Vec<Pair>,
    /// Whether there are more of them than are remembered.
    overflows: bool,
    /// Whether the person of a pair may be so near that no direction is surely away.
    too_near: bool,
}

/// A body of the robot and a part of the person, where that has moved to since it was seen.
#[derive(Debug, Clone, Copy)]
struct Pair {
    robot: usize,
    joints: usize,
    /// The ends of the robot's segment, as far as one of its points can be the nearest.
    ends: [Vector3<f64>; 2],
    /// From the person to the robot, of length 1.
    normal: Vector3<f64>,
    /// The sine of the angle by which the direction to the person may be off, at most 1.
    sine: f64,
}

impl Undercut {
    pub(super) fn new() -> Self {
        Self { pairs: Vec::with_capacity(ROOM), overflows: false, too_near: false }
    }

    pub(super) fn clear(&mut self) {
        self.pairs.clear();
        self.overflows = false;
        self.too_near = false;
    }

    /// Takes a pair that may not touch, at its `distance` as seen \[m\]; `may_approach` says that it is not
    /// nearer than a robot at rest should be, so that it only counts where the part may be about to touch.
    pub(super) fn take(
        &mut self,
        (robot, body): (usize, &RobotBody),
        part: &PersonBody,
        distance: f64,
        may_approach: bool,
        settings: &SeparationSettings,
    ) {
        let (moved, spread) = part.since_seen();
        let error = settings.human_uncertainty + spread;
        let too_near = error + settings.intrusion + settings.robot_uncertainty;
        // By moving, the part has come nearer by no more than it has moved.
        if may_approach && distance > too_near + moved.norm() {
            return;
        }
        let near = proximity(&body.capsule, &part.capsule.moved(&moved));
        self.too_near |= near.distance < too_near;
        if may_approach {
            return;
        }
        if self.pairs.len() == ROOM {
            self.overflows = true;
            return;
        }
        let apart = (near.on_first - near.on_second).norm();
        // The distance counts this as part of the shape.
        let error = error + part.uncertainty;
        self.pairs.push(Pair {
            robot,
            joints: body.joints,
            ends: nearest_ends(&body.capsule, &near, error),
            normal: near.normal,
            sine: if error < apart { error / apart } else { 1.0 },
        });
    }

    /// Returns true if nobody is nearer than a robot at rest should be.
    pub(super) fn is_empty(&self) -> bool {
        self.pairs.is_empty()
    }

    pub(super) fn overflows(&self) -> bool {
        self.overflows
    }

    pub(super) fn is_too_near(&self) -> bool {
        self.too_near
    }

    /// Returns true if no pair comes nearer at `velocity`, n, by more than `rounding` \[m/s\].
    pub(super) fn is_left_by(
        &self,
        motion: &JointMotion<'_>,
        velocity: &[f64],
        rounding: f64,
    ) -> bool {
        // Pairs of one body follow each other.
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
    /// How fast an end comes nearer to the person at most, whichever direction they are in of those that they
    /// may be in \[m/s\].
    fn worst_approach(&self, twist: &Vector6<f64>, origin: &Vector3<f64>) -> f64 {
        let (linear, angular) = (twist.fixed_rows::<3>(0), twist.fixed_rows::<3>(3));
        let cosine = (1.0 - self.sine * self.sine).sqrt();
        let worst = self.ends.map(|end| {
            let velocity = linear + angular.cross(&(end - origin));
            let approach = -velocity.dot(&self.normal);
            let across = (velocity + self.normal * approach).norm();
            let speed = approach.hypot(across);
            // The cone of directions holds that of the velocity, or it does not.
            if approach > cosine * speed || self.sine >= 1.0 {
                speed
            } else {
                cosine * approach + self.sine * across
            }
        });
        worst[0].max(worst[1])
    }
}

/// The ends of the segment that holds all points of a capsule's that are the nearest for some place of the
/// other, up to `error` \[m\] from where it is.
///
/// The vector z between the nearest points is the least of the difference of two convex sets, and moves by no
/// more than these do. So after a displacement by e the nearest point is no farther than ‖z‖ + ‖e‖ from the
/// displaced other, and than ‖z‖ + 2‖e‖ from the other; and a point x of the segment is at least
/// ‖z‖ + n·(x − p) from it, with the nearest point p and the normal n.
fn nearest_ends(capsule: &Capsule, near: &Proximity, error: f64) -> [Vector3<f64>; 2] {
    [capsule.start(), capsule.end()].map(|end| {
        let along = end - near.on_first;
        let farther = near.normal.dot(&along);
        let share = if farther > 2.0 * error { 2.0 * error / farther } else { 1.0 };
        near.on_first + along * share
    })
}
