//! Assembles people from connected joints.

use nalgebra::Point2;

use crate::body::ImageKeypoint;
use crate::confidence::Confidence;

use super::limbs::Connection;
use super::peaks::Peak;
use super::{Coco18, GroupingSettings};

/// Joints of one person: for each of the eighteen, the number of its maximum.
#[derive(Clone, Copy, Debug, Default)]
struct Person {
    joints: [Option<usize>; 18],
    /// Sum of the scores of the connections.
    connections: f64,
}

impl Person {
    fn of(end: (usize, usize)) -> Self {
        let mut person = Self::default();
        person.joints[end.0] = Some(end.1);
        person
    }

    fn has(&self, (joint, peak): (usize, usize)) -> bool {
        self.joints[joint] == Some(peak)
    }

    /// Returns true if the two have no joint of the same kind.
    fn is_apart_from(&self, other: &Self) -> bool {
        self.joints.iter().zip(&other.joints).all(|(one, other)| one.is_none() || other.is_none())
    }

    fn join(&mut self, other: &Self) {
        for (joint, other) in self.joints.iter_mut().zip(other.joints) {
            *joint = joint.or(other);
        }
        self.connections += other.connections;
    }
}

/// Joins joints along the connections, the best first. A connection that would give a person two
/// joints of one kind is left out.
pub(super) fn assemble(
    peaks: &[Vec<Peak>],
    connections: Vec<Connection>,
    settings: &GroupingSettings,
) -> Vec<Coco18> {
    let mut people: Vec<Person> = Vec::new();
    for Connection { ends, score } in connections {
        let [one, other] = ends.map(|end| {
            people.iter().position(|person| person.has(end)).unwrap_or_else(|| {
                people.push(Person::of(end));
                people.len() - 1
            })
        });
        if one == other {
            people[one].connections += score;
        } else if people[one].is_apart_from(&people[other]) {
            let (kept, gone) = (one.min(other), one.max(other));
            let gone = people.swap_remove(gone);
            people[kept].join(&gone);
            people[kept].connections += score;
        }
    }
    let peak = |joint: usize, index: Option<usize>| index.and_then(|index| peaks[joint].get(index));
    let joints = |person: &Person| {
        (0..)
            .zip(person.joints)
            .filter_map(|(joint, index)| peak(joint, index))
            .copied()
            .collect::<Vec<_>>()
    };
    let mut scored: Vec<(f64, Person)> = people
        .into_iter()
        .filter_map(|person| {
            let seen = joints(&person);
            let heights: f64 = seen.iter().map(|peak| peak.height).sum();
            let score = (heights + person.connections) / seen.len().max(1) as f64;
            (seen.len() >= settings.least_joints && score >= settings.score)
                .then_some((score, person))
        })
        .collect();
    scored.sort_by(|one, other| other.0.total_cmp(&one.0));
    let keypoint = |peak: &Peak| {
        let confidence = Confidence::new(peak.height.clamp(0.0, 1.0)).ok()?;
        Some(ImageKeypoint { position: Point2::from(peak.at), confidence })
    };
    let body = |(_, person): (f64, Person)| {
        std::array::from_fn(|joint| peak(joint, person.joints[joint]).and_then(keypoint))
    };
    scored.into_iter().map(body).collect()
}
