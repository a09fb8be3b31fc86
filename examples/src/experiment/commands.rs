//! The options of each experiment.

use anyhow::Result;
use clap::Args;
use moca_simulation::experiment::{following, reorientation, subjects};

use super::options::{Common, case_duration};
use super::play::run;
use crate::program::{Ending, Session};

/// Experiment 3: random people hand the object over and take the tool for the surface that they do not see.
///
/// The robot identifies the surfaces by its camera, and turns the object once the person engages. Prints how many turns
/// end with the right surface in front of the person. Also prints their time over the least time, every transition of
/// the first case, and the person's ergonomics with and without.
#[derive(Args, Debug)]
pub struct Reorientation {
    #[command(flatten)]
    common: Common,
}

/// Experiment 4: random people lead the robot along random paths.
///
/// Prints the person's ergonomics with ergonomics on the third level of the stack and with the paper's benchmark there.
/// A second part measures how far the robot falls behind people who walk straight at up to its own speed.
#[derive(Args, Debug)]
pub struct Following {
    #[command(flatten)]
    common: Common,
    /// Length of each case (s).
    #[arg(long, value_name = "SECONDS", default_value_t = 35.0, value_parser = case_duration, conflicts_with = "recording")]
    duration: f64,
}

/// Experiment 5: people of ten statures lead the robot, which has different knowledge of their ergonomics.
///
/// The robot knows their own map, chooses one by the measured stature, only knows the average map, or knows none. Only
/// the map differs: the shared workspace is that of the average person in all runs. The person's own map scores the
/// postures.
#[derive(Args, Debug)]
pub struct Subjects {
    #[command(flatten)]
    common: Common,
    /// Length of each case (s). While the robot approaches, all maps are alike, so that shorter cases show less gain by
    /// one's own map.
    #[arg(long, value_name = "SECONDS", default_value_t = 60.0, value_parser = case_duration, conflicts_with = "recording")]
    duration: f64,
}

impl Reorientation {
    /// Plays the cases, prints the table and draws the figure.
    ///
    /// # Errors
    /// A folder that cannot be written; a case that cannot be played.
    pub fn run(self, session: &mut Session) -> Result<Ending> {
        run::<reorientation::Reorientation>(&self.common, reorientation::DURATION, session)
    }
}

impl Following {
    /// Plays the cases, prints the table and draws the figure.
    ///
    /// # Errors
    /// A folder that cannot be written; a case that cannot be played.
    pub fn run(self, session: &mut Session) -> Result<Ending> {
        run::<following::Following>(&self.common, self.duration, session)
    }
}

impl Subjects {
    /// Plays the cases, prints the table and draws the figure.
    ///
    /// # Errors
    /// A folder that cannot be written; a case that cannot be played.
    pub fn run(self, session: &mut Session) -> Result<Ending> {
        run::<subjects::Subjects>(&self.common, self.duration, session)
    }
}
