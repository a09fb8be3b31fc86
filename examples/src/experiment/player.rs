//! Plays the runs of a case, and keeps what a page shows of them.

use anyhow::Result;
use moca_model::{Goal, MOCA_URDF};

use crate::follow::{Run, Scenario, Summary};
use crate::program::Interrupt;
use moca_replay::recorded::{Recorder, Replay};
use moca_replay::report::TickRow;
use moca_simulation::plant::Plant;

/// A run that a page shows.
#[derive(Clone, Debug)]
pub struct ShownRun {
    /// What it looked like.
    pub replay: Replay,
    /// What it came to.
    pub summary: Summary,
    /// Whether people were kept at a distance.
    pub separation: bool,
}

/// Plays runs to their end, or to an interrupt.
#[derive(Debug)]
pub struct Player {
    interrupt: Interrupt,
    shown: Option<Vec<ShownRun>>,
}

impl Player {
    /// One that keeps nothing.
    pub fn new(interrupt: Interrupt) -> Self {
        Self { interrupt, shown: None }
    }

    /// One that keeps what a page shows.
    pub fn recording(interrupt: Interrupt) -> Self {
        Self { interrupt, shown: Some(Vec::new()) }
    }

    /// Plays a run that belongs on the page of its case, under this title; `each` sees every tick.
    ///
    /// # Errors
    /// Settings that the controller refuses, and whatever `each` fails with.
    pub fn play(
        &mut self,
        title: &str,
        scenario: &Scenario,
        goal: Goal,
        each: impl FnMut(&TickRow, &mut Plant) -> Result<()>,
    ) -> Result<Summary> {
        let Some(shown) = &mut self.shown else { return self.play_unseen(scenario, goal, each) };
        let Scenario { model, settings, map, .. } = scenario;
        let mut recorder = Recorder::new(title, model, MOCA_URDF, settings, map)?;
        recorder.holding(&scenario.object)?;
        let run = Run::new(scenario, goal)?.until(self.interrupt.clone());
        let summary = run.recorded_by(&mut recorder).play_watched(each)?;
        shown.push(ShownRun {
            replay: recorder.finish(),
            summary: summary.clone(),
            separation: scenario.has_separation(),
        });
        Ok(summary)
    }

    /// Plays a run that is only counted.
    ///
    /// # Errors
    /// As [`play`](Self::play).
    pub fn play_unseen(
        &self,
        scenario: &Scenario,
        goal: Goal,
        each: impl FnMut(&TickRow, &mut Plant) -> Result<()>,
    ) -> Result<Summary> {
        Run::new(scenario, goal)?.until(self.interrupt.clone()).play_watched(each)
    }

    /// The runs that were kept.
    pub fn into_shown(self) -> Vec<ShownRun> {
        self.shown.unwrap_or_default()
    }
}
