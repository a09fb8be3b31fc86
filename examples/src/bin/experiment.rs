//! The paper's Experiments 3, 4 and 5 with simulated people.

use std::process::ExitCode;

use anyhow::Result;
use clap::{Parser, Subcommand};
use examples::experiment::{Following, Reorientation, Subjects};
use examples::program::{self, Ending, Program, Session};

/// Plays the paper's experiments on ergonomics with simulated people, with ergonomics and without.
///
/// Every experiment has many random cases, prints mean, spread and worst for both, and draws its figures. The same seed
/// gives the same table.
#[derive(Debug, Parser)]
#[command(version)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    Reorientation(Reorientation),
    Following(Following),
    Subjects(Subjects),
}

impl Program for Arguments {
    fn run(self, session: &mut Session) -> Result<Ending> {
        match self.command {
            Command::Reorientation(command) => command.run(session),
            Command::Following(command) => command.run(session),
            Command::Subjects(command) => command.run(session),
        }
    }
}

fn main() -> ExitCode {
    program::main::<Arguments>()
}
