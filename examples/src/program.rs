//! Common behaviour of all programs: beginning and ending, output, files, progress and interrupts.
//!
//! A program is a `clap` parser that implements [`Program`]; its `main` is one call:
//!
//! ```no_run
//! use std::{io::Write, process::ExitCode};
//!
//! use examples::program::{self, Ending, Printing, Program, Session};
//!
//! /// Counts to ten.
//! #[derive(clap::Parser)]
//! struct Options {
//!     #[command(flatten)]
//!     printing: Printing,
//! }
//!
//! #[derive(serde::Serialize)]
//! struct Counted {
//!     last: u64,
//! }
//!
//! impl Program for Options {
//!     fn run(self, session: &mut Session) -> anyhow::Result<Ending> {
//!         let progress = session.progress("count", 10);
//!         let mut last = 0;
//!         while last < 10 && !session.interrupt().requested() {
//!             last += 1;
//!             progress.set(last);
//!         }
//!         progress.finish();
//!         writeln!(session.output(), "{last}")?;
//!         let ending = if last < 10 { Ending::Partial } else { Ending::Complete };
//!         session.conclude(self.printing, &Counted { last }, ending)
//!     }
//! }
//!
//! fn main() -> ExitCode {
//!     program::main::<Options>()
//! }
//! ```
//!
//! The rules:
//! - Results go to standard output, everything else to standard error. Both are written without
//!   `println!`, which panics when the other end is closed.
//! - Outputs are checked before the work: [`check_folder`] and [`OutputFile::create`] come first.
//! - Long work checks [`Interrupt::requested`] now and then. After an interrupt it keeps and prints its results so far.
//! - `--output`, `--json`, `--threads`, `--seed` and `--quiet` have the same meaning everywhere.

mod begin;
mod ending;
mod error;
mod file;
mod folder;
mod input;
mod interrupt;
mod message;
mod options;
mod progress;
mod session;
mod shown;
mod standard_input;
mod standard_output;
mod watch;

pub use begin::{Program, main};
pub use ending::Ending;
pub use error::ProgramError;
pub use file::OutputFile;
pub use folder::check_folder;
pub use input::InputFile;
pub use interrupt::Interrupt;
pub use message::warn;
pub use options::{Printing, RealTime, ResultFile, Seed, Threads, thread_count};
pub use progress::Progress;
pub use session::Session;
pub use shown::{Shown, shown};
pub use standard_input::StandardInput;
pub use standard_output::StandardOutput;
pub use vision_models::file::{read_bytes, read_text};
