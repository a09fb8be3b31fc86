//! Converts a recording to MCAP and back.

use std::{io::Write, path::PathBuf, process::ExitCode};

use anyhow::{Context, Result};
use clap::Parser;
use examples::program::{self, Ending, OutputFile, Printing, Program, Session, read_bytes};
use percept_recording::mcap::{from_json_lines, to_json_lines};
use serde::Serialize;

/// Converts a recording in JSON Lines to MCAP, which Foxglove shows, or such a file back; nothing is lost either way.
///
/// The direction follows from the beginning of the input. A file of `follow --mcap` gives the recording that was
/// played.
#[derive(Debug, Parser)]
#[command(version)]
struct Options {
    /// A recording in JSON Lines or in MCAP.
    #[arg(value_name = "IN")]
    input: PathBuf,
    /// The converted file.
    #[arg(long, short, value_name = "FILE")]
    output: PathBuf,
    #[command(flatten)]
    printing: Printing,
}

/// The JSON object of `--json`.
#[derive(Serialize)]
struct Converted {
    from: &'static str,
    bytes_in: usize,
    bytes_out: usize,
}

/// Largest file of either kind (bytes).
const LARGEST: u64 = 1 << 30;
/// First bytes of every MCAP file.
const MAGIC: &[u8] = b"\x89MCAP";

impl Program for Options {
    fn run(self, session: &mut Session) -> Result<Ending> {
        let name = self.input.display().to_string();
        let input =
            read_bytes(&self.input, LARGEST).with_context(|| format!("cannot open {name}"))?;
        let (from, output) = if input.starts_with(MAGIC) {
            ("MCAP", to_json_lines(&input))
        } else {
            ("JSON Lines", from_json_lines(&input))
        };
        let output = output.with_context(|| name.clone())?;
        OutputFile::write_whole(&self.output, &output)?;
        let (bytes_in, bytes_out) = (input.len(), output.len());
        let to = self.output.display();
        writeln!(session.output(), "{name}, {from}, {bytes_in} bytes -> {to}, {bytes_out} bytes")?;
        session.conclude(self.printing, &Converted { from, bytes_in, bytes_out }, Ending::Complete)
    }
}

fn main() -> ExitCode {
    program::main::<Options>()
}
