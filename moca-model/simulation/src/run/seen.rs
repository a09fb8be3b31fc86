//! People as the recording shows them.

use std::collections::VecDeque;

use nalgebra::{Point3, Vector3};
use vision_models::{Body, Body25};

use crate::judges::body;
use crate::people::Joints;

/// How long the person's velocity is the mean of \[s\].
const SPAN: f64 = 0.5;

/// Each joint where it was seen last, for want of knowing where it truly is \[m\].
#[derive(Clone, Debug, Default)]
pub(super) struct SeenPerson {
    joints: [Option<Point3<f64>>; Body25::COUNT],
    /// Middle of the trunk, and when \[m, s\].
    trunk: VecDeque<(f64, Vector3<f64>)>,
}

impl SeenPerson {
    /// Takes the body of a frame; joints below this confidence stay where they were.
    pub(super) fn update(&mut self, time: f64, body: &Body, least_confidence: f64) {
        for (joint, place) in Body25::ALL.into_iter().zip(&mut self.joints) {
            let seen = body.get(joint);
            if let Some(seen) = seen.filter(|seen| seen.confidence.value() >= least_confidence) {
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

    /// The same joints as they were `period` \[s\] before, if they move as the trunk did of late: the slope
    /// of the line through its places.
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

    /// All joints that capsules are between, once each has been seen.
    pub(super) fn joints(&self) -> Option<Joints> {
        let all = body::joints().all(|joint| self.joints[joint.index()].is_some());
        all.then(|| self.joints.map(Option::unwrap_or_default))
    }
}

/// Nobody goes farther from one frame to the next than this speed takes them \[m/s\], and than noise \[m\].
const FASTEST: f64 = 3.0;
const NOISE: f64 = 0.3;

/// How long somebody counts who is not seen again \[s\].
const REMEMBERED: f64 = 1.0;

/// The people beside the one who works with the robot.
#[derive(Clone, Debug, Default)]
pub(super) struct SeenOthers {
    /// Each with when and where they were seen last \[s, m\].
    people: Vec<(f64, Point3<f64>, SeenPerson)>,
}

impl SeenOthers {
    /// Takes the bodies of a frame: each is whoever was nearest, if they can have gone there. Who works with the
    /// robot from now on, at `person`, is nobody of them any more.
    pub(super) fn update(
        &mut self,
        time: f64,
        person: Option<&Body>,
        bodies: &[Body],
        least_confidence: f64,
    ) {
        self.people.retain(|(last, ..)| time - last <= REMEMBERED);
        for body in bodies {
            let Some(place) = body.get(Body25::MidHip).map(|seen| seen.position) else { continue };
            let ways = self.people.iter_mut().filter(|(last, ..)| *last < time);
            let nearest = ways.min_by(|(_, one, _), (_, other, _)| {
                (one - place).norm().total_cmp(&(other - place).norm())
            });
            let same = nearest.filter(|(last, before, _)| {
                (place - *before).norm() <= FASTEST * (time - *last) + NOISE
            });
            if let Some((last, before, person)) = same {
                (*last, *before) = (time, place);
                person.update(time, body, least_confidence);
            } else {
                let mut person = SeenPerson::default();
                person.update(time, body, least_confidence);
                self.people.push((time, place, person));
            }
        }
        if let Some(pelvis) = person.and_then(|body| body.get(Body25::MidHip)) {
            self.people.retain(|(last, place, _)| {
                *last == time || (pelvis.position - place).norm() > NOISE
            });
        }
    }

    /// Of everybody, a `period` \[s\] before and now.
    pub(super) fn joints(&self, period: f64) -> Vec<(Joints, Joints)> {
        let joints = self.people.iter().filter_map(|(_, _, person)| {
            let now = person.joints()?;
            Some((person.before(&now, period), now))
        });
        joints.collect()
    }
}
