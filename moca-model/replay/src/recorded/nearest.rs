//! Nearest points of robot and person, by the shapes that are drawn.

use hrsw_safety::{Capsule, proximity};
use nalgebra::{Isometry3, Vector3};

use super::body::{BodyPart, LIMBS, Points};

/// Two points on the surfaces, and their distance \[m\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Near {
    pub(super) distance: f64,
    pub(super) on_robot: Vector3<f64>,
    pub(super) on_person: Vector3<f64>,
}

/// Returns the nearest pair of the robot's capsules, each in a frame of these poses, and the person's capsules. Only
/// parts of the person for which `counts` returns true are used. Returns `None` if one of the two is not there.
pub(super) fn nearest(
    capsules: &[(usize, Capsule)],
    pose: impl Fn(usize) -> Option<Isometry3<f64>>,
    points: &Points,
    stature: f64,
    counts: impl Fn(BodyPart) -> bool,
) -> Option<Near> {
    let person: Vec<Capsule> = LIMBS
        .iter()
        .filter(|limb| counts(limb.part))
        .filter_map(|limb| {
            let [from, to] = limb.ends.map(|end| points.get(end).copied().flatten());
            let [first, second] = limb.radii;
            Capsule::new(from?, to?, first.max(second) * stature).ok()
        })
        .collect();
    let robot = capsules.iter().filter_map(|(frame, capsule)| Some(capsule.placed(&pose(*frame)?)));
    let pairs = robot.flat_map(|robot| person.iter().map(move |person| (robot, person)));
    let near = pairs.map(|(robot, person)| {
        let found = proximity(&robot, person);
        Near {
            distance: found.distance,
            on_robot: found.on_first - found.normal * robot.radius(),
            on_person: found.on_second + found.normal * person.radius(),
        }
    });
    near.min_by(|a, b| a.distance.total_cmp(&b.distance))
}
