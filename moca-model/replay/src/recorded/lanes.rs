//! States over time.

use std::borrow::Cow;

use hrsw_safety::{Cause, SafetyState};
use moca_model::{BaseMotion, BoxSide, DriveReason, Intention, Outcome, Phase, Reason};
use serde::Serialize;
use vision_models::{Surface, WalkingDirection};

/// Largest number of spans of a lane. Later states have no label of their own.
const MOST: usize = 2000;
/// Label of later states.
const FULL: &str = "(more changes than are kept)";

/// Appearance of a state.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Tone {
    /// Nothing is going on.
    Quiet,
    /// Person and robot work together.
    Work,
    /// Person and robot walk together.
    Walk,
    /// Something is limited.
    Caution,
    /// The robot stops.
    Stop,
}

/// State from its begin to its end \[s\].
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Span {
    /// First time.
    pub begin: f64,
    /// Time at which the next state began, or the last time.
    pub end: f64,
    /// Name of the state, with the cause where there is one.
    pub label: Cow<'static, str>,
    /// Appearance.
    pub tone: Tone,
}

/// States of one thing.
///
/// ```
/// use moca_replay::recorded::{Lane, Tone};
///
/// let mut lane = Lane::new("door");
/// lane.set(0.0, "shut", Tone::Quiet);
/// lane.set(1.0, "shut", Tone::Quiet);
/// lane.set(2.0, "open", Tone::Work);
/// let labels: Vec<_> = lane.spans.iter().map(|span| (&*span.label, span.begin, span.end)).collect();
/// assert_eq!(labels, [("shut", 0.0, 2.0), ("open", 2.0, 2.0)]);
/// ```
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Lane {
    /// Name of the thing.
    pub name: &'static str,
    /// Spans in the order of time, without gaps.
    pub spans: Vec<Span>,
}

impl Lane {
    /// Creates a lane without states.
    pub fn new(name: &'static str) -> Self {
        Self { name, spans: Vec::new() }
    }

    /// Sets the state at a time \[s\], which must not be earlier than the time before.
    pub fn set(&mut self, time: f64, label: impl Into<Cow<'static, str>>, tone: Tone) {
        let label = label.into();
        let full = self.spans.len() >= MOST;
        if let Some(last) = self.spans.last_mut() {
            last.end = time;
            if last.label == label {
                return;
            }
            if full {
                (last.label, last.tone) = (FULL.into(), Tone::Quiet);
                return;
            }
        }
        self.spans.push(Span { begin: time, end: time, label, tone });
    }

    /// Extends the current state to a time \[s\].
    pub fn lasts(&mut self, time: f64) {
        if let Some(last) = self.spans.last_mut() {
            last.end = time;
        }
    }
}

/// The label of an intention.
pub fn intention(intention: Intention) -> (&'static str, Tone) {
    let Intention::Together { walking, .. } = intention else { return ("apart", Tone::Quiet) };
    let Some(direction) = walking else { return ("together", Tone::Work) };
    (walks(direction), Tone::Walk)
}

fn walks(direction: WalkingDirection) -> &'static str {
    use WalkingDirection::{
        Backwards, BackwardsLeft, BackwardsRight, Forwards, ForwardsLeft, ForwardsRight, Left,
        Right,
    };
    match direction {
        Forwards => "walking forwards",
        ForwardsLeft => "walking forwards left",
        ForwardsRight => "walking forwards right",
        Left => "walking left",
        Right => "walking right",
        Backwards => "walking backwards",
        BackwardsLeft => "walking backwards left",
        BackwardsRight => "walking backwards right",
    }
}

