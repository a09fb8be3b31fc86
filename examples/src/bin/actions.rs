//! Trains and evaluates recognisers of actions.

use std::process::ExitCode;

use anyhow::Result;
use clap::{Parser, Subcommand};
use examples::{
    actions::{cut::Cut, evaluate::Evaluate, train::Train},
    program::{self, Ending, Program, Session},
};

/// Learns to recognise actions in clips, as the paper's Experiment 2: a new last layer over the features of SlowOnly.
///
/// A clip is a folder of JPEG or PNG files. Make one from a video by ffmpeg: ffmpeg -i clip.avi -q:v 2 clip/%05d.jpg
#[derive(Debug, Parser)]
#[command(version)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    Cut(Cut),
    Train(Train),
    Evaluate(Evaluate),
}

impl Program for Arguments {
    fn run(self, session: &mut Session) -> Result<Ending> {
        match self.command {
            Command::Cut(command) => command.run(session),
            Command::Train(command) => command.run(session),
            Command::Evaluate(command) => command.run(session),
        }
    }
}

fn main() -> ExitCode {
    program::main::<Arguments>()
}
