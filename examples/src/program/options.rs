//! Options that have the same meaning in every program.

use std::path::PathBuf;
use std::thread;

use clap::{Args, builder::RangedI64ValueParser};
use moca_model::whole_body;
use moca_model::whole_body::control_loop::Scheduling;

use super::{OutputFile, ProgramError};

/// Real-time priority that is asked for without the option: above every thread that has none.
const PRIORITY: u8 = 10;

/// Parses a number of threads, from one to the largest supported number.
pub fn thread_count() -> RangedI64ValueParser<u16> {
    clap::value_parser!(u16).range(1..=1024)
}

/// The options `--json` and `--quiet`.
#[derive(Args, Clone, Copy, Debug, Default)]
pub struct Printing {
    /// Print the result as one JSON object on the last line of standard output.
    #[arg(long)]
    json: bool,
    /// Show only results and errors, no progress and no notes.
    #[arg(long, short)]
    quiet: bool,
}

impl Printing {
    /// Returns true if the JSON object is wanted.
    pub fn wants_json(self) -> bool {
        self.json
    }

    /// Returns true if only results and errors are wanted.
    pub fn is_quiet(self) -> bool {
        self.quiet
    }
}

/// The options `--priority` and `--lock-memory`.
#[derive(Args, Clone, Copy, Debug)]
pub struct RealTime {
    /// Real-time priority of the loop, 1 to 99, which the system must permit; 10 by default where it permits that.
    #[arg(long)]
    priority: Option<u8>,
    /// Lock all memory, so that it is not paged out.
    #[arg(long)]
    lock_memory: bool,
}

impl RealTime {
    /// Gives the calling thread its priority, and locks the memory of the process if asked to.
    ///
    /// # Errors
    /// [`whole_body::Error::Refused`] says what the system does not grant; [`whole_body::Error::Value`] for a priority
    /// out of range. The default priority is no error where it is not granted.
    pub fn apply(self) -> Result<(), whole_body::Error> {
        self.scheduling().apply()
    }

    /// Returns the scheduling of the loop's thread, with the default priority only where the system permits that.
    pub fn scheduling(self) -> Scheduling {
        let default = Scheduling { priority: Some(PRIORITY), lock_memory: false };
        // A thread of its own tries it, so that the calling one keeps its priority.
        let is_permitted =
            || thread::spawn(move || default.apply().is_ok()).join().unwrap_or(false);
        let priority = self.priority.or_else(|| default.priority.filter(|_| is_permitted()));
        Scheduling { priority, lock_memory: self.lock_memory }
    }
}

/// The option `--seed`.
#[derive(Args, Clone, Copy, Debug)]
pub struct Seed {
    /// Seed of all random numbers: the same seed gives the same result.
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
}

/// The option `--threads`.
#[derive(Args, Clone, Copy, Debug)]
pub struct Threads {
    /// Threads that share the work, 1 to 1024.
    #[arg(long, value_name = "COUNT", default_value_t = 1, value_parser = thread_count())]
    threads: u16,
}

impl Threads {
    /// The number of threads, at least one.
    pub fn count(self) -> usize {
        self.threads.into()
    }
}

/// The option `--output` of programs whose result otherwise goes to standard output.
#[derive(Args, Clone, Debug)]
pub struct ResultFile {
    /// Write the result to this file instead of standard output.
    #[arg(long, short, value_name = "FILE")]
    output: Option<PathBuf>,
}

impl ResultFile {
    /// Creates the file, if one is asked for. Call this before the work, so that a wrong place is known early.
    ///
    /// # Errors
    /// As [`OutputFile::create`].
    pub fn create(&self) -> Result<Option<OutputFile>, ProgramError> {
        self.output.as_ref().map(OutputFile::create).transpose()
    }
}
