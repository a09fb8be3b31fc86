//! Scores filled-in REBA or RULA sheets, one a row of a table.

use std::{
    fs::File,
    io::{self, BufRead, BufReader},
    path::PathBuf,
};

use anyhow::{Context, Result};
use clap::Parser;
use ergo_map::{RulaWorksheet, Worksheet};
use examples::ergonomics::score_table;

/// Scores filled-in REBA sheets, one a row of a comma-separated table.
///
/// Writes the same rows to standard output with the sub-scores, the tables' values, the score and
/// its action level behind them, for REBA also the continuous score (faithful) and e_s (graded).
/// The book's page on the programs names the columns.
#[derive(Debug, Parser)]
#[command(version)]
struct Options {
    /// The table; - is standard input.
    #[arg(long, short, value_name = "FILE")]
    input: PathBuf,
    /// Score RULA instead of REBA.
    #[arg(long)]
    rula: bool,
}

fn main() -> Result<()> {
    let options = Options::parse();
    let shown = options.input.display();
    let table: Box<dyn BufRead> = if options.input.as_os_str() == "-" {
        Box::new(io::stdin().lock())
    } else {
        let file = File::open(&options.input).with_context(|| format!("cannot open {shown}"))?;
        Box::new(BufReader::new(file))
    };
    let output = io::stdout().lock();
    let scored = if options.rula {
        score_table::<RulaWorksheet>(table, output)
    } else {
        score_table::<Worksheet>(table, output)
    };
    scored.with_context(|| shown.to_string())?;
    Ok(())
}
