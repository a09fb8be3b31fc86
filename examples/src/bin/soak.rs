//! The closed loop of MOCA under random people, workspaces and losses; counts what goes wrong.

use std::{io::Write, ops::ControlFlow, process::ExitCode};

use clap::Parser;
use examples::program::{self, Ending, Json, Program, Quiet, Seed, Session};
use examples::soak::Soak;

/// Tries the controller on random people, workspaces, starts and camera losses, and counts every
/// violated promise.
///
/// Each millisecond of the simulated loop is checked apart from the controller: problems not solved,
/// numbers that are not finite, limits of position, velocity, acceleration, jerk and torque, distances from the
/// person, jumps of the desired motion, self-collisions. What is found goes to standard error, the
/// counts to standard output. The exit status is 1 if anything was found. Ctrl-C ends a long soak
/// and prints the counts up to there.
#[derive(Debug, Parser)]
#[command(version)]
struct Options {
    /// Control periods of a millisecond to run.
    #[arg(long, value_name = "COUNT", default_value_t = 100_000, value_parser = clap::value_parser!(u64).range(1..=1_000_000_000))]
    ticks: u64,
    /// A robot that follows velocities exactly and at once, in place of one that moves under torques.
    #[arg(long)]
    kinematic: bool,
    #[command(flatten)]
    seed: Seed,
    #[command(flatten)]
    json: Json,
    #[command(flatten)]
    quiet: Quiet,
}

impl Program for Options {
    fn quiet(&self) -> Quiet {
        self.quiet
    }

    fn run(self, session: &mut Session) -> anyhow::Result<Ending> {
        let progress = session.progress("soak", self.ticks);
        let interrupt = session.interrupt().clone();
        let soak = Soak::new(self.seed.seed, self.ticks)?;
        let soak = if self.kinematic { soak.kinematic() } else { soak };
        let summary = soak.run(|ticks| {
            progress.set(ticks);
            if interrupt.requested() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        })?;
        progress.finish();
        let ending = if summary.ticks < self.ticks {
            Ending::Partial
        } else if summary.counts.wrong() > 0 {
            Ending::Failed
        } else {
            Ending::Complete
        };
        for finding in &summary.findings {
            session.warn(finding);
        }
        if ending == Ending::Partial {
            session
                .warn(format_args!("interrupted after {} of {} ticks", summary.ticks, self.ticks));
        }
        writeln!(session.output(), "{summary}")?;
        session.conclude(self.json, &summary, ending)
    }
}

fn main() -> ExitCode {
    program::main::<Options>()
}
