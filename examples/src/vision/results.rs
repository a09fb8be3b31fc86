//! Where results go: to standard output, or to the file of `--output`.

use std::io::Write;

use crate::program::{Ending, OutputFile, ProgramError, ResultFile, Session};

/// The place of a program's results.
#[derive(Debug)]
pub struct Results {
    file: Option<OutputFile>,
}

impl Results {
    /// Begins the file, if one is asked for.
    ///
    /// # Errors
    /// As of [`ResultFile::create`].
    pub fn begin(option: &ResultFile) -> Result<Self, ProgramError> {
        Ok(Self { file: option.create()? })
    }

    /// What the next results are written to.
    pub fn writer<'a>(&'a mut self, session: &'a mut Session) -> &'a mut dyn Write {
        match &mut self.file {
            Some(file) => file,
            None => session.output(),
        }
    }

    /// Puts the file in its place; marked as partial after an interrupt.
    ///
    /// # Errors
    /// As of [`OutputFile::keep`].
    pub fn keep(self, ending: Ending) -> Result<(), ProgramError> {
        match (self.file, ending) {
            (None, _) => Ok(()),
            (Some(file), Ending::Partial) => file.keep_partial().map(drop),
            (Some(file), _) => file.keep(),
        }
    }
}
