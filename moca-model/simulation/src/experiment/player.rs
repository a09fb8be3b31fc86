//! A player of the runs of a case, which keeps what a page shows of them.

use std::fmt;
use std::ops::ControlFlow;

use moca_model::{Goal, MOCA_URDF};
use moca_replay::recorded::Replay;
use moca_replay::report::TickRow;

use crate::error::Error;
use crate::plant::Plant;
use crate::run::{Run, Scenario, Summary};

/// A run that a page shows.
#[derive(Clone, Debug)]
pub struct ShownRun {
    /// The recorded motion.
    pub replay: Replay,
    /// The result.
    pub summary: Summary,
    /// True if distances from people were kept.
    pub separation: bool,
}

/// Plays runs to their end, or until it is told to stop.
pub struct Player<'a> {
    go_on: &'a (dyn Fn() -> ControlFlow<()> + Sync),
    shown: Option<Vec<ShownRun>>,
}

impl fmt::Debug for Player<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Player").field("shown", &self.shown).finish_non_exhaustive()
    }
}

impl<'a> Player<'a> {
    /// Creates a player that keeps nothing. It asks in every tick whether to go on.
    pub fn new(go_on: &'a (dyn Fn() -> ControlFlow<()> + Sync)) -> Self {
        Self { go_on, shown: None }
    }

    /// Keeps what a page shows.
    #[must_use]
    pub fn recording(self) -> Self {
        Self { shown: Some(Vec::new()), ..self }
    }

    /// Plays a run for the page of its case, under this title. `each` sees every tick.
    ///
    /// # Errors
    /// Settings that the controller refuses.
    pub fn play(
        &mut self,
        title: &str,
        scenario: &Scenario,
        goal: Goal,
        each: impl FnMut(&TickRow, &Plant),
    ) -> Result<Summary, Error> {
        let Some(shown) = &mut self.shown else { return self.play_unseen(scenario, goal, each) };
        let mut recorder = scenario.recorder(title, MOCA_URDF)?;
        let run = Run::new(scenario, goal)?.recorded_by(&mut recorder);
        let summary = run.play(watched(self.go_on, each))?;
        shown.push(ShownRun {
            replay: recorder.finish(),
            summary: summary.clone(),
            separation: scenario.has_separation(),
        });
        Ok(summary)
    }

    /// Plays a run without showing it.
    ///
    /// # Errors
    /// As [`play`](Self::play).
    pub(crate) fn play_unseen(
        &self,
        scenario: &Scenario,
        goal: Goal,
        each: impl FnMut(&TickRow, &Plant),
    ) -> Result<Summary, Error> {
        Run::new(scenario, goal)?.play(watched(self.go_on, each))
    }

    /// The runs that were kept.
    pub fn into_shown(self) -> Vec<ShownRun> {
        self.shown.unwrap_or_default()
    }
}

/// Shows each tick to `each`, then asks whether to go on.
fn watched(
    go_on: &dyn Fn() -> ControlFlow<()>,
    mut each: impl FnMut(&TickRow, &Plant),
) -> impl FnMut(&TickRow, &Plant) -> ControlFlow<()> {
    move |row, plant| {
        each(row, plant);
        go_on()
    }
}
