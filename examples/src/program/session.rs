//! The interface of a running program.

use std::{fmt::Display, io::Write};

use serde::Serialize;

use super::{
    Ending, Interrupt, Printing, ProgramError, Progress, StandardInput, StandardOutput, message,
    shown::json as json_text,
};

/// The interface of a running program: standard output, notes on standard error, progress, and the request to stop.
#[derive(Debug)]
pub struct Session {
    output: StandardOutput,
    interrupt: Interrupt,
    is_quiet: bool,
}

/// The JSON object of `--json`.
#[derive(Serialize)]
struct Line<'a, T> {
    #[serde(flatten)]
    result: &'a T,
    partial: bool,
}

impl Session {
    pub(super) fn new(output: StandardOutput, interrupt: Interrupt, is_quiet: bool) -> Self {
        Self { output, interrupt, is_quiet }
    }

    pub(super) fn is_quiet(&self) -> bool {
        self.is_quiet
    }

    pub(super) fn into_output(self) -> StandardOutput {
        self.output
    }

    /// Standard output, for results.
    pub fn output(&mut self) -> &mut StandardOutput {
        &mut self.output
    }

    /// Standard input, which fails once an interrupt has come.
    ///
    /// # Errors
    /// [`ProgramError::Refused`] if no thread can be created.
    pub fn standard_input(&self) -> Result<StandardInput, ProgramError> {
        StandardInput::new(self.interrupt.clone())
    }

    /// Flag that says whether the program should stop.
    pub fn interrupt(&self) -> &Interrupt {
        &self.interrupt
    }

    /// Prints a note on standard error, unless the program is quiet.
    pub fn note(&self, text: impl Display) {
        if !self.is_quiet {
            message::line(text);
        }
    }

    /// Prints a warning on standard error, even if the program is quiet.
    pub fn warn(&self, text: impl Display) {
        message::line(text);
    }

    /// Starts the progress of `what` over this number of steps, on standard error.
    pub fn progress(&self, what: &str, steps: u64) -> Progress {
        Progress::new(what, Some(steps), self.is_quiet)
    }

    /// Starts the progress of `what` for an unknown number of steps.
    pub fn open_progress(&self, what: &str) -> Progress {
        Progress::new(what, None, self.is_quiet)
    }

    /// Prints a result as one JSON object in a line with the key `"partial"`, if `--json` is given. It must be the last
    /// output of a program.
    ///
    /// # Errors
    /// Standard output that cannot be written.
    pub fn print_json(
        &mut self,
        printing: Printing,
        result: &impl Serialize,
        ending: Ending,
    ) -> anyhow::Result<()> {
        if printing.wants_json() {
            let partial = ending == Ending::Partial;
            let line = json_text(&serde_json::to_string(&Line { result, partial })?);
            writeln!(self.output, "{line}")?;
        }
        Ok(())
    }

    /// Prints the result as the last line, and returns the ending.
    ///
    /// # Errors
    /// Standard output that cannot be written.
    pub fn conclude(
        &mut self,
        printing: Printing,
        result: &impl Serialize,
        ending: Ending,
    ) -> anyhow::Result<Ending> {
        self.print_json(printing, result, ending)?;
        Ok(ending)
    }
}
