//! The people beside the one who works with the robot.

use vision_models::{Body, Percept};

use crate::approach::PersonBody;
use crate::body_region::ContactLimits;
use crate::person_bodies::PersonBodies;
use crate::separation::SeparationSettings;
use crate::settings::PersonBodySettings;

/// How many there is room for.
pub const MOST: usize = 4;

/// Everybody in view but the person who works with the robot. Nobody of them may be touched. Who is missed in a frame, or leaves the view, counts as long as the
/// person does who works with the robot.
#[derive(Debug, Clone)]
pub(super) struct Bystanders {
    people: [PersonBodies; MOST],
}

impl Bystanders {
    /// Nobody, of whom these settings and limits hold.
    pub(super) fn new(settings: PersonBodySettings, limits: &ContactLimits) -> Self {
        // A clone would have no room for the parts, and get it in the control loop.
        Self { people: std::array::from_fn(|_| PersonBodies::new(settings, limits)) }
    }

    /// Room for the bodies of all of them.
    pub(super) const fn room() -> usize {
        MOST * PersonBodies::ROOM
    }

    /// Forgets everybody.
    pub(super) fn forget(&mut self) {
        self.people.iter_mut().for_each(PersonBodies::forget);
    }

    /// Takes the bodies of a frame: each goes to the nearest of those who can have gone there and have none of this
    /// frame yet, or is somebody new. Who works with the robot from now on is nobody of them any more. Returns how
    /// many there is no room for.
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
                    // A body of which nothing is seen is nobody.
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

    /// Adds their capsules at the time `now` to `bodies`.
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
