//! Merges the shards that several machines have computed into one result.

use std::{io::Write, path::PathBuf, process::ExitCode};

use anyhow::{Result, bail};
use clap::Parser;
use examples::actions::evaluate;
use examples::experiment::{self, program};
use examples::program::{self, Ending, Printing, Program, Session, check_folder};
use examples::shards::{Merged, ShardError, program_of};
use examples::soak;
use human_perception::actions::evaluated::Evaluated;
use moca_simulation::experiment::Experiment;
use moca_simulation::experiment::following::Following;
use moca_simulation::experiment::reorientation::Reorientation;
use moca_simulation::experiment::subjects::Subjects;

/// Merges the files that a program wrote with --shard I/N --shard-file FILE. All N files are needed, in any order.
/// Prints the result of all cases as on one machine.
///
/// The result is the same for any N, except for times. The exit status is that of the program. Programs with shards:
/// soak, actions evaluate, experiment.
#[derive(Debug, Parser)]
#[command(version)]
struct Options {
    /// The files of all shards.
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,
    /// Write the files of `actions evaluate --output` or `experiment --output` into this folder.
    #[arg(long, short, value_name = "FOLDER")]
    output: Option<PathBuf>,
    #[command(flatten)]
    printing: Printing,
}

impl Program for Options {
    fn run(self, session: &mut Session) -> Result<Ending> {
        let Some(first) = self.files.first() else { return Err(ShardError::Nothing.into()) };
        match program_of(first)?.as_str() {
            soak::PROGRAM => self.soak(session),
            evaluate::PROGRAM => self.evaluation(session),
            other if other == program::<Reorientation>() => {
                self.experiment::<Reorientation>(session)
            }
            other if other == program::<Following>() => self.experiment::<Following>(session),
            other if other == program::<Subjects>() => self.experiment::<Subjects>(session),
            other => bail!(
                "{}: shards of \"{other}\" are not known; known are {}, {} and experiment",
                first.display(),
                soak::PROGRAM,
                evaluate::PROGRAM
            ),
        }
    }
}

impl Options {
    fn soak(self, session: &mut Session) -> Result<Ending> {
        if self.output.is_some() {
            bail!("a soak writes no folder; leave out --output");
        }
        let summary = soak::merged_summary(Merged::read(&self.files)?);
        for finding in &summary.findings {
            session.warn(finding);
        }
        let failed = summary.counts.wrong() > 0;
        writeln!(session.output(), "{summary}")?;
        let ending = if failed { Ending::Failed } else { Ending::Complete };
        session.conclude(self.printing, &summary, ending)
    }

    fn evaluation(self, session: &mut Session) -> Result<Ending> {
        self.output.as_deref().map(check_folder).transpose()?;
        let Merged { job, results, times } = Merged::read(&self.files)?;
        let _: Vec<()> = times;
        let report = Evaluated::of(&job, &results)?;
        report.write(session.output())?;
        if let Some(folder) = &self.output {
            report.write_folder(folder, &job, &results)?;
        }
        session.conclude(self.printing, &report, Ending::Complete)
    }

    fn experiment<E: Experiment>(self, session: &mut Session) -> Result<Ending> {
        self.output.as_deref().map(experiment::make_folder).transpose()?;
        experiment::merge::<E>(&self.files, self.output.as_deref(), self.printing, session)
    }
}

fn main() -> ExitCode {
    program::main::<Options>()
}
