//! Bodies of robot and person, placed in the world.

use nalgebra::Vector3;

use crate::contact::Contact;
use crate::error::{Error, check_all, check_capsule, not_negative};
use crate::measured_velocity::{MeasuredVelocity, SpeedTowards};
use hrsw::Capsule;

/// A body of the robot, placed in the world.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RobotBody {
    /// Its shape in the world \[m\].
    pub capsule: Capsule,
    /// How many of the joints, from the first, move it.
    pub joints: usize,
}

/// A part of the person's body, placed in the world.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PersonBody {
    /// Its shape in the world \[m\].
    pub capsule: Capsule,
    /// Its own velocity, where it is measured.
    pub velocity: Option<MeasuredVelocity>,
    /// How fast it may come nearer where its velocity is not measured \[m/s\]:
    /// [`SeparationSettings::human_speed`](crate::SeparationSettings::human_speed) or, for hands and arms, [`SeparationSettings::arm_speed`](crate::SeparationSettings::arm_speed).
    pub assumed_speed: f64,
    /// How long ago it was seen there, as far as the reaction time covers that, and the shape does not: it has
    /// moved on since \[s\]. A robot that may come no nearer goes away from where it is now, and one that may
    /// touch it is slow towards there.
    pub age: f64,
    /// How much of the shape's radius stands for not knowing where the part is \[m\], beyond
    /// [`SeparationSettings::human_uncertainty`](crate::SeparationSettings::human_uncertainty): which direction leads away from it is the less certain.
    pub uncertainty: f64,
    /// For a part that the robot may touch now: whatever the distance, the two may come nearer to each
    /// other as fast as their contact allows. None where only the distance counts.
    pub contact: Option<Contact>,
}

impl PersonBody {
    /// How far the part has moved since it was seen, and how far it may be from there \[m\].
    pub(super) fn since_seen(&self) -> (Vector3<f64>, f64) {
        match &self.velocity {
            Some(velocity) => (velocity.mean * self.age, velocity.uncertainty * self.age),
            None => (Vector3::zeros(), self.assumed_speed * self.age),
        }
    }

    /// v_h of a part that comes nearer at a measured speed; receding counts as standing \[m/s\].
    pub(super) fn human_speed(&self, measured: Option<f64>) -> f64 {
        measured.map_or(self.assumed_speed, |speed| speed.max(0.0))
    }

    /// How far a part that may be touched has gone since it was seen, if it went on as measured \[m\]; none for
    /// others, and of somebody who may as well stand.
    pub(super) fn gone_if_touched(&self) -> Option<Vector3<f64>> {
        let velocity = self.contact?.velocity.or(self.velocity)?;
        let moves = velocity.mean.norm() > velocity.uncertainty;
        moves.then(|| velocity.mean * self.age)
    }

    /// How fast the part comes nearer along a unit normal that points away from it, where that is known.
    pub(super) fn speed_towards(&self, normal: &Vector3<f64>) -> Option<SpeedTowards> {
        self.velocity.map(|velocity| velocity.towards(normal))
    }

    /// How fast the part moves at most, where that is known \[m/s\]: the sum of the parts is no less than the norm.
    pub(super) fn fastest(&self) -> Option<f64> {
        self.velocity.map(|velocity| velocity.mean.abs().sum() + velocity.uncertainty)
    }

    pub(super) fn check(&self) -> Result<(), Error> {
        check_capsule("a capsule of the person", &self.capsule)?;
        not_negative("the age of a person's body", self.age)?;
        not_negative("the uncertainty of a person's place", self.uncertainty)?;
        not_negative("the assumed speed of a person's body", self.assumed_speed)?;
        let of_contact = self.contact.and_then(|contact| contact.velocity);
        for velocity in self.velocity.iter().chain(&of_contact) {
            check_all("the velocity of a person's body", velocity.mean.iter())?;
            not_negative("the uncertainty of a person's velocity", velocity.uncertainty)?;
        }
        self.contact.as_ref().map_or(Ok(()), Contact::validate)
    }
}
