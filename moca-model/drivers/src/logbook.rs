//! Phases and safety states of a loop, with their causes and times.

use hrsw_safety::{Cause, Fault, SafetyState};
use moca_replay::recorded::{Lane, Tone, phase_label, safety_label};
use serde::Serialize;

use super::loop_tick::LoopTick;

/// Phases and safety states in the order of time \[s since the first tick\], and what they count.
///
/// ```
/// use moca_drivers::Logbook;
///
/// let book = Logbook::default();
/// assert_eq!((book.protective_stops, book.retreats, book.phase.spans.len()), (0, 0, 0));
/// ```
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Logbook {
    /// Phases of the interaction, with the reason of each.
    pub phase: Lane,
    /// Safety states, with the cause of each.
    pub safety: Lane,
    /// Number of protective stops, without the one that ends the loop.
    pub protective_stops: u64,
    /// Number of retreats from a person who was too close.
    pub retreats: u64,
    /// Number of ticks with a person and robot that worked together.
    pub ticks_together: u64,
    #[serde(skip)]
    first: Option<f64>,
    #[serde(skip)]
    state: SafetyState,
}

impl Default for Logbook {
    fn default() -> Self {
        Self {
            phase: Lane::new("phase"),
            safety: Lane::new("safety"),
            protective_stops: 0,
            retreats: 0,
            ticks_together: 0,
            first: None,
            state: SafetyState::Normal,
        }
    }
}

impl Logbook {
    /// The phase and the safety state, each with its cause.
    pub fn state(&self) -> String {
        let last = |lane: &Lane| lane.spans.last().map_or("".into(), |span| span.label.clone());
        format!("{}; {}", last(&self.phase), last(&self.safety))
    }

    /// The time of the first tick \[s\]; `None` before it.
    pub fn first(&self) -> Option<f64> {
        self.first
    }

    /// Takes a tick. Returns what changed in it, as text for people.
    pub fn push(&mut self, tick: &LoopTick) -> Option<String> {
        let time = tick.row.time - *self.first.get_or_insert(tick.row.time);
        if self.phase.spans.is_empty() || tick.transition.is_some() {
            let (label, tone) =
                phase_label(tick.phase, tick.transition.map(|change| change.reason));
            self.phase.set(time, label, tone);
        }
        self.phase.lasts(time);
        let (label, tone) = safety_label(tick.safety, tick.cause.as_ref());
        let is_new = self.safety.spans.last().is_none_or(|last| last.label != label);
        self.safety.set(time, label, tone);
        let begins = |state| tick.safety == state && self.state != state;
        let is_asked = tick.cause == Some(Cause::Fault(Fault::StopRequested));
        self.protective_stops += u64::from(begins(SafetyState::ProtectiveStop) && !is_asked);
        // Recovery from a stop goes through the same state.
        let is_near = matches!(tick.cause, Some(Cause::TooClose(_)));
        self.retreats += u64::from(begins(SafetyState::Retreat) && is_near);
        self.ticks_together += u64::from(tick.row.collaborating);
        self.state = tick.safety;
        let changed = match (tick.transition, is_new) {
            (Some(_), _) => &self.phase,
            (None, true) => &self.safety,
            (None, false) => return None,
        };
        let label = &changed.spans.last()?.label;
        let waits = if tick.waits && tone == Tone::Stop && changed.name == self.safety.name {
            "; it waits for an acknowledgement"
        } else {
            ""
        };
        Some(format!("{time:>8.3} s  {label}{waits}"))
    }
}

#[cfg(test)]
mod tests {
    use hrsw_safety::Nearest;
    use moca_model::Phase;
    use moca_replay::report::TickRow;
    use nalgebra::{Isometry3, Vector6};

    use super::*;

    /// Returns what the book counts of these states: protective stops, and retreats.
    fn counted(states: &[(SafetyState, Option<Cause>)]) -> (u64, u64) {
        let mut book = Logbook::default();
        for (index, &(safety, cause)) in states.iter().enumerate() {
            book.push(&LoopTick {
                row: TickRow { time: index as f64, ..TickRow::default() },
                tool: Isometry3::identity(),
                desired_twist: Vector6::zeros(),
                phase: Phase::Apart,
                transition: None,
                safety,
                cause,
                waits: false,
                person: None,
                holds: false,
            });
        }
        (book.protective_stops, book.retreats)
    }

    #[test]
    fn recovery_from_a_fault_is_no_retreat() {
        use SafetyState::{Normal, ProtectiveStop, Reduced, Retreat};
        let fault = Some(Cause::Fault(Fault::MissingMeasurement));
        let near = Nearest { robot: 0, other: 0, distance: 0.1, required: 0.4, approach: 0.0 };
        let near = Some(Cause::TooClose(near));
        let recovery =
            [(Normal, None), (ProtectiveStop, fault), (Retreat, fault), (Reduced, fault)];
        assert_eq!(counted(&recovery), (1, 0));
        assert_eq!(
            counted(&[(Normal, None), (Retreat, near), (Retreat, near), (Normal, None)]),
            (0, 1)
        );
        let asked = Some(Cause::Fault(Fault::StopRequested));
        assert_eq!(counted(&[(Normal, None), (ProtectiveStop, asked)]), (0, 0));
    }
}
