//! Everybody in view, by the ids of the source.

use nalgebra::Vector3;
use vision_models::{Body, Percept, PersonId};

use crate::age::Age;
use crate::approach::PersonBody;
use crate::body_region::ContactLimits;
use crate::error::Error;
use crate::person_bodies::PersonBodies;
use crate::separation::SeparationSettings;

/// Largest number of people who are remembered beside the one who works with the robot.
pub const MOST: usize = 4;
const ROOM: usize = MOST + 1;

/// Everybody who was seen, each in a place of their own. A person who is not seen is remembered.
/// Only the one who works with the robot may be touched.
#[derive(Debug, Clone)]
pub(super) struct SeenPeople {
    people: [PersonBodies; ROOM],
    /// Place of the person who works with the robot, or did so last.
    worker: Option<usize>,
    /// Time of the newest frame that shows nobody at work, or somebody where they can be \[s\].
    plausible: f64,
}

impl SeenPeople {
    /// Creates an empty list with this standard deviation and these limits.
    pub(super) fn new(position_sigma: f64, limits: &ContactLimits) -> Self {
        Self {
            // Clones would not keep the capacity, and would allocate in the control loop.
            people: std::array::from_fn(|_| PersonBodies::new(position_sigma, limits)),
            worker: None,
            plausible: f64::NEG_INFINITY,
        }
    }

    /// Room for the bodies of all people.
    pub(super) const fn room() -> usize {
        ROOM * PersonBodies::ROOM
    }

    /// Forgets all people.
    pub(super) fn forget(&mut self) {
        self.people.iter_mut().for_each(PersonBodies::forget);
        (self.worker, self.plausible) = (None, f64::NEG_INFINITY);
    }

    /// Returns the age of the newest plausible frame.
    pub(super) fn age(&self, now: f64) -> Age {
        Age::new((now - self.plausible).max(0.0)).unwrap_or(Age::NEVER)
    }

    /// Takes the person who works with the robot from a frame. One without an id is the one before.
    /// So is the first one with an id after one without.
    pub(super) fn observe(&mut self, percept: &Percept) -> Result<(), Error> {
        let Some(body) = &percept.body else {
            // A frame without a person does not change what is known of the person seen before.
            self.plausible = percept.time;
            return Ok(());
        };
        let same = self.worker.filter(|&index| {
            body.id().is_none()
                || self.people.get(index).is_some_and(|person| person.id().is_none())
        });
        let place = self.known(body.id()).or(same).or_else(|| self.empty());
        let Some(person) = place.and_then(|index| self.people.get_mut(index)) else {
            return Err(Error::TooManyPeople { got: 1, left_out: 1, most: MOST });
        };
        self.worker = place;
        let impossible = person.see(percept.time, body);
        self.plausible = person.plausible();
        impossible.map_or(Ok(()), |speed| Err(Error::BodySpeed { speed }))
    }

    /// Takes the other people in the frame of a percept. A worker who is among them works no longer.
    /// A person without an id is new in each frame.
    pub(super) fn observe_others(
        &mut self,
        percept: &Percept,
        bodies: &[Body],
    ) -> Result<(), Error> {
        let (mut left_out, mut impossible) = (0, None);
        let mut taken = [false; ROOM];
        if let Some(taken) = self.worker.and_then(|index| taken.get_mut(index)) {
            *taken = percept.body.is_some();
        }
        for body in bodies {
            let known = self.known(body.id());
            let known = known.filter(|&index| taken.get(index) == Some(&false));
            let place = known.or_else(|| self.empty().filter(|_| self.others() < MOST));
            let person = place.and_then(|index| {
                Some((index, self.people.get_mut(index)?, taken.get_mut(index)?))
            });
            let Some((index, person, taken)) = person else {
                left_out += 1;
                continue;
            };
            self.worker = self.worker.filter(|worker| *worker != index);
            *taken = true;
            impossible = person.see(percept.time, body).or(impossible);
        }
        if left_out > 0 {
            return Err(Error::TooManyPeople { got: bodies.len(), left_out, most: MOST });
        }
        impossible.map_or(Ok(()), |speed| Err(Error::BodySpeed { speed }))
    }

    /// Returns the place of the person with this id.
    fn known(&self, id: Option<PersonId>) -> Option<usize> {
        let id = id?;
        self.people.iter().position(|person| !person.is_empty() && person.id() == Some(id))
    }

    fn empty(&self) -> Option<usize> {
        self.people.iter().position(PersonBodies::is_empty)
    }

    /// Returns the number of known people who do not work with the robot.
    fn others(&self) -> usize {
        let people = self.people.iter().enumerate();
        people.filter(|(index, person)| Some(*index) != self.worker && !person.is_empty()).count()
    }

    fn worker(&self) -> Option<&PersonBodies> {
        self.people.get(self.worker?)
    }

    /// Replaces `bodies` by the capsules of all people at the time `now`. Those of the person who
    /// works with the robot come first, and may be touched if `contact_speed` is positive.
    pub(super) fn place(
        &mut self,
        now: f64,
        separation: &SeparationSettings,
        contact_speed: f64,
        bodies: &mut Vec<PersonBody>,
    ) {
        bodies.clear();
        if let Some(worker) = self.worker.and_then(|index| self.people.get_mut(index)) {
            bodies.extend_from_slice(worker.place(now, separation, contact_speed));
        }
        for (index, person) in self.people.iter_mut().enumerate() {
            if Some(index) != self.worker && !person.is_empty() {
                bodies.extend_from_slice(person.place(now, separation, 0.0));
            }
        }
    }

    /// Returns the capsules of the person who works with the robot, as computed last.
    pub(super) fn placed(&self) -> &[PersonBody] {
        self.worker().map_or(&[], PersonBodies::placed)
    }

    /// Returns the velocity of the pelvis of the person who works with the robot along the floor
    /// \[m/s\], zero if it is not measured.
    pub(super) fn velocity(&self, now: f64, separation: &SeparationSettings) -> Vector3<f64> {
        self.worker().map_or(Vector3::zeros(), |person| person.velocity(now, separation))
    }
}
