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

/// An end of a capsule within this of the nearest point counts as that point \[m\].
const SAME_POINT: f64 = 1e-6;

/// A body of the robot and a part of the person, by their indices.
#[derive(Debug, Clone, Copy)]
pub(super) struct Pair<'a> {
    pub(super) robot: (usize, &'a RobotBody),
    pub(super) other: (usize, &'a PersonBody),
    pub(super) near: Proximity,
    /// Distance beyond which points of the robot need no row \[m\].
    pub(super) sight: f64,
}

impl ApproachRows {
    /// Evaluates a pair in sight. Keeps what the supervisor needs to know, and considers the points
    /// of the robot's capsule that may get a row: the nearest point and both ends.
    pub(super) fn evaluate(
        &mut self,
        motion: &JointMotion<'_>,
        moves: &mut BodyMotion,
        pair: &Pair<'_>,
    ) {
        let Pair { robot: (robot, body), other: (other, part), near, sight } = *pair;
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
                self.violations.take((robot, body), part, &self.settings);
            }
        }
        // Pairs farther away are only watched.
        if near.distance > sight {
            return;
        }
        let id = PointId { robot, other, end: None };
        self.evaluate_point(motion, moves, (id, body, part), (&body.capsule, near));
        for (end, point) in body.capsule.ends().into_iter().enumerate() {
            let along = point - near.on_first;
            // The whole part lies beyond the plane through its nearest point that is normal to the
            // normal.
            let in_sight = near.distance + near.normal.dot(&along) <= sight;
            if in_sight && along.norm_squared() > SAME_POINT * SAME_POINT {
                let at_end = body.capsule.at(point);
                let near = proximity(&at_end, &part.capsule);
                let id = PointId { end: Some(end), ..id };
                self.evaluate_point(motion, moves, (id, body, part), (&at_end, near));
            }
        }
    }

    /// Considers a point on the axis of a capsule of the robot. It is the nearest point of the
    /// capsule or of one of its ends.
    fn evaluate_point(
        &mut self,
        motion: &JointMotion<'_>,
        moves: &mut BodyMotion,
        bodies: (PointId, &RobotBody, &PersonBody),
        (capsule, seen): (&Capsule, Proximity),
    ) {
        let Some(mut candidate) = self.candidate(motion, moves, bodies, &seen) else { return };
        let (_, _, part) = bodies;
        // If a part may be touched and is too near, only the direction counts. If the part surely
        // moves, this is the direction to where it has gone since it was seen.
        if let Some(gone) = part.gone_if_touched().filter(|_| candidate.room < 0.0) {
            let apart = (seen.on_first - seen.on_second).norm();
            // A displacement of this length turns the shortest vector between two convex sets by at
            // most twice the displacement over the length of the vector.
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

    /// Returns the candidate row of a point so near to the part. None if the point is too far away
    /// or too slow to matter.
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
        // Uses the actual speed of approach, which is tighter than the distance of sight.
        if near.distance > self.reach(approach.max(0.0), moves.change).sight(assumed) {
            return None;
        }
        moves.tell_change(motion, body);
        let settings = self.braking(moves, approach, &wrench);
        let mut limit = settings.approach_limit(near.distance, assumed);
        // The contact does not matter if the distance alone allows every speed that this tick can
        // reach.
        if let Some(contact) = part.contact.filter(|_| limit - approach <= moves.change) {
            let known = contact.velocity.map(|velocity| velocity.towards(&near.normal));
            let speed = known.or(speed);
            let (measured, worst) =
                speed.map_or((assumed, assumed), |speed| (speed.measured, speed.worst));
            limit = limit.max(contact.approach_limit(f64::INFINITY, measured, worst));
            // The mass is not needed if even a robot that does not give way may be as fast.
            if limit - approach <= moves.change {
                self.needs_inertia = true;
                let (jacobian, inverse) = (motion.jacobian, motion.inverse_inertia);
                let mass = self.mobility.mass(jacobian, inverse, body.joints, &wrench);
                limit = limit.max(contact.approach_limit(mass, measured, worst));
            }
        }
        let room = near.distance - self.settings.protective_distance(assumed, 0.0);
        // Within this tick the pair cannot reach its limit, and is not too near.
        if limit - approach > moves.change && room >= 0.0 {
            return None;
        }
        Some(Candidate {
            id,
            normal: near.normal,
            point: near.on_first,
            joints: body.joints,
            opposite: None,
            room,
            limit,
            headroom: limit - approach,
            contact: part.contact.is_some(),
        })
    }

    /// Returns the settings with the deceleration of the joints that bring the pair closer.
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
