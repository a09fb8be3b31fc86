//! Runs MOCA's closed loop under random people, workspaces and losses, and counts violations.

use std::{io::Write, path::PathBuf, process::ExitCode};

use anyhow::Context;
use clap::Parser;
use examples::program::{self, Ending, Printing, Program, Seed, Session};
use examples::settings::{RobotSettings, SettingsFile};
use examples::shards::ShardOptions;
use examples::soak::{self, Job};
use moca_simulation::plant::{Drive, PlantSettings};
use moca_simulation::soak::{Movements, Soak, Summary};

/// Tries the controller on random people, workspaces, starts and camera losses, and counts every
/// violated promise.
///
/// Each millisecond of the simulated loop is checked independently of the controller. The checks are unsolved problems,
/// numbers that are not finite, and limits of position, velocity, acceleration, jerk and torque. They also cover
/// distances from the person, jumps of the desired motion, and self-collisions.
///
/// Findings go to standard error, the counts to standard output. The exit status is 1 if anything was found. Ctrl-C
/// ends a long soak and prints the counts so far.
#[derive(Debug, Parser)]
#[command(version)]
struct Options {
    /// Number of control periods of a millisecond.
    #[arg(long, value_name = "COUNT", default_value_t = 100_000, value_parser = clap::value_parser!(u64).range(1..=1_000_000_000))]
    ticks: u64,
    /// Instead, run each movement on the spot for this number of people near the tool. Each takes 8 s without
    /// disturbances; every other person works with the robot. Movements are bowing, kneeling, sitting down, reaching
    /// and others.
    #[arg(long, value_name = "PEOPLE", value_parser = clap::value_parser!(u64).range(1..=100_000), conflicts_with_all = ["ticks", "shard", "shard_file"])]
    movements: Option<u64>,
    /// A robot that follows velocities exactly and at once, in place of one under torques.
    #[arg(long)]
    kinematic: bool,
    /// Take these settings in place of the defaults; `follow --write-settings` makes a file to begin with. Each episode
    /// still draws its own goal.
    #[arg(long, value_name = "FILE")]
    settings: Option<PathBuf>,
    #[command(flatten)]
    shards: ShardOptions,
    #[command(flatten)]
    seed: Seed,
    #[command(flatten)]
    printing: Printing,
}

impl Program for Options {
    fn run(self, session: &mut Session) -> anyhow::Result<Ending> {
        if let Some(people) = self.movements {
            return self.run_movements(people, session);
        }
        let file = self.shards.create()?;
        let robot = self.robot()?;
        let (seed, shard) = (self.seed.seed, self.shards.shard());
        let settings = RobotSettings::from(&robot).to_toml()?;
        let job = Job::new(seed, self.ticks, robot.drive, settings);
        let soak = Soak::new(seed, self.ticks)?.with_robot(robot);
        let wanted = soak::episodes(&soak, shard).iter().map(|episode| episode.ticks).sum();
        let interrupt = session.interrupt().clone();
        let progress = session.progress("soak", wanted);
        let part = soak::run(&soak, job, shard, |ticks| {
            progress.set(ticks);
            interrupt.flow()
        });
        let part = self.of_settings(part)?;
        progress.finish();
        let summary = Summary::of(&part.results, &part.times);
        let ending = if summary.ticks < wanted {
            Ending::Partial
        } else if summary.counts.wrong() > 0 {
            Ending::Failed
        } else {
            Ending::Complete
        };
        // An incomplete shard cannot be merged.
        if ending != Ending::Partial {
            ShardOptions::write(file, &part)?;
        }
        for finding in &summary.findings {
            session.warn(finding);
        }
        if ending == Ending::Partial {
            session.warn(format_args!("interrupted after {} of {} ticks", summary.ticks, wanted));
        }
        writeln!(session.output(), "{summary}")?;
        session.conclude(self.printing, &summary, ending)
    }
}

impl Options {
    /// Runs each movement of this number of people.
    fn run_movements(&self, people: u64, session: &mut Session) -> anyhow::Result<Ending> {
        let movements = Movements { seed: self.seed.seed, people, robot: self.robot()? };
        let (wanted, interrupt) = (movements.ticks(), session.interrupt().clone());
        let progress = session.progress("movements", wanted);
        let mut done = 0;
        let results = movements.run(|ticks| {
            done = ticks;
            progress.set(ticks);
            interrupt.flow()
        });
        let results = self.of_settings(results)?;
        progress.finish();
        let ending = match results.wrong() {
            _ if done < wanted => Ending::Partial,
            0 => Ending::Complete,
            _ => Ending::Failed,
        };
        for finding in &results.findings {
            session.warn(finding);
        }
        writeln!(session.output(), "{results}")?;
        session.conclude(self.printing, &results, ending)
    }

    /// Adds the name of the settings file, if there is one, to errors of the controller.
    fn of_settings<T>(&self, result: Result<T, moca_simulation::Error>) -> anyhow::Result<T> {
        match &self.settings {
            Some(path) => result.with_context(|| format!("with {}", path.display())),
            None => Ok(result?),
        }
    }

    /// The robot and its settings.
    fn robot(&self) -> anyhow::Result<PlantSettings> {
        let drive = if self.kinematic { Drive::Kinematic } else { Drive::default() };
        let settings = match &self.settings {
            Some(path) => SettingsFile::read(path)
                .and_then(|file| file.over(&RobotSettings::default()))
                .with_context(|| path.display().to_string())?,
            None => RobotSettings::default(),
        };
        Ok(settings.of_plant(drive))
    }
}

fn main() -> ExitCode {
    program::main::<Options>()
}
