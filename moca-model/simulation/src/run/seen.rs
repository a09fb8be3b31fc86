//! People as the recording shows them.

use std::collections::VecDeque;

use hrsw_safety::LEAST_CONFIDENCE;
use nalgebra::{Point3, Vector3};
use simulated_people::Joints;
use vision_models::{Body, Body25, PersonId};

use crate::judges::body;

/// Averaging time of the person's velocity \[s\].
const SPAN: f64 = 0.5;

/// The last seen place of each joint, used where the true place is not known \[m\].
#[derive(Clone, Debug, Default)]
pub(super) struct SeenPerson {
    joints: [Option<Point3<f64>>; Body25::COUNT],
    /// Middle of the trunk, and its times \[m, s\].
    trunk: VecDeque<(f64, Vector3<f64>)>,
}

impl SeenPerson {
    /// Takes the body of a frame. Joints below [`LEAST_CONFIDENCE`] stay where they were.
    pub(super) fn update(&mut self, time: f64, body: &Body) {
        for (joint, place) in Body25::ALL.into_iter().zip(&mut self.joints) {
            let seen = body.get(joint);
            if let Some(seen) = seen.filter(|seen| seen.confidence.value() >= LEAST_CONFIDENCE) {
                *place = Some(seen.position);
            }
        }
        let places = |joint: Body25| self.joints[joint.index()];
        if let (Some(neck), Some(hip)) = (places(Body25::Neck), places(Body25::MidHip)) {
            self.trunk.push_back((time, (neck.coords + hip.coords) * 0.5));
            while self.trunk.front().is_some_and(|(first, _)| time - first > SPAN) {
                self.trunk.pop_front();
            }
        }
    }

    /// The same joints `period` \[s\] before, if they move as the trunk did recently: the slope of the line through its
    /// places.
    pub(super) fn before(&self, joints: &Joints, period: f64) -> Joints {
        let count = self.trunk.len().max(1) as f64;
        let middle = self.trunk.iter().map(|(time, _)| time).sum::<f64>() / count;
        let (mut sum, mut squares) = (Vector3::zeros(), 0.0);
        for (time, place) in &self.trunk {
            sum += place * (time - middle);
            squares += (time - middle) * (time - middle);
        }
        let velocity = if squares > 0.0 { sum / squares } else { Vector3::zeros() };
        joints.map(|joint| joint - velocity * period)
    }

    /// The joints at the ends of capsules, once each has been seen.
    pub(super) fn joints(&self) -> Option<Joints> {
        let all = body::joints().all(|joint| self.joints[joint.index()].is_some());
        all.then(|| self.joints.map(Option::unwrap_or_default))
    }
}

/// Time for which a person counts who is not seen again \[s\].
const REMEMBERED: f64 = 1.0;

/// The people besides the one who works with the robot.
#[derive(Clone, Debug, Default)]
pub(super) struct SeenOthers {
    /// Each person with their id, and the time when they were seen last \[s\].
    people: Vec<(Option<PersonId>, f64, SeenPerson)>,
}

impl SeenOthers {
    /// Takes the bodies of a frame. The person who works with the robot from now on is removed. A body without an id
    /// is a new person.
    pub(super) fn update(&mut self, time: f64, worker: Option<&Body>, bodies: &[Body]) {
        let worker = worker.and_then(Body::id);
        self.people.retain(|(id, last, _)| {
            time - last <= REMEMBERED && (worker.is_none() || *id != worker)
        });
        for body in bodies {
            let id = body.id();
            let mut people = self.people.iter_mut();
            if let Some((_, last, person)) = people.find(|known| id.is_some() && known.0 == id) {
                *last = time;
                person.update(time, body);
            } else {
                let mut person = SeenPerson::default();
                person.update(time, body);
                self.people.push((id, time, person));
            }
        }
    }

    /// The joints of all people, a `period` \[s\] before and now.
    pub(super) fn joints(&self, period: f64) -> Vec<(Joints, Joints)> {
        let joints = self.people.iter().filter_map(|(_, _, person)| {
            let now = person.joints()?;
            Some((person.before(&now, period), now))
        });
        joints.collect()
    }
}