/// The label of a phase, with why the one before ended.
pub fn phase(phase: Phase, reason: Option<Reason>) -> (Cow<'static, str>, Tone) {
    let (name, tone) = match phase {
        Phase::Apart => ("apart", Tone::Quiet),
        Phase::Looking => ("looking", Tone::Work),
        Phase::Handover => ("handover", Tone::Work),
        Phase::Grasping => ("grasping", Tone::Work),
        Phase::Turning { to: BoxSide::Front } => ("turning to the front", Tone::Walk),
        Phase::Turning { to: BoxSide::Back } => ("turning to the back", Tone::Walk),
        Phase::Turning { to: BoxSide::Left } => ("turning to the left", Tone::Walk),
        Phase::Turning { to: BoxSide::Right } => ("turning to the right", Tone::Walk),
        Phase::Turning { to: BoxSide::Top } => ("turning to the top", Tone::Walk),
        Phase::Turning { to: BoxSide::Bottom } => ("turning to the bottom", Tone::Walk),
        Phase::Working => ("working", Tone::Work),
        Phase::Walking { direction } => (walks(direction), Tone::Walk),
    };
    let why: Cow<'static, str> = match reason {
        None => return (name.into(), tone),
        Some(Reason::Engages) => "the person engages".into(),
        Some(Reason::Hidden) => "the camera has seen no side".into(),
        Some(Reason::Seen) => "the camera has seen one".into(),
        Some(Reason::Leaves) => "the person leaves".into(),
        Some(Reason::Arrived) => "the tool is there".into(),
        Some(Reason::Grasped) => "the gripper has closed".into(),
        Some(Reason::Released) => "the object is gone".into(),
        Some(Reason::WrongSurface { shown, needed }) => {
            format!("{} is shown, {} needed", surface(shown), surface(needed)).into()
        }
        Some(Reason::RightSurface) => "the right surface is shown".into(),
        Some(Reason::Walks) => "the person walks".into(),
        Some(Reason::Stands) => "the person stands".into(),
    };
    (format!("{name}: {why}").into(), tone)
}

/// Returns the name of a surface.
pub(super) fn surface(surface: Surface) -> &'static str {
    match surface {
        Surface::Smooth => "smooth",
        Surface::Drilled => "drilled",
    }
}

/// The label of a safety state.
pub fn safety(state: SafetyState, cause: Option<&Cause>) -> (Cow<'static, str>, Tone) {
    let why: Cow<'static, str> = match cause {
        None => "".into(),
        Some(Cause::TooClose(_)) => ": person too close".into(),
        Some(Cause::Stale { .. }) => ": nobody seen for too long".into(),
        Some(Cause::Fault(fault)) => format!(": {fault}").into(),
        Some(_) => ": another cause".into(),
    };
    match state {
        SafetyState::Normal => ("normal".into(), Tone::Quiet),
        SafetyState::Reduced => (format!("reduced speed{why}").into(), Tone::Caution),
        SafetyState::Retreat => (format!("retreat{why}").into(), Tone::Caution),
        SafetyState::ProtectiveStop => (format!("protective stop{why}").into(), Tone::Stop),
    }
}

/// The label of what the base does, with why it drives.
pub fn base(motion: BaseMotion) -> (&'static str, Tone) {
    match motion {
        BaseMotion::Stands => ("stands", Tone::Quiet),
        BaseMotion::Drives(DriveReason::PersonMoves) => ("drives: the workspace moves", Tone::Walk),
        BaseMotion::Drives(DriveReason::Reach) => ("drives: the arm is stretched", Tone::Work),
        BaseMotion::Drives(DriveReason::Separation) => {
            ("drives: somebody is too near", Tone::Caution)
        }
    }
}

/// The label of how a tick went.
pub fn solver(outcome: Outcome) -> (&'static str, Tone) {
    match outcome {
        outcome if outcome.is_optimal() => ("optimal", Tone::Quiet),
        Outcome::Solved(_) => ("not at the optimum", Tone::Caution),
        _ => ("no solution: braking", Tone::Stop),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spans_have_no_gaps_and_are_bounded() {
        let mut lane = Lane::new("flicker");
        for tick in 0..3 * MOST {
            lane.set(tick as f64, if tick % 2 == 0 { "a" } else { "b" }, Tone::Work);
        }
        assert_eq!(lane.spans.len(), MOST);
        assert!(lane.spans.windows(2).all(|pair| pair[0].end == pair[1].begin));
        let last = lane.spans.last().unwrap();
        assert_eq!((&*last.label, last.end), (FULL, (3 * MOST - 1) as f64));
    }
}
