//! The destination of results: standard output, or the file of `--output`.

use std::io::Write;

use serde::Serialize;

use crate::program::{Ending, OutputFile, Printing, ProgramError, ResultFile, Session};

/// The destination of a program's results.
#[derive(Debug)]
pub struct Results {
    file: Option<OutputFile>,
    printing: Printing,
}

impl Results {
    /// Creates the file, if one is asked for.
    ///
    /// # Errors
    /// As of [`ResultFile::create`].
    pub fn begin(option: &ResultFile, printing: Printing) -> Result<Self, ProgramError> {
        Ok(Self { file: option.create()?, printing })
    }

    /// The file, if one is asked for.
    pub fn file(&mut self) -> Option<&mut OutputFile> {
        self.file.as_mut()
    }

    /// The writer of the next results.
    pub fn writer<'a>(&'a mut self, session: &'a mut Session) -> &'a mut dyn Write {
        match &mut self.file {
            Some(file) => file,
            None => session.output(),
        }
    }

    /// Puts the file in place as complete, whatever comes after.
    ///
    /// # Errors
    /// As of [`OutputFile::keep`].
    pub fn keep_whole(&mut self) -> Result<(), ProgramError> {
        self.file.take().map_or(Ok(()), OutputFile::keep)
    }

    /// Puts the file in place, marked as partial after an interrupt, and prints the JSON object of `--json`.
    ///
    /// # Errors
    /// As of [`OutputFile::keep`] and [`Session::conclude`].
    pub fn conclude(
        mut self,
        session: &mut Session,
        report: &impl Serialize,
        ending: Ending,
    ) -> anyhow::Result<Ending> {
        match (self.file.take(), ending) {
            (Some(file), Ending::Partial) => drop(file.keep_partial()?),
            (Some(file), _) => file.keep()?,
            (None, _) => {}
        }
        session.conclude(self.printing, report, ending)
    }
}
