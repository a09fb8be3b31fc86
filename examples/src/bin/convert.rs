//! Says what is in a checkpoint, and writes it as safetensors.

use std::{
    fs::File,
    io::{BufWriter, Write, stdout},
    path::PathBuf,
};

use anyhow::{Context, Result, ensure};
use clap::Parser;
use vision_models::Checkpoint;

/// Prints what a checkpoint holds and writes its tensors as safetensors.
///
/// The input is a file of torch.save (.pth, .pt, .pyth; zip format or the older one) or a
/// .safetensors. Nothing in it is executed. Every tensor keeps its element type.
#[derive(Debug, Parser)]
#[command(version)]
struct Arguments {
    /// The checkpoint.
    #[arg(value_name = "IN")]
    input: PathBuf,
    /// Where the tensors go; without it, they are only listed.
    #[arg(value_name = "OUT.safetensors")]
    output: Option<PathBuf>,
}

fn main() -> Result<()> {
    let arguments = Arguments::parse();
    let shown = arguments.input.display();
    let mut checkpoint =
        Checkpoint::open(&arguments.input).with_context(|| format!("cannot read {shown}"))?;
    list(&checkpoint)?;
    let Some(output) = arguments.output else { return Ok(()) };
    let same = output.canonicalize().ok() == Some(arguments.input.canonicalize()?);
    ensure!(!same, "{shown} would be overwritten while it is read: give another name");
    let file =
        File::create(&output).with_context(|| format!("cannot write {}", output.display()))?;
    checkpoint
        .write_safetensors(BufWriter::new(file))
        .with_context(|| format!("cannot write {}", output.display()))
}

fn list(checkpoint: &Checkpoint) -> Result<()> {
    let mut out = stdout().lock();
    write!(out, "{}", checkpoint.format())?;
    for wrapper in checkpoint.wrappers() {
        write!(out, ", under \"{wrapper}\"")?;
    }
    writeln!(out)?;
    if !checkpoint.others().is_empty() {
        writeln!(out, "not read: {}", checkpoint.others().join(", "))?;
    }
    let width = checkpoint.tensors().map(|(name, _)| name.chars().count()).max().unwrap_or(0);
    let (mut tensors, mut elements) = (0_usize, 0_usize);
    for (name, info) in checkpoint.tensors() {
        writeln!(out, "{name:width$}  {:4}  {:?}", info.element(), info.shape())?;
        tensors += 1;
        elements += info.elements();
    }
    writeln!(out, "{tensors} tensors, {elements} elements")?;
    Ok(())
}
