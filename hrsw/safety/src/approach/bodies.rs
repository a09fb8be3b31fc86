//! Bodies of robot and person, placed in the world.

use nalgebra::Vector3;

use crate::contact::Contact;
use crate::error::{Error, check_all, check_capsule, not_negative};
use crate::measured_velocity::{MeasuredVelocity, SpeedTowards};
use hrsw::Capsule;

/// A body of the robot, placed in the world.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RobotBody {
    /// Shape in the world frame \[m\].
    pub capsule: Capsule,
    /// Number of joints, counted from the first, that move the body.
    pub joints: usize,
}

/// A part of the person's body, placed in the world.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PersonBody {
    /// Shape in the world frame \[m\].
    pub capsule: Capsule,
    /// Velocity of the part. None if it is not measured.
    pub velocity: Option<MeasuredVelocity>,
    /// Largest speed towards the robot if the velocity is not measured \[m/s\]. This is
    /// [`SeparationSettings::human_speed`](crate::SeparationSettings::human_speed) or, for hands
    /// and arms, [`SeparationSettings::arm_speed`](crate::SeparationSettings::arm_speed).
    pub assumed_speed: f64,
    /// Time since the part was seen at this place, as far as the reaction time covers it \[s\]. The
    /// shape does not account for this motion. A robot that must not approach retreats from the
    /// place where the part is now. A robot that may touch the part is slow towards that place.
    pub age: f64,
    /// Part of the shape's radius that accounts for the unknown place of the part \[m\], beyond
    /// [`SeparationSettings::human_uncertainty`](crate::SeparationSettings::human_uncertainty). The
    /// larger it is, the less certain is the direction that leads away from the part.
    pub uncertainty: f64,
    /// Limits of a contact if the robot may touch the part now. The two may then approach each
    /// other as fast as the contact allows, at any distance. None if only the distance counts.
    pub contact: Option<Contact>,
}

impl PersonBody {
    /// Returns how far the part has moved since it was seen, and the uncertainty of that \[m\].
    pub(super) fn since_seen(&self) -> (Vector3<f64>, f64) {
        match &self.velocity {
            Some(velocity) => (velocity.mean * self.age, velocity.uncertainty * self.age),
            None => (Vector3::zeros(), self.assumed_speed * self.age),
        }
    }

    /// Returns v_h for a part that approaches at a measured speed \[m/s\]. Receding counts as
    /// standing.
    pub(super) fn human_speed(&self, measured: Option<f64>) -> f64 {
        measured.map_or(self.assumed_speed, |speed| speed.max(0.0))
    }

    /// Returns the displacement since a part that may be touched was seen, by its measured velocity
    /// \[m\]. None for parts that may not be touched, and for parts that may be at rest.
    pub(super) fn gone_if_touched(&self) -> Option<Vector3<f64>> {
        let velocity = self.contact?.velocity.or(self.velocity)?;
        let moves = velocity.mean.norm() > velocity.uncertainty;
        moves.then(|| velocity.mean * self.age)
    }

    /// Returns the speed of the part along a unit normal that points away from it. None if it is
    /// not measured.
    pub(super) fn speed_towards(&self, normal: &Vector3<f64>) -> Option<SpeedTowards> {
        self.velocity.map(|velocity| velocity.towards(normal))
    }

    /// Returns an upper bound of the speed of the part \[m/s\]: the 1-norm of the velocity and the
    /// uncertainty. None if the velocity is not measured.
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
