//! A robot without a person.

use moca_simulation::run::Scenario;
use nalgebra::Vector3;
use vision_models::Percept;

/// Half the edge of a workspace that keeps the tool to its middle, as its margin leaves no more \[m, rad\].
const NARROW: f64 = 0.005;
/// Frames of the recording that goes on without end, and the time between two \[s\].
const FRAMES: u32 = 20;
const INTERVAL: f64 = 0.05;

/// The scenario with a camera that sees nobody, and a workspace that is one pose.
pub fn alone(mut scenario: Scenario) -> Scenario {
    let empty = |frame: u32| {
        let time = INTERVAL * f64::from(frame);
        Percept { time, body: None, action: None, surface: None }
    };
    scenario.percepts = (0..FRAMES).map(empty).collect();
    scenario.others.clear();
    let space = &mut scenario.settings.space;
    (space.min, space.max) = (Vector3::repeat(-NARROW), Vector3::repeat(NARROW));
    space.turn = Vector3::repeat(NARROW);
    space.margin = NARROW;
    scenario
}
