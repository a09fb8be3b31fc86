//! Trains and evaluates classifiers of surfaces.

use std::process::ExitCode;

use anyhow::Result;
use clap::{Parser, Subcommand};
use examples::{
    program::{self, Ending, Program, Session},
    surface::{cut::Cut, evaluate::Evaluate, generate::Generate, train::Train},
};

/// Learns to distinguish surfaces in images, as the paper's Experiment 1.
///
/// A new last layer and a linear support vector machine are trained over the features of ResNet-50 and ResNet-152.
#[derive(Debug, Parser)]
#[command(version)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    Generate(Generate),
    Cut(Cut),
    Train(Train),
    Evaluate(Evaluate),
}

impl Program for Arguments {
    fn run(self, session: &mut Session) -> Result<Ending> {
        match self.command {
            Command::Generate(command) => command.run(session),
            Command::Cut(command) => command.run(session),
            Command::Train(command) => command.run(session),
            Command::Evaluate(command) => command.run(session),
        }
    }
}

fn main() -> ExitCode {
    program::main::<Arguments>()
}
