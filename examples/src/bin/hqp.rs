//! Solves a set of hierarchical problems and reports the time of each.

use std::{
    fs::File,
    io::{BufReader, BufWriter, Write},
    path::{Path, PathBuf},
    process::ExitCode,
};

use ahqp_core::{Settings, Stacking};
use anyhow::{Context, Result, ensure};
use clap::Parser;
use examples::program::{self, Ending, Printing, Program, ResultFile, Session};
use examples::stacking::StackingOption;
use hqp_problems::comparison::{Compared, Comparison};
use hqp_problems::file::{HqpReader, Problem};
use hqp_problems::solving::{Code, Outcome, Proofs, Runs, Times};
use serde::Serialize;

/// Solves a set of hierarchical quadratic problems.
///
/// Prints a line for each problem: `INDEX STATUS ITERATIONS x_0 … x_{n-1}`. The times of the solves go to standard
/// error at the end. STATUS is 0 for solved and 1 when the iterations ran out. It is 2 for hard constraints that
/// contradict each other, 3 for an unbounded problem, and 4 for invalid data. From 2 on there is no solution, every x_i
/// is NaN, and standard error has the reason.
#[derive(Debug, Parser)]
#[command(version)]
struct Options {
    /// The set (the book's page "Problem files" describes the format).
    file: PathBuf,
    /// Start each solve from the last solution if their shapes agree.
    #[arg(long)]
    warm: bool,
    /// Number of times that the whole set is solved; the times are those of all solves.
    #[arg(long, value_name = "K", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..))]
    repeat: u32,
    /// Check a certificate of optimality of every solution, outside the times. Residuals of failed checks and a line
    /// `certificate_worst=… certificate_failed=…` go to standard error.
    #[arg(long)]
    certificate: bool,
    #[command(flatten)]
    stacking: StackingOption,
    /// Solve every problem by both methods, and report the largest difference of a variable and the times of both.
    #[arg(long, conflicts_with_all = ["stacking", "certificate"])]
    compare: bool,
    #[command(flatten)]
    result: ResultFile,
    #[command(flatten)]
    printing: Printing,
}

/// The summary of a set: the JSON object of `--json`.
#[derive(Debug, Serialize)]
struct SetSummary {
    problems: usize,
    solved: usize,
    iteration_limit: usize,
    infeasible: usize,
    unbounded: usize,
    refused: usize,
    #[serde(flatten)]
    times: Times,
    #[serde(flatten)]
    proofs: Option<Proofs>,
    #[serde(skip_serializing_if = "Option::is_none")]
    stacking: Option<Compared>,
}

impl Program for Options {
    fn run(self, session: &mut Session) -> Result<Ending> {
        let stacking = self.stacking.method();
        ensure!(
            stacking == Stacking::Elimination || !self.certificate,
            "--certificate: only elimination has one; leave --stacking out"
        );
        let mut file = self.result.create()?;
        let problems = read(&self.file)?;
        let interrupt = session.interrupt().clone();
        let progress = session.progress("solving", problems.len() as u64 * u64::from(self.repeat));
        let mut output: Box<dyn Write + '_> = match &mut file {
            Some(file) => Box::new(file),
            None => Box::new(BufWriter::new(session.output())),
        };
        let mut runs = Runs::with_settings(Settings { stacking, ..Settings::default() });
        let mut comparison = self.compare.then(Comparison::default);
        let mut proofs = self.certificate.then(Proofs::default);
        let mut counts = [0; 5];
        let mut done = 0;
        let mut ending = Ending::Complete;
        'solves: for pass in 0..self.repeat {
            let mut solver = None;
            for problem in &problems {
                if interrupt.requested() {
                    ending = Ending::Partial;
                    break 'solves;
                }
                let outcome = runs.solve(problem, &mut solver, self.warm);
                if pass == 0 {
                    counts[outcome.code as usize] += 1;
                    progress.suspend(|| report(&mut output, problem, &outcome))?;
                    if let Some(reason) = &outcome.reason {
                        progress.note(format_args!("{}: {reason}", self.file.display()));
                    }
                }
                if let (Some(proofs), Some(solver), Code::Solved) =
                    (&mut proofs, &mut solver, outcome.code)
                    && let Some(failure) = proofs.check(problem, solver, &outcome.x)
                {
                    progress.note(format_args!("{}: {failure}", self.file.display()));
                }
                if let (Some(comparison), Code::Solved) = (&mut comparison, outcome.code)
                    && let Err(error) = comparison.add(&problem.hierarchy, &outcome.x)
                {
                    progress.note(format_args!(
                        "{}: not compared: {}",
                        self.file.display(),
                        problem.reason(&error)
                    ));
                }
                done += 1;
                progress.set(done);
            }
        }
        progress.finish();
        output.flush()?;
        drop(output);
        match (file, ending) {
            (Some(file), Ending::Partial) => file.keep_partial().map(drop)?,
            (Some(file), _) => file.keep()?,
            (None, _) => {}
        }
        if ending == Ending::Partial {
            session.warn(format_args!("interrupted after {done} solves"));
        }
        if let Some(Proofs { worst, failed }) = &proofs {
            session.warn(format_args!("certificate_worst={worst:e} certificate_failed={failed}"));
        }
        let times = runs.times();
        session.note(times);
        let compared = comparison.as_ref().map(Comparison::result);
        if let Some(compared) = &compared {
            session.warn(compared);
        }
        let [solved, iteration_limit, infeasible, unbounded, refused] = counts;
        let result = SetSummary {
            problems: counts.iter().sum(),
            solved,
            iteration_limit,
            infeasible,
            unbounded,
            refused,
            times,
            proofs,
            stacking: compared,
        };
        session.conclude(self.printing, &result, ending)
    }
}

fn read(path: &Path) -> Result<Vec<Problem>> {
    let shown = path.display();
    let file = File::open(path).with_context(|| format!("cannot open {shown}"))?;
    let reader = HqpReader::new(BufReader::new(file)).with_context(|| shown.to_string())?;
    reader.collect::<Result<_, _>>().with_context(|| shown.to_string())
}

fn report(output: &mut impl Write, problem: &Problem, outcome: &Outcome) -> Result<()> {
    let Outcome { code, iterations, x, .. } = outcome;
    write!(output, "{} {} {iterations}", problem.index, *code as u8)?;
    for value in x {
        write!(output, " {value:.16e}")?;
    }
    writeln!(output)?;
    Ok(())
}

fn main() -> ExitCode {
    program::main::<Options>()
}
