//! People in view other than the one who works with the robot.

use vision_models::{Body, Percept};

use crate::approach::PersonBody;
use crate::body_region::ContactLimits;
use crate::person_bodies::PersonBodies;
use crate::separation::SeparationSettings;
use crate::settings::PersonBodySettings;

/// Largest number of other people that are tracked.
pub const MOST: usize = 4;

/// People in view other than the person who works with the robot. None of them may be touched. A
/// person who is not seen is remembered as long as the person who works with the robot would be.
#[derive(Debug, Clone)]
pub(super) struct Bystanders {
    people: [PersonBodies; MOST],
}

impl Bystanders {
    /// Creates an empty list with these settings and limits.
    pub(super) fn new(settings: PersonBodySettings, limits: &ContactLimits) -> Self {
        // Clones would not keep the capacity, and would allocate in the control loop.
        Self { people: std::array::from_fn(|_| PersonBodies::new(settings, limits)) }
    }

    /// Room for the bodies of all of them.
    pub(super) const fn room() -> usize {
        MOST * PersonBodies::ROOM
    }

    /// Forgets all people.
    pub(super) fn forget(&mut self) {
        self.people.iter_mut().for_each(PersonBodies::forget);
    }

    /// Takes the bodies of a frame. Each body goes to the nearest person who can have moved there
    /// and has no body of this frame yet. Otherwise it becomes a new person. A person who is at the
    /// place of the one who works with the robot is forgotten. Returns the number of bodies for
    /// which there was no room.
    pub(super) fn observe(&mut self, percept: &Percept, bodies: &[Body]) -> usize {
        let time = percept.time;
        let mut taken = [false; MOST];
        let mut left_out = 0;
        for body in bodies {
            let places = self.people.iter().zip(taken).enumerate().filter(|(_, (_, taken))| !taken);
            let ways = places.clone().filter_map(|(index, (person, _))| {
                person.way_to(time, body).map(|way| (index, way))
            });
            let nearest = ways.min_by(|(_, one), (_, other)| one.total_cmp(other));
            let mut empty = places.filter(|(_, (person, _))| person.is_empty());
            let place =
                nearest.map(|(index, _)| index).or_else(|| empty.next().map(|(index, _)| index));
            let slot = place.and_then(|index| self.people.get_mut(index).zip(taken.get_mut(index)));
            match slot {
                Some((person, taken)) => {
                    person.see(time, body);
                    // A body without visible joints is no person.
                    *taken = !person.is_empty();
                }
                None => left_out += 1,
            }
        }
        let unseen = self.people.iter_mut().zip(taken).filter(|(_, taken)| !taken);
        for (person, _) in unseen {
            if percept.body.as_ref().is_some_and(|body| person.is_where(time, body)) {
                person.forget();
            }
        }
        left_out
    }

    /// Appends the capsules of these people at the time `now` to `bodies`.
    pub(super) fn place(
        &mut self,
        now: f64,
        separation: &SeparationSettings,
        bodies: &mut Vec<PersonBody>,
    ) {
        for person in self.people.iter_mut().filter(|person| !person.is_empty()) {
            bodies.extend_from_slice(person.place(now, separation, 0.0));
        }
    }
}
