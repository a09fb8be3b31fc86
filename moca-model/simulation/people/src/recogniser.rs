//! A simulated action recogniser: late, unsure at changes, sometimes wrong.

use std::collections::VecDeque;

use rand::{Rng, seq::IndexedRandom};
use rand_chacha::ChaCha8Rng;
use vision_models::{
    Action, Confidence, RecognisedAction, RecognisedSurface, Tool, WalkingDirection,
};

/// Number of frames that it takes to recognise an action: 0.2 s.
const LATENCY: usize = 4;

/// Number of frames after a change in which the recogniser is unsure.
const UNSURE: u32 = 3;

/// Probability that a frame begins a mistake, and that the surface is not seen.
const MISTAKE: f64 = 0.01;

#[derive(Clone, Debug)]
pub(super) struct Recogniser {
    draw: ChaCha8Rng,
    tool: Tool,
    /// Actions of the person in the last frames, the oldest first.
    pipeline: VecDeque<Action>,
    current: Option<Action>,
    frames_since_change: u32,
    mistake: Option<(Action, u32)>,
    delivered: bool,
}

impl Recogniser {
    /// Creates a recogniser. `tool` is the one for the surface that faces the on-board camera.
    pub(super) fn new(tool: Tool, draw: ChaCha8Rng) -> Self {
        Self {
            draw,
            tool,
            pipeline: VecDeque::new(),
            current: None,
            frames_since_change: 0,
            mistake: None,
            delivered: false,
        }
    }

    /// The report in a frame in which the person does `action`.
    pub(super) fn recognise(
        &mut self,
        action: Action,
        person_seen: bool,
    ) -> (Option<RecognisedAction>, Option<RecognisedSurface>) {
        self.pipeline.push_back(action);
        let seen = if self.pipeline.len() > LATENCY { self.pipeline.pop_front() } else { None };
        let action = seen.map(|action| self.classify(action));
        (action.flatten().filter(|_| person_seen), self.surface())
    }

    fn classify(&mut self, action: Action) -> Option<RecognisedAction> {
        // The robot has the object from the time when the person turns away from the delivery.
        self.delivered |=
            self.current == Some(Action::DeliverObject) && action != Action::DeliverObject;
        if self.current.replace(action) == Some(action) {
            self.frames_since_change = self.frames_since_change.saturating_add(1);
        } else {
            self.frames_since_change = 0;
        }
        let sure = self.draw.random_range(0.82..0.99);
        let doubtful = self.draw.random_range(0.35..0.65);
        let begins = self.draw.random_bool(MISTAKE);
        let mistaken = (self.confused(action), self.draw.random_range(1..=3));
        if begins {
            self.mistake = Some(mistaken);
        }
        if let Some((wrong, frames)) = self.mistake {
            self.mistake = (frames > 1).then_some((wrong, frames - 1));
            return recognised(wrong, doubtful);
        }
        let unsure = self.frames_since_change < UNSURE;
        recognised(action, if unsure { doubtful } else { sure })
    }

    /// A class with which this one is confused. As in the paper, these are picking up and putting down; here also the
    /// two tools, and neighbouring directions.
    fn confused(&mut self, action: Action) -> Action {
        let other = |tool| match tool {
            Tool::Drill => Tool::Polisher,
            Tool::Polisher => Tool::Drill,
        };
        match action {
            Action::PickUp(tool) => Action::PutDown(tool),
            Action::PutDown(tool) => Action::PickUp(tool),
            Action::PickUpObject => Action::DeliverObject,
            Action::DeliverObject => Action::PickUpObject,
            Action::NoCollaborative(tool) => Action::WalkingWith(tool),
            Action::WalkingWith(tool) => Action::NoCollaborative(tool),
            Action::Using(tool) => Action::Using(other(tool)),
            Action::Walking => Action::WalkingWithObject,
            Action::WalkingWithObject => Action::Walking,
            Action::MoveWhileUsing(direction, tool) => {
                let neighbours = WalkingDirection::ALL.map(|near| {
                    (near != direction && near.unit().dot(&direction.unit()) > 0.5).then_some(near)
                });
                let neighbours: Vec<_> = neighbours.into_iter().flatten().collect();
                let near = neighbours.choose(&mut self.draw).copied().unwrap_or(direction);
                Action::MoveWhileUsing(near, tool)
            }
        }
    }

    fn surface(&mut self) -> Option<RecognisedSurface> {
        let confidence = Confidence::new(self.draw.random_range(0.85..0.99)).ok()?;
        let seen = !self.draw.random_bool(MISTAKE) && self.delivered;
        seen.then(|| RecognisedSurface { surface: self.tool.surface(), confidence })
    }
}

fn recognised(action: Action, confidence: f64) -> Option<RecognisedAction> {
    Some(RecognisedAction { action, confidence: Confidence::new(confidence).ok()? })
}
