//! Options of cutting data sets out of films.

use std::{io::Write, path::PathBuf};

use anyhow::Result;
use clap::Args;
use human_perception::{
    frames::truth::TrueFilm,
    learning::cutting::{Sample, cut},
};

use crate::program::{Ending, Printing, Session, check_folder};

/// Source and destination of a data set.
#[derive(Args, Clone, Debug)]
pub struct CutOptions {
    /// Folders of frames with their truth, as `record --frames` writes them.
    #[arg(required = true)]
    frames: Vec<PathBuf>,
    /// The folder for the data set, which gets a folder for each class. Its files are links to those of the frames, or
    /// copies on systems without links.
    #[arg(long, short, value_name = "FOLDER")]
    output: PathBuf,
    #[command(flatten)]
    printing: Printing,
}

impl CutOptions {
    /// Makes the data set from the samples of each film, named `what`.
    ///
    /// # Errors
    /// The folder that is not empty, the frame or the truth that is wrong; no samples.
    pub fn run(
        self,
        session: &mut Session,
        what: &str,
        samples_of: impl Fn(&TrueFilm) -> Vec<Sample>,
    ) -> Result<Ending> {
        check_folder(&self.output)?;
        let (made, all) = cut(&self.frames, &self.output, what, samples_of, &mut session.watch())?;
        let (samples, classes) = (made.samples, made.classes.len());
        let ending = if samples < all { Ending::Partial } else { Ending::Complete };
        if ending == Ending::Partial {
            session.warn(format_args!("interrupted after {samples} of {all} {what}"));
        }
        for (class, count) in &made.classes {
            writeln!(session.output(), "{count:7}  {class}")?;
        }
        let shown = made.output.display();
        writeln!(session.output(), "{samples} {what} of {classes} classes in {shown}")?;
        session.conclude(self.printing, &made, ending)
    }
}
