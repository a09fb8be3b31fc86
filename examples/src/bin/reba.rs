//! Scores filled-in REBA or RULA sheets, one a row of a table, or the postures of a person on film.

use std::{io::Write, ops::ControlFlow, process::ExitCode};

use anyhow::{Context, Result};
use clap::{ArgGroup, Parser};
use ergo_map::{RulaWorksheet, Worksheet};
use ergo_report::sheets::{Sheet, SheetTable, Unknown};
use examples::film::{self, FilmOptions, Outputs};
use examples::program::{self, Ending, InputFile, Printing, Program, ResultFile, Session};
use serde::Serialize;

/// Scores filled-in REBA sheets, one a row of a table (CSV, also with semicolons and decimal commas), or a person on film.
///
/// A film gives the scores along time; --output is then a table of all images, with the sheet of each. A table's
/// first line names the columns. Needed are the angles in degrees: trunk_flex_deg,
/// neck_flex_deg, knee_flex_deg, upper_arm_flex_deg, lower_arm_flex_deg and wrist_flex_deg. The
/// book's page "Scores, maps and pictures" names the others, such as load_kg and coupling.
///
/// Writes the same rows followed by the sub-scores, the tables' values, the score and its action level. REBA also gets
/// the continuous score (faithful) and e_s (graded). Unknown columns are passed through and named on standard error.
#[derive(Debug, Parser)]
#[command(version, group(ArgGroup::new("source").required(true).args(["input"])))]
struct Options {
    #[command(flatten)]
    input: Option<InputFile>,
    /// Score RULA instead of REBA.
    #[arg(long, requires = "input")]
    rula: bool,
    /// Refuse columns that are not known instead of passing them through.
    #[arg(long, requires = "input")]
    strict: bool,
    #[command(flatten)]
    film: FilmOptions,
    #[command(flatten)]
    outputs: Outputs,
    #[command(flatten)]
    result: ResultFile,
    #[command(flatten)]
    printing: Printing,
}

/// The JSON object of `--json`.
#[derive(Serialize)]
struct Scored {
    rows: u64,
    passed_through: Vec<String>,
}

impl Program for Options {
    fn run(self, session: &mut Session) -> Result<Ending> {
        let Some(input) = &self.input else {
            let (report, ending) =
                film::score(&self.film, &self.outputs, self.result.create()?, session)?;
            return session.conclude(self.printing, &report, ending);
        };
        if self.rula {
            self.score::<RulaWorksheet>(input, session)
        } else {
            self.score::<Worksheet>(input, session)
        }
    }
}

impl Options {
    fn score<S: Sheet>(&self, input: &InputFile, session: &mut Session) -> Result<Ending> {
        let mut file = self.result.create()?;
        let shown = || input.to_string();
        let unknown = if self.strict { Unknown::Refuse } else { Unknown::PassThrough };
        let table = SheetTable::<S, _>::new(input.open(session)?, unknown);
        session.interrupt().check()?;
        let mut table = table.with_context(shown)?;
        let passed_through: Vec<String> = table.unknown().map(str::to_owned).collect();
        if !passed_through.is_empty() {
            let names = passed_through.join(", ");
            session.note(format_args!("{}: passed through unchanged: {names}", shown()));
        }
        let interrupt = session.interrupt().clone();
        let progress = session.open_progress("scored rows");
        let output: &mut dyn Write = match &mut file {
            Some(file) => file,
            None => session.output(),
        };
        let mut rows = 0;
        let scored = table.score(output, |_| {
            rows += 1;
            progress.set(rows);
            interrupt.flow()
        });
        progress.finish();
        let ending = match scored {
            Ok(ControlFlow::Continue(())) => Ending::Complete,
            Ok(ControlFlow::Break(())) => Ending::Partial,
            // An interrupt ends standard input with an error.
            Err(ergo_report::Error::Read { .. }) if interrupt.requested() => Ending::Partial,
            Err(error) => return Err(anyhow::Error::from(error).context(shown())),
        };
        match (file, ending) {
            (Some(file), Ending::Partial) => file.keep_partial().map(drop)?,
            (Some(file), _) => file.keep()?,
            (None, _) => {}
        }
        if ending == Ending::Partial {
            session.warn(format_args!("interrupted after {rows} rows"));
        }
        session.conclude(self.printing, &Scored { rows, passed_through }, ending)
    }
}

fn main() -> ExitCode {
    program::main::<Options>()
}
