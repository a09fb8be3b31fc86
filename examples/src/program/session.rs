//! What a running program speaks through.

use std::{fmt::Display, io::Write};

use serde::Serialize;

use super::{
    Ending, Interrupt, Json, ProgramError, Progress, Quiet, StandardInput, StandardOutput, message,
    shown::json as json_text,
};

/// A running program's ways to the outside: standard output, notes on standard error, progress,
/// and the request to stop.
#[derive(Debug)]
pub struct Session {
    output: StandardOutput,
    interrupt: Interrupt,
    quiet: Quiet,
}

/// The line of `--json`.
#[derive(Serialize)]
struct Line<'a, T> {
    #[serde(flatten)]
    result: &'a T,
    partial: bool,
}

impl Session {
    pub(super) fn new(output: StandardOutput, interrupt: Interrupt, quiet: Quiet) -> Self {
        Self { output, interrupt, quiet }
    }

    pub(super) fn quiet(&self) -> Quiet {
        self.quiet
    }

    pub(super) fn into_output(self) -> StandardOutput {
        self.output
    }

    /// Standard output, for results.
    pub fn output(&mut self) -> &mut StandardOutput {
        &mut self.output
    }

    /// Standard input, which fails to be read once an interrupt has come.
    ///
    /// # Errors
    /// [`ProgramError::Refused`] if there is no thread to be had.
    pub fn standard_input(&self) -> Result<StandardInput, ProgramError> {
        StandardInput::new(self.interrupt.clone())
    }

    /// Whether the program should stop.
    pub fn interrupt(&self) -> &Interrupt {
        &self.interrupt
    }

    /// Says on standard error what is good to know, unless the program is to be quiet.
    pub fn note(&self, text: impl Display) {
        if !self.quiet.is_quiet() {
            message::line(text);
        }
    }

    /// Says on standard error what must be known, even of a quiet program.
    pub fn warn(&self, text: impl Display) {
        message::line(text);
    }

    /// Progress of `what` over so many steps, on standard error.
    pub fn progress(&self, what: &str, steps: u64) -> Progress {
        Progress::new(what, Some(steps), self.quiet)
    }

    /// Progress of `what` where it is not known, or not yet, how many steps there are.
    pub fn open_progress(&self, what: &str) -> Progress {
        Progress::new(what, None, self.quiet)
    }

    /// With `--json`, prints a result as one JSON object in a line, with `"partial"` among its
    /// keys. It is the last thing that a program prints.
    ///
    /// # Errors
    /// Standard output that cannot be written.
    pub fn print_json(
        &mut self,
        json: Json,
        result: &impl Serialize,
        ending: Ending,
    ) -> anyhow::Result<()> {
        if json.wanted() {
            let partial = ending == Ending::Partial;
            let line = json_text(&serde_json::to_string(&Line { result, partial })?);
            writeln!(self.output, "{line}")?;
        }
        Ok(())
    }

    /// The same as the last line of a program that ends so.
    ///
    /// # Errors
    /// Standard output that cannot be written.
    pub fn conclude(
        &mut self,
        json: Json,
        result: &impl Serialize,
        ending: Ending,
    ) -> anyhow::Result<Ending> {
        self.print_json(json, result, ending)?;
        Ok(ending)
    }
}
