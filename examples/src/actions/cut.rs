//! Cutting of clips by class out of frames with a known truth.

use anyhow::Result;
use clap::Args;

use human_perception::actions::cut::ClipCut;

use crate::{
    learning::cut_options::CutOptions,
    program::{Ending, Session},
};

/// Cuts clips out of frames with their truth: a folder for each class, as `train` and `evaluate` take them.
///
/// A clip has the action of its last frame, since a recogniser that looks back from the newest frame should report it.
/// No clip goes over frames that the camera lost.
#[derive(Args, Debug)]
pub struct Cut {
    #[command(flatten)]
    options: CutOptions,
    /// Frames of a clip, 1 to 1,024.
    #[arg(long, default_value_t = 29, value_parser = clap::value_parser!(u16).range(1..=1024))]
    length: u16,
    /// Frames from the beginning of a clip to that of the next.
    #[arg(long, default_value_t = 10, value_parser = clap::value_parser!(u16).range(1..))]
    every: u16,
    /// Frames at the end of a clip in which the person has been doing its action; all of it if this is left out.
    /// Smaller numbers give clips that show how an action begins.
    #[arg(long, value_name = "FRAMES", value_parser = clap::value_parser!(u16).range(1..))]
    settled: Option<u16>,
}

impl Cut {
    /// Cuts the clips.
    ///
    /// # Errors
    /// As of [`CutOptions::run`].
    pub fn run(self, session: &mut Session) -> Result<Ending> {
        let length = usize::from(self.length);
        let settled = self.settled.map_or(length, usize::from).min(length);
        let cut = ClipCut { length, every: self.every.into(), settled };
        self.options.run(session, "clips", |film| cut.clips_of(film))
    }
}
