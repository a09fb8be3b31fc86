//! Extraction of images of surfaces by class from frames with a known truth.

use anyhow::Result;
use clap::Args;

use human_perception::surface::cut::images_of;

use crate::{
    learning::cut_options::CutOptions,
    program::{Ending, Session},
};

/// Takes the images of the on-board camera out of frames with their truth: a folder for each class, as `train` and
/// `evaluate` take them.
///
/// Images are taken whole, as `perceive` uses them, since that camera faces the object. Images in which the robot does
/// not hold it are left out.
#[derive(Args, Debug)]
pub struct Cut {
    #[command(flatten)]
    options: CutOptions,
    /// Frames from one image to the next.
    #[arg(long, default_value_t = 20, value_parser = clap::value_parser!(u16).range(1..))]
    every: u16,
}

impl Cut {
    /// Extracts the images.
    ///
    /// # Errors
    /// As of [`CutOptions::run`].
    pub fn run(self, session: &mut Session) -> Result<Ending> {
        let every = usize::from(self.every);
        self.options.run(session, "images", |film| images_of(film, every))
    }
}
