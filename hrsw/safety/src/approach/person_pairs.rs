//! Pairs of a body of the robot and a part of a person.

use nalgebra::Vector6;

use super::ApproachRows;
use super::body_motion::BodyMotion;
use super::candidate::{Candidate, PointId};
use crate::approach::bodies::{PersonBody, RobotBody};
use crate::approach::joint_motion::JointMotion;
use crate::approach::nearest::Nearest;
use crate::distance::{Proximity, proximity};
use crate::separation::SeparationSettings;
use hrsw::Capsule;

/// An end of a capsule that is no farther from the nearest point than this is that point \[m\].
const SAME_POINT: f64 = 1e-6;

/// A body of the robot and a part of the person, by their indices.
#[derive(Debug, Clone, Copy)]
pub(super) struct Pair<'a> {
    pub(super) robot: (usize, &'a RobotBody),
    pub(super) other: (usize, &'a PersonBody),
    pub(super) near: Proximity,
    /// From where on points of the robot are of no interest \[m\].
    pub(super) farthest: f64,
}

impl ApproachRows {
    /// Takes a pair in sight: what the supervisor has to know of it, and the points of the robot's capsule that
    /// may get a row, the nearest one and the ends.
    pub(super) fn weigh(
        &mut self,
        motion: &JointMotion<'_>,
        moves: &mut BodyMotion,
        pair: &Pair<'_>,
    ) {
        let Pair { robot: (robot, body), other: (other, part), near, farthest } = *pair;
        if part.contact.is_none() {
            let wrench = near.gradient_first(&motion.origin);
            let approach = -moves.along(&wrench);
            let speed = part.speed_towards(&near.normal);
            let human_speed = part.human_speed(speed.map(|speed| speed.measured));
            let settings = self.braking(moves, approach, &wrench);
            let required = settings.protective_distance(human_speed, approach);
            self.see(Nearest { robot, other, distance: near.distance, required, approach });
            let assumed = part.human_speed(speed.map(|speed| speed.worst));
            if near.distance < self.settings.protective_distance(assumed, 0.0) {
                let may_approach =
                    near.distance >= self.settings.protective_distance(human_speed, 0.0);
                let distance = near.distance;
                self.undercut.take((robot, body), part, distance, may_approach, &self.settings);
            }
        }
        let id = PointId { robot, other, end: None };
        self.weigh_point(motion, moves, (id, body, part), (&body.capsule, near));
        for (end, point) in body.capsule.ends().into_iter().enumerate() {
            let along = point - near.on_first;
            // The part is beyond the plane through its nearest point across the normal.
            let in_sight = near.distance + near.normal.dot(&along) <= farthest;
            if in_sight && along.norm_squared() > SAME_POINT * SAME_POINT {
                let at_end = body.capsule.at(point);
                let near = proximity(&at_end, &part.capsule);
                let id = PointId { end: Some(end), ..id };
                self.weigh_point(motion, moves, (id, body, part), (&at_end, near));
            }
        }
    }

    /// Takes a point on the axis of a capsule of the robot: where it is nearest to the part, of the capsule or of
    /// its end.
    fn weigh_point(
        &mut self,
        motion: &JointMotion<'_>,
        moves: &mut BodyMotion,
        bodies: (PointId, &RobotBody, &PersonBody),
        (capsule, seen): (&Capsule, Proximity),
    ) {
        let Some(mut candidate) = self.candidate(motion, moves, bodies, &seen) else { return };
        let (_, _, part) = bodies;
        // Of a part that may be touched and is too near only the direction counts: it is the one to where the
        // part has gone since it was seen, if it surely moves.
        if let Some(gone) = part.gone_if_touched().filter(|_| candidate.room < 0.0) {
            let apart = (seen.on_first - seen.on_second).norm();
            // Moved by so much, the least vector between two convex sets turns by no more than twice that over
            // its length.
            let turned = (2.0 * gone.norm() / apart).min(2.0) * moves.fastest;
            if candidate.headroom <= moves.change + turned {
                let near = proximity(capsule, &part.capsule.moved(&gone));
                let near = Proximity { distance: near.distance.min(seen.distance), ..near };
                let Some(by_now) = self.candidate(motion, moves, bodies, &near) else { return };
                candidate = by_now;
            }
        }
        self.consider(candidate, moves.change);
    }

    /// What a point may do where it is so near to the part; none if it is too far away to matter.
    fn candidate(
        &mut self,
        motion: &JointMotion<'_>,
        moves: &mut BodyMotion,
        (id, body, part): (PointId, &RobotBody, &PersonBody),
        near: &Proximity,
    ) -> Option<Candidate> {
        let wrench = near.gradient_first(&motion.origin);
        let approach = -moves.along(&wrench);
        let speed = part.speed_towards(&near.normal);
        let assumed = part.human_speed(speed.map(|speed| speed.worst));
        // The same as in sight, but for how fast the two truly come nearer to each other.
        if near.distance > self.reach(approach.max(0.0), moves.change).sight(assumed) {
            return None;
        }
        moves.tell_change(motion, body);
        let settings = self.braking(moves, approach, &wrench);
        let mut limit = settings.approach_limit(near.distance, assumed);
        // Where the distance alone permits all that may come in this tick, what a contact permits does not
        // matter.
        if let Some(contact) = part.contact.filter(|_| limit - approach <= moves.change) {
            let known = contact.velocity.map(|velocity| velocity.towards(&near.normal));
            let speed = known.or(speed);
            let (measured, worst) =
                speed.map_or((assumed, assumed), |speed| (speed.measured, speed.worst));
            limit = limit.max(contact.approach_limit(f64::INFINITY, measured, worst));
            // No more is needed where so much is permitted even for a robot that does not give way.
            if limit - approach <= moves.change {
                self.needs_inertia = true;
                let (jacobian, inverse) = (motion.jacobian, motion.inverse_inertia);
                let mass = self.mobility.mass(jacobian, inverse, body.joints, &wrench);
                limit = limit.max(contact.approach_limit(mass, measured, worst));
            }
        }
        Some(Candidate {
            id,
            normal: near.normal,
            point: near.on_first,
            joints: body.joints,
            opposite: None,
            room: near.distance - self.settings.protective_distance(assumed, 0.0),
            limit,
            headroom: limit - approach,
            contact: part.contact.is_some(),
        })
    }

    /// The settings with the deceleration of those joints that bring a pair nearer.
    fn braking(
        &self,
        moves: &BodyMotion,
        approach: f64,
        wrench: &Vector6<f64>,
    ) -> SeparationSettings {
        let of_base = -moves.base_along(wrench);
        self.settings.braking_by_parts(of_base, approach - of_base)
    }
}
