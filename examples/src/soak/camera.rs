//! A camera of 20 frames a second: late, noisy, and with gaps.

use std::collections::VecDeque;

use rand::Rng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use vision_models::{
    Action, Body, Body25, Confidence, Keypoint, Percept, RecognisedAction, Tool, WalkingDirection,
};

use super::body;
use super::person::Person;
use nalgebra::Vector3;

/// Ticks of a millisecond between two frames.
const FRAME: u64 = 50;
/// Standard deviation of a joint's place along each axis, and its largest error (m).
const SIGMA: f64 = 0.007;
const LARGEST: f64 = 0.02;
/// How late a frame arrives (s).
const LATENCY: std::ops::Range<f64> = 0.02..0.09;
/// Probabilities that a frame is lost, and that a joint is missing in one.
const LOST: f64 = 0.03;
const MISSING: f64 = 0.03;
/// Slower than this a person stands (m/s).
const STANDING: f64 = 0.1;

/// A frame on its way.
#[derive(Clone, Debug)]
struct Frame {
    arrives: f64,
    tick: u64,
    percept: Percept,
}

#[derive(Clone, Debug)]
pub(super) struct Camera {
    draw: ChaCha8Rng,
    frames: VecDeque<Frame>,
    /// Whether the person has been seen: the first frame shows all joints.
    seen: bool,
}

impl Camera {
    pub(super) fn new(draw: ChaCha8Rng) -> Self {
        Self { draw, frames: VecDeque::new(), seen: false }
    }

    /// Takes a frame if one is due at this tick and time (s).
    pub(super) fn look(&mut self, tick: u64, time: f64, person: &Person) {
        if !tick.is_multiple_of(FRAME) {
            return;
        }
        // Drawn in any case, so that what follows does not depend on what is seen.
        let lost = self.draw.random_bool(LOST);
        let late = self.draw.random_range(LATENCY);
        let body = self.body(person);
        if lost {
            return;
        }
        let action = RecognisedAction { action: action(person), confidence: Confidence::ONE };
        let visible = person.is_visible();
        self.seen |= visible;
        let percept = Percept {
            time,
            body: visible.then_some(body),
            action: visible.then_some(action),
            surface: None,
        };
        // None overtakes another.
        let last = self.frames.back().map_or(time, |frame| frame.arrives);
        self.frames.push_back(Frame { arrives: last.max(time + late), tick, percept });
    }

    /// The next frame that has arrived by `time` (s), with the tick at which it was taken.
    pub(super) fn arrived(&mut self, time: f64) -> Option<(u64, Percept)> {
        if self.frames.front()?.arrives > time {
            return None;
        }
        let frame = self.frames.pop_front()?;
        Some((frame.tick, frame.percept))
    }

    fn body(&mut self, person: &Person) -> Body {
        let places = body::points(&person.joints());
        let keypoints = places.map(|place| {
            let noise = Vector3::from_fn(|_, _| -> f64 { StandardNormal.sample(&mut self.draw) });
            let position = place + (noise * SIGMA).cap_magnitude(LARGEST);
            let missing = self.draw.random_bool(MISSING) && self.seen;
            let confidence = Confidence::new(self.draw.random_range(0.6..1.0)).ok()?;
            (!missing).then_some(Keypoint { position, confidence })
        });
        let mut body = Body::new(keypoints);
        // The face beside the nose adds nothing here.
        for joint in [Body25::LeftEye, Body25::RightEye, Body25::LeftEar, Body25::RightEar] {
            body.set(joint, None);
        }
        body
    }
}

/// What the person does, in the classes of the recogniser.
fn action(person: &Person) -> Action {
    let velocity = person.velocity_in_person();
    let walking = WalkingDirection::nearest(velocity).filter(|_| velocity.norm() > STANDING);
    match (person.is_together(), walking) {
        (true, Some(direction)) => Action::MoveWhileUsing(direction, Tool::Drill),
        (true, None) => Action::Using(Tool::Drill),
        (false, _) => Action::Walking,
    }
}
