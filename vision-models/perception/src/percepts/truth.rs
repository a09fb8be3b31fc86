//! Comparison of percepts with the truth.

use serde::Serialize;
use vision_models::{Action, Intention, Percept};

use percept_recording::Timing;

/// Largest delay of a correct recognition (s).
const DELAY: f64 = 0.5;

/// Largest time difference of a frame and its truth (s).
const SAME_TIME: f64 = 2e-6;

/// Shares of correct camera frames.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct AgainstTruth {
    /// Share of frames with the right surface, among those in which the robot holds the object.
    pub surface_right: Option<f64>,
    /// Share of frames whose action is true at that time, or was true within the delay before it.
    pub action_right: Option<f64>,
    /// Share of frames whose filtered intention is true at that time, or was true within the delay
    /// before it. The filter is the controller's and gets the actions as they arrive.
    pub intention_right: Option<f64>,
    /// The delay (s).
    pub delay: f64,
}

impl AgainstTruth {
    /// Compares percepts, in the order of their times, with the true ones of the same times. The
    /// filter gets each percept as it arrives and returns the intention.
    pub fn of(
        percepts: &[(Percept, Timing)],
        truth: &[Percept],
        filter: impl FnMut(&Percept) -> Intention,
    ) -> Self {
        let intentions = intentions(percepts, filter);
        let [mut surface, mut action, mut intention] = [Share::default(); 3];
        for ((percept, _), filtered) in percepts.iter().zip(intentions) {
            let from = truth.partition_point(|of| of.time < percept.time - DELAY - SAME_TIME);
            let to = truth.partition_point(|of| of.time <= percept.time + SAME_TIME);
            let recent = truth.get(from..to).unwrap_or_default();
            if let Some(held) = recent.last().and_then(|now| now.surface) {
                surface.count(percept.surface.is_some_and(|seen| seen.surface == held.surface));
            }
            let actions: Vec<Action> =
                recent.iter().filter_map(|of| Some(of.action?.action)).collect();
            if !actions.is_empty() {
                action.count(percept.action.is_some_and(|seen| actions.contains(&seen.action)));
                let wanted = filtered.regardless_of_tool();
                let is_wanted = |own: &Action| Intention::from(*own).regardless_of_tool() == wanted;
                intention.count(actions.iter().any(is_wanted));
            }
        }
        Self {
            surface_right: surface.value(),
            action_right: action.value(),
            intention_right: intention.value(),
            delay: DELAY,
        }
    }
}

/// Returns the filtered intention at the time of each percept, from the percepts that have arrived
/// by then.
fn intentions(
    percepts: &[(Percept, Timing)],
    mut filter: impl FnMut(&Percept) -> Intention,
) -> Vec<Intention> {
    let mut arriving = percepts.iter().peekable();
    let mut intention = Intention::default();
    let at = |now: &(Percept, Timing)| {
        while let Some((percept, _)) =
            arriving.next_if(|(percept, timing)| timing.available(percept.time) <= now.0.time)
        {
            intention = filter(percept);
        }
        intention
    };
    percepts.iter().map(at).collect()
}

#[derive(Clone, Copy, Default)]
struct Share {
    right: f64,
    all: f64,
}

impl Share {
    fn count(&mut self, right: bool) {
        self.right += f64::from(u8::from(right));
        self.all += 1.0;
    }

    fn value(self) -> Option<f64> {
        (self.all > 0.0).then(|| self.right / self.all)
    }
}
