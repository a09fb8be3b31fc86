//! Pairs in which the robot must not approach any possible position of the person.

use ahqp_core::VelocityInterval;
use nalgebra::{Vector3, Vector6};

use crate::approach::bodies::{PersonBody, RobotBody};
use crate::approach::joint_motion::JointMotion;
use crate::distance::{Proximity, proximity};
use crate::separation::SeparationSettings;
use hrsw::Capsule;

/// Number of pairs that are remembered. If there are more, the robot brakes.
const ROOM: usize = 512;
/// Largest number of steps in which a stop recedes.
const STEPS: usize = 8;

/// Pairs of a tick that may not touch and violate the protective distance of a robot at rest.
#[derive(Debug, Clone)]
pub(super) struct SeparationViolations {
    pairs: Vec<Pair>,
    /// True if there are more pairs than can be remembered.
    overflows: bool,
    /// True if the person of a pair may be so near that no direction surely leads away.
    too_near: bool,
    /// Velocities in which a stop exceeds another one, n \[m/s or rad/s\].
    beyond: Vec<f64>,
}

/// An end of a pair's segment that approaches a possible position of the person.
#[derive(Debug, Clone, Copy)]
struct Approach {
    /// Speed \[m/s\].
    speed: f64,
    end: Vector3<f64>,
    /// Unit vector to the person; zero if the speed is zero.
    towards: Vector3<f64>,
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
    pub(super) fn new(joints: usize) -> Self {
        Self {
            pairs: Vec::with_capacity(ROOM),
            overflows: false,
            too_near: false,
            beyond: Vec::with_capacity(joints),
        }
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
        self.approaches(motion, velocity).all(|(_, worst)| worst.speed <= rounding)
    }

    /// Moves `velocity` within the `intervals` until no pair approaches faster than at the velocity
    /// `least`, n each, apart from `rounding` \[m/s\]. Returns true if it succeeds.
    ///
    /// In each step the pair recedes that is worst, by the least change of its joints that have room.
    pub(super) fn recede(
        &mut self,
        motion: &JointMotion<'_>,
        (least, intervals): (&[f64], &[VelocityInterval]),
        velocity: &mut [f64],
        rounding: f64,
    ) -> bool {
        for _ in 0..STEPS {
            let mut beyond = std::mem::take(&mut self.beyond);
            beyond.clear();
            beyond.extend(velocity.iter().zip(least).map(|(velocity, least)| velocity - least));
            let worst = self.approaches(motion, &beyond);
            let worst =
                worst.max_by(|(_, first), (_, second)| first.speed.total_cmp(&second.speed));
            self.beyond = beyond;
            let Some((joints, Approach { speed, end, towards })) = worst else { return true };
            if speed <= rounding {
                return true;
            }
            let moment = (end - motion.origin).cross(&towards);
            let joints = motion.columns(joints).zip(intervals).zip(&*velocity);
            let joints = joints.map(|(([linear, angular], interval), velocity)| {
                let approach = linear.dot(&towards) + angular.dot(&moment);
                let to = if approach > 0.0 { interval.lower } else { interval.upper };
                let room = to - velocity;
                (approach, if room * approach < 0.0 { room } else { 0.0 })
            });
            let free = joints.clone().filter(|(_, room)| *room != 0.0);
            let squares: f64 = free.map(|(approach, _)| approach * approach).sum();
            if squares == 0.0 {
                return false;
            }
            let step = |(approach, room): (f64, f64)| {
                let least = speed / squares * approach.abs();
                least.min(room.abs()).copysign(room)
            };
            self.beyond.clear();
            self.beyond.extend(joints.map(step));
            velocity
                .iter_mut()
                .zip(&self.beyond)
                .for_each(|(velocity, change)| *velocity += change);
        }
        false
    }

    /// Returns the number of joints and the worst approach of every pair, at a velocity, n \[m/s\].
    fn approaches(
        &self,
        motion: &JointMotion<'_>,
        velocity: &[f64],
    ) -> impl Iterator<Item = (usize, Approach)> {
        // Pairs of the same body follow each other.
        let (mut last, mut twist) = (None, Vector6::zeros());
        self.pairs.iter().map(move |pair| {
            if last != Some(pair.robot) {
                (last, twist) = (Some(pair.robot), motion.twist(velocity, pair.joints));
            }
            (pair.joints, pair.worst_approach(&twist, &motion.origin))
        })
    }
}

impl Pair {
    /// Returns the fastest approach of an end, over all possible directions to the person.
    fn worst_approach(&self, twist: &Vector6<f64>, origin: &Vector3<f64>) -> Approach {
        let (linear, angular) = (twist.fixed_rows::<3>(0), twist.fixed_rows::<3>(3));
        let cosine = (1.0 - self.sine * self.sine).sqrt();
        let [first, second] = self.ends.map(|end| {
            let velocity = linear + angular.cross(&(end - origin));
            let approach = -velocity.dot(&self.normal);
            let across = velocity + self.normal * approach;
            let [aside, speed] = [across.norm(), velocity.norm()];
            // The cone of possible directions contains the direction of the velocity, or does not.
            if approach > cosine * speed || self.sine >= 1.0 {
                let towards = velocity.try_normalize(0.0).unwrap_or_default();
                Approach { speed, end, towards }
            } else {
                let speed = cosine * approach + self.sine * aside;
                let aside = across.try_normalize(0.0).unwrap_or_default();
                Approach { speed, end, towards: aside * self.sine - self.normal * cosine }
            }
        });
        if first.speed < second.speed { second } else { first }
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
