//! Distance at which a part of a person matters, in whichever direction it moves.

use super::body_motion::BodyMotion;
use super::reach::Reach;
use crate::approach::bodies::PersonBody;

/// Quantities of a pair that do not depend on the place of the robot.
#[derive(Debug, Clone, Copy)]
pub(super) struct PartSpeeds {
    /// Largest speed of the part towards the robot \[m/s\].
    human: f64,
    /// Speed of approach that a contact allows for every mass of the robot \[m/s\]. Negative
    /// infinity for a part that must not be touched.
    permitted: f64,
    /// Room that is watched beyond the distance at which a row may be needed \[m\].
    pub(super) watched_room: f64,
}

impl PartSpeeds {
    /// Computes the speeds of a part. `watched` is the room that is watched for pairs that may not
    /// touch \[m\].
    pub(super) fn of(part: &PersonBody, watched: f64) -> Self {
        let human = part.human_speed(part.fastest());
        let permitted = part.contact.map_or(f64::NEG_INFINITY, |contact| {
            let known = contact.velocity.or(part.velocity);
            let (measured, worst) = known.map_or((human, human), |velocity| {
                let speed = velocity.mean.norm();
                (speed, speed + velocity.uncertainty)
            });
            contact.approach_limit(f64::INFINITY, measured, worst)
        });
        // Pairs that may touch are never reported as nearest. They matter only where they may need
        // a row.
        let watched_room = if part.contact.is_none() { watched } else { 0.0 };
        Self { human, permitted, watched_room }
    }

    /// Returns bounds of the speeds of several parts, none of which may be touched.
    pub(super) fn most(parts: &[Self]) -> Self {
        let none = Self { human: 0.0, permitted: f64::NEG_INFINITY, watched_room: 0.0 };
        parts.iter().fold(none, |most, part| Self {
            human: most.human.max(part.human),
            watched_room: most.watched_room.max(part.watched_room),
            ..most
        })
    }

    /// Returns the distance beyond which the part needs no row for a body of the robot \[m\]. It is
    /// negative infinity if a contact allows every speed that the two can reach within this tick.
    pub(super) fn sight(&self, moves: &BodyMotion, reach: Reach) -> f64 {
        let is_free = self.permitted - moves.fastest > moves.change;
        if is_free { f64::NEG_INFINITY } else { reach.sight(self.human) }
    }
}
