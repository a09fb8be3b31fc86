//! Constraint rows for pairs of the robot's own bodies.

use super::candidate::{Candidate, PointId};
use super::own_motion::OwnMotion;
use super::{ApproachRows, capsules};
use crate::approach::bodies::RobotBody;
use crate::approach::joint_motion::JointMotion;
use crate::approach::nearest::Nearest;
use crate::distance::proximity;
use crate::error::Error;

impl ApproachRows {
    /// Measures pairs of the robot's own bodies, given by their indices. Otherwise works like
    /// [`measure`](Self::measure). Allocates nothing.
    ///
    /// # Errors
    /// Those of [`measure`](Self::measure), and [`Error::Size`] if an index is not that of a body.
    pub fn measure_own(
        &mut self,
        motion: &JointMotion<'_>,
        robot: &[RobotBody],
        pairs: &[(usize, usize)],
    ) -> Result<Option<Nearest>, Error> {
        self.check(motion, robot)?;
        self.clear();
        self.bounds.advance_own(capsules(robot));
        let any = OwnMotion::of_all(motion, robot);
        let watched = self.watched_room;
        let farthest = self.reach(any.fastest, any.change).sight(0.0) + watched;
        let mut known = None;
        for &(i, j) in pairs {
            let (Some(first), Some(second)) = (robot.get(i), robot.get(j)) else {
                let (got, wanted) = (i.max(j), robot.len());
                return Err(Error::Size { what: "an index of a body", got, wanted });
            };
            let bound = self.bounds.get(i, j);
            if bound > farthest {
                continue;
            }
            let shared = first.joints.min(second.joints);
            let (index, moved) = if first.joints > shared { (i, first) } else { (j, second) };
            // Pairs of one body follow each other, and most of them share the same joints.
            let moves = match known {
                Some((key, moves)) if key == (index, shared) => moves,
                _ => OwnMotion::of_pair(motion, moved, shared),
            };
            known = Some(((index, shared), moves));
            if bound > self.reach(moves.fastest, moves.change).sight(0.0) + watched {
                continue;
            }
            let near = proximity(&first.capsule, &second.capsule);
            self.bounds.set(i, j, near.distance);
            self.least_distance = self.least_distance.min(near.distance);
            let twist = |body: &RobotBody| motion.twist(motion.velocity, body.joints);
            let approach = -twist(first).dot(&near.gradient_first(&motion.origin))
                - twist(second).dot(&near.gradient_second(&motion.origin));
            let distance = near.distance;
            let limit = self.settings.approach_limit(distance, 0.0);
            let required = self.settings.protective_distance(0.0, approach);
            self.see(Nearest { robot: i, other: j, distance, required, approach });
            let candidate = Candidate {
                id: PointId { robot: i, other: j, end: None },
                normal: near.normal,
                point: near.on_first,
                joints: first.joints,
                opposite: Some((near.on_second, second.joints)),
                room: distance - self.settings.protective_distance(0.0, 0.0),
                limit,
                headroom: limit - approach,
                contact: false,
            };
            self.consider(candidate, moves.change);
        }
        self.places.assign(&self.candidates);
        Ok(self.nearest)
    }
}
