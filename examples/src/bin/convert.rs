//! Lists the tensors of a checkpoint, and writes it as safetensors.

use std::{
    io::{self, Write},
    path::{Path, PathBuf},
    process::ExitCode,
};

use anyhow::{Result, ensure};
use clap::Parser;
use examples::program::{self, Ending, Interrupt, OutputFile, Printing, Program, Session};
use human_perception::networks::open_checkpoint;
use serde::Serialize;
use vision_models::{Checkpoint, Error, NetworkKind, file::Excerpt};

/// Prints what a checkpoint holds and writes its tensors as safetensors.
///
/// The input is a file of torch.save (.pth, .pt, .pyth; zip format or the older one) or a .safetensors. Nothing in it
/// is executed. Every tensor keeps its element type. An interrupted conversion leaves no file.
#[derive(Debug, Parser)]
#[command(version)]
struct Arguments {
    /// The checkpoint.
    #[arg(value_name = "IN")]
    input: PathBuf,
    /// The output, the same as --output; if both are left out, the tensors are only listed.
    #[arg(value_name = "OUT.safetensors")]
    place: Option<PathBuf>,
    /// The file for the tensors.
    #[arg(long, short, value_name = "FILE", conflicts_with = "place")]
    output: Option<PathBuf>,
    #[command(flatten)]
    printing: Printing,
}

/// The JSON object of `--json`.
#[derive(Serialize)]
struct Contents {
    format: String,
    /// Null for a network that this project does not have.
    network: Option<String>,
    tensors: usize,
    elements: usize,
    output: Option<PathBuf>,
}

impl Program for Arguments {
    fn run(self, session: &mut Session) -> Result<Ending> {
        let output = self.output.or(self.place);
        let file = output.as_deref().map(|output| begin(&self.input, output)).transpose()?;
        let mut checkpoint = open_checkpoint(&self.input)?;
        let contents = Contents::of(&checkpoint, output);
        contents.list(&checkpoint, session.output())?;
        if let Some(file) = file {
            let mut writer = UntilInterrupt { file, interrupt: session.interrupt().clone() };
            let written = checkpoint.write_safetensors(&mut writer);
            session.interrupt().check()?;
            written.map_err(|error| match error {
                // The error contains the name of the written file.
                Error::File { .. } => anyhow::Error::from(error),
                error => anyhow::anyhow!("{}: {error}", self.input.display()),
            })?;
            writer.file.keep()?;
        }
        session.conclude(self.printing, &contents, Ending::Complete)
    }
}

/// Creates the output. It must not be the input, which would be lost while it is read.
fn begin(input: &Path, output: &Path) -> Result<OutputFile> {
    let same = output
        .canonicalize()
        .is_ok_and(|output| input.canonicalize().is_ok_and(|input| input == output));
    let shown = input.display();
    ensure!(!same, "{shown} would be overwritten while it is read: give another name");
    Ok(OutputFile::create(output)?)
}

/// A file whose writing fails after an interrupt.
struct UntilInterrupt {
    file: OutputFile,
    interrupt: Interrupt,
}

impl Write for UntilInterrupt {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        // `ErrorKind::Interrupted` would lead to another attempt.
        self.interrupt.check().map_err(io::Error::other)?;
        self.file.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

impl Contents {
    fn of(checkpoint: &Checkpoint, output: Option<PathBuf>) -> Self {
        Self {
            format: checkpoint.format().to_string(),
            network: NetworkKind::of(checkpoint).map(|kind| kind.to_string()),
            tensors: checkpoint.tensors().count(),
            elements: checkpoint.tensors().map(|(_, info)| info.elements()).sum(),
            output,
        }
    }

    fn list(&self, checkpoint: &Checkpoint, out: &mut impl Write) -> Result<()> {
        write!(out, "{}", self.format)?;
        for wrapper in checkpoint.wrappers() {
            write!(out, ", under \"{wrapper}\"")?;
        }
        writeln!(out)?;
        if let Some(network) = &self.network {
            writeln!(out, "a {network}")?;
        }
        if !checkpoint.others().is_empty() {
            let shown = |name: &String| Excerpt(name).to_string();
            let others: Vec<_> = checkpoint.others().iter().map(shown).collect();
            writeln!(out, "not read: {}", others.join(", "))?;
        }
        let length = |(name, _): (&str, _)| Excerpt(name).to_string().chars().count();
        let width = checkpoint.tensors().map(length).max().unwrap_or(0);
        for (name, info) in checkpoint.tensors() {
            let name = Excerpt(name).to_string();
            writeln!(out, "{name:width$}  {:4}  {:?}", info.element(), info.shape())?;
        }
        writeln!(out, "{} tensors, {} elements", self.tensors, self.elements)?;
        Ok(())
    }
}

fn main() -> ExitCode {
    program::main::<Arguments>()
}
