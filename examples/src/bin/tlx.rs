//! Scores NASA-TLX questionnaires and compares conditions.

use std::{
    io::{BufRead, Write, sink},
    path::PathBuf,
    process::ExitCode,
};

use anyhow::{Context, Result};
use clap::Parser;
use ergo_report::sheets::{SheetTable, Unknown};
use ergo_report::workload::{Questionnaire, WorkloadStudy, figure};
use examples::program::{
    self, Ending, InputFile, OutputFile, Printing, Program, ResultFile, Session,
};

/// Scores NASA-TLX questionnaires, one a row of a table (CSV), and compares conditions.
///
/// The first line names the columns. Required are subject and the ratings from 0 to 20 temporal_demand, mental_demand,
/// effort, physical_demand and frustration. Also required is either performance (0 is perfect, as on NASA's sheet) or
/// performance_inverted (20 is perfect).
///
/// A column condition names what is compared: each subject answers once under each. The columns weight_temporal_demand
/// and so on give a weighted score too. They say how often each scale was chosen in the fifteen choices between two.
///
/// Prints mean, median and quartiles by condition. Compares every two conditions by the exact Wilcoxon signed-rank test
/// of each scale, corrected by Holm, with its effect size.
#[derive(Debug, Parser)]
#[command(version)]
struct Options {
    #[command(flatten)]
    input: InputFile,
    /// Write the table followed by the raw and the weighted score of each row.
    #[arg(long, value_name = "FILE")]
    scores: Option<PathBuf>,
    /// Draw the box plot, as SVG.
    #[arg(long, value_name = "FILE")]
    figure: Option<PathBuf>,
    /// Ratings run from 0 to 100. They are divided by 5: all results are on NASA's scale from 0 to 20.
    #[arg(long)]
    hundred: bool,
    /// Refuse unknown columns instead of passing them through.
    #[arg(long)]
    strict: bool,
    #[command(flatten)]
    result: ResultFile,
    #[command(flatten)]
    printing: Printing,
}

impl Program for Options {
    fn run(self, session: &mut Session) -> Result<Ending> {
        let mut result = self.result.create()?;
        let mut scores = self.scores.as_ref().map(OutputFile::create).transpose()?;
        let drawing = self.figure.as_ref().map(OutputFile::create).transpose()?;
        let table = self.input.open(session)?;
        let read = match &mut scores {
            Some(file) => self.read(table, session, file),
            None => self.read(table, session, &mut sink()),
        };
        // An interrupt also ends standard input with an error.
        session.interrupt().check()?;
        let shown = || self.input.to_string();
        let questionnaires = read.with_context(shown)?;
        let study = WorkloadStudy::new(&questionnaires).with_context(shown)?;
        match &mut result {
            Some(file) => write!(file, "{study}")?,
            None => write!(session.output(), "{study}")?,
        }
        if let Some(mut file) = drawing {
            file.push(figure(&study)?.as_bytes())?;
            file.keep()?;
        }
        for file in [scores, result].into_iter().flatten() {
            file.keep()?;
        }
        session.conclude(self.printing, &study, Ending::Complete)
    }
}

impl Options {
    /// Reads the questionnaires and writes their scores.
    fn read(
        &self,
        table: impl BufRead,
        session: &Session,
        scores: &mut dyn Write,
    ) -> Result<Vec<Questionnaire>> {
        let unknown = if self.strict { Unknown::Refuse } else { Unknown::PassThrough };
        let mut table = SheetTable::<Questionnaire, _>::new(table, unknown)?;
        if self.hundred {
            table = table.with_ratings_to_hundred();
        }
        let passed_through = table.unknown().collect::<Vec<_>>().join(", ");
        if !passed_through.is_empty() {
            session.note(format_args!("{}: not used: {passed_through}", self.input));
        }
        let mut questionnaires = Vec::new();
        // The caller checks the interrupt.
        let _ = table.score(scores, |questionnaire| {
            questionnaires.push(questionnaire.clone());
            session.interrupt().flow()
        })?;
        Ok(questionnaires)
    }
}

fn main() -> ExitCode {
    program::main::<Options>()
}
