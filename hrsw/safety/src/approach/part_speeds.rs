//! How far a part of a person matters, whichever way it moves.

use super::body_motion::BodyMotion;
use super::reach::Reach;
use crate::approach::bodies::PersonBody;

/// What of a pair does not depend on where the robot is.
#[derive(Debug, Clone, Copy)]
pub(super) struct PartSpeeds {
    /// How fast the part may come nearer \[m/s\].
    human: f64,
    /// How fast the robot may come nearer in any case, as a contact permits it, however heavy the robot
    /// \[m/s\]; of a part that it may not touch nothing is permitted in any case.
    permitted: f64,
    /// How much room is watched beyond where a row may be needed \[m\].
    watched_room: f64,
}

impl PartSpeeds {
    /// `watched` is how much room is watched of pairs that may not touch \[m\].
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
        // Pairs that may touch are nobody's nearest, and count only where they may need a row.
        let watched_room = if part.contact.is_none() { watched } else { 0.0 };
        Self { human, permitted, watched_room }
    }

    /// From where on the part is of no interest to a body of the robot that moves like this \[m\]: nowhere where
    /// the two may come nearer as fast as they can within this tick however near they are.
    pub(super) fn farthest(&self, moves: &BodyMotion, reach: Reach) -> f64 {
        let is_free = self.permitted - moves.fastest > moves.change;
        let sight = reach.sight(self.human) + self.watched_room;
        if is_free { f64::NEG_INFINITY } else { sight }
    }
}
