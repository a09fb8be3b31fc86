//! Safety settings of MOCA.

use hrsw_safety::{BaseBraking, Capsule, LinkCapsule, SafetySettings, SeparationSettings};
use nalgebra::Vector3;

use super::moca::MOCA_BASE_JOINTS;

/// Returns the safety settings of MOCA. Its bodies are the Panda's self-collision capsules of the manufacturer's
/// description and eight around the chassis of the base. The base brakes with 0.5 m/s².
///
/// The chassis is kept apart from the links from the elbow on, and the shoulder from those from the forearm on.
///
/// ```
/// use moca_model::moca_safety;
///
/// let settings = moca_safety();
/// assert_eq!(settings.bodies.len(), 20);
/// assert!(settings.validate().is_ok());
/// ```
pub fn moca_safety() -> SafetySettings {
    let settings = SafetySettings::default();
    let base = Some(BaseBraking { joints: MOCA_BASE_JOINTS, deceleration: 0.5 });
    let separation = SeparationSettings { base, ..settings.separation };
    let bodies = bodies();
    SafetySettings { separation, own_pairs: own_pairs(&bodies), bodies, ..settings }
}

/// Link, centre, direction of the axis, radius, distance between the centres of the ends \[m\].
type Row = (&'static str, [f64; 3], [f64; 3], f64, f64);

/// The Panda's self-collision capsules, from the manufacturer's description.
const PANDA: [Row; 12] = {
    /// The frame of link 7's capsules is rotated by an eighth of a turn about z.
    const D: f64 = std::f64::consts::FRAC_1_SQRT_2;
    const X: [f64; 3] = [1.0, 0.0, 0.0];
    const Y: [f64; 3] = [0.0, 1.0, 0.0];
    const Z: [f64; 3] = [0.0, 0.0, 1.0];
    [
        ("panda_link0", [-0.075, 0.0, 0.06], X, 0.06, 0.03),
        ("panda_link1", [0.0, 0.0, -0.1915], Z, 0.06, 0.283),
        ("panda_link2", [0.0, 0.0, 0.0], Z, 0.06, 0.12),
        ("panda_link3", [0.0, 0.0, -0.145], Z, 0.06, 0.15),
        ("panda_link4", [0.0, 0.0, 0.0], Z, 0.06, 0.12),
        ("panda_link5", [0.0, 0.0, -0.26], Z, 0.06, 0.10),
        ("panda_link5", [0.0, 0.08, -0.13], Z, 0.025, 0.14),
        ("panda_link6", [0.0, 0.0, -0.03], Z, 0.05, 0.08),
        ("panda_link7", [0.0, 0.0, 0.01], Z, 0.04, 0.14),
        ("panda_link7", [0.06 * D, 0.06 * D, 0.082], [D, D, 0.0], 0.03, 0.01),
        ("panda_hand", [0.0, 0.0, 0.04], Y, 0.04, 0.10),
        ("panda_hand", [0.0, 0.0, 0.10], Y, 0.02, 0.10),
    ]
};

/// Capsules around the chassis' box of 0.719 × 0.579 × 0.443 m: across at front and back, along at both sides, each low
/// and high. They are just large enough to contain its surface except the inside of the deck.
const CHASSIS: [Row; 8] = {
    const X: [f64; 3] = [1.0, 0.0, 0.0];
    const Y: [f64; 3] = [0.0, 1.0, 0.0];
    [
        ("base_link", [0.28, 0.0, 0.05], Y, 0.155, 0.44),
        ("base_link", [0.28, 0.0, 0.271], Y, 0.155, 0.44),
        ("base_link", [-0.28, 0.0, 0.05], Y, 0.155, 0.44),
        ("base_link", [-0.28, 0.0, 0.271], Y, 0.155, 0.44),
        ("base_link", [0.0, 0.21, 0.05], X, 0.155, 0.56),
        ("base_link", [0.0, 0.21, 0.271], X, 0.155, 0.56),
        ("base_link", [0.0, -0.21, 0.05], X, 0.155, 0.56),
        ("base_link", [0.0, -0.21, 0.271], X, 0.155, 0.56),
    ]
};

fn bodies() -> Vec<LinkCapsule> {
    // The order is from the hand down. The nearest are found first, and many others need no search.
    PANDA
        .iter()
        .rev()
        .chain(&CHASSIS)
        .filter_map(|&(link, centre, axis, radius, length)| {
            let (centre, half) = (Vector3::from(centre), Vector3::from(axis) * (0.5 * length));
            let capsule = Capsule::new(centre - half, centre + half, radius).ok()?;
            Some(LinkCapsule { link: link.to_owned(), capsule })
        })
        .collect()
}

fn own_pairs(bodies: &[LinkCapsule]) -> Vec<(usize, usize)> {
    let of = |links: &[&str]| -> Vec<usize> {
        let named = |(_, body): &(usize, &LinkCapsule)| links.contains(&body.link.as_str());
        bodies.iter().enumerate().filter(named).map(|(index, _)| index).collect()
    };
    let across = |first: &[&str], second: &[&str]| -> Vec<(usize, usize)> {
        let second = of(second);
        of(first)
            .into_iter()
            .flat_map(|i| second.iter().map(move |&j| (i, j)).collect::<Vec<_>>())
            .collect()
    };
    let wrist = ["panda_link5", "panda_link6", "panda_link7", "panda_hand"];
    let mut pairs = across(&wrist, &["base_link", "panda_link0", "panda_link1"]);
    pairs.extend(across(&["panda_link4"], &["base_link"]));
    pairs
}
