//! The closed loop of MOCA under random people, workspaces and losses; counts what goes wrong.

use std::process::ExitCode;

use anyhow::Result;
use clap::Parser;
use examples::soak::Soak;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

#[derive(Debug, Parser)]
#[command(version, about)]
struct Options {
    /// Control periods of a millisecond to run
    #[arg(long, default_value_t = 100_000, value_parser = clap::value_parser!(u64).range(1..=1_000_000_000))]
    ticks: u64,

    /// Seed of everything that is random
    #[arg(long, default_value_t = 1)]
    seed: u64,

    /// Print the summary as one JSON object on the last line
    #[arg(long)]
    json: bool,
}

fn main() -> Result<ExitCode> {
    let options = Options::parse();
    let style = ProgressStyle::with_template("soak {wide_bar} {percent:>3} %  {elapsed}")
        .unwrap_or_else(|_| ProgressStyle::default_bar());
    let bar = ProgressBar::with_draw_target(Some(options.ticks), ProgressDrawTarget::stderr())
        .with_style(style);
    let summary = Soak::new(options.seed, options.ticks)?.run(|ticks| bar.set_position(ticks))?;
    bar.finish_and_clear();
    for finding in &summary.findings {
        eprintln!("{finding}");
    }
    if options.json {
        println!("{}", summary.json()?);
    } else {
        println!("{summary}");
    }
    Ok(if summary.counts.wrong() == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}
