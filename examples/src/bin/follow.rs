//! MOCA follows a person: a recording, the controller at 1 kHz, the simulated robot; with
//! ergonomics and without.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, sync_channel};
use std::thread;
use std::time::Duration;

use anyhow::{Context, Result, ensure};
use clap::Parser;
use ergo_map::{ErgonomicsMap, MapOptions, Person};
use examples::follow::{Comparison, Run, Scenario, Summary};
use examples::recording::{self, Reader};
use examples::report::{RunLog, TickRow, TickTable, figure};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use moca_model::Goal;
use vision_models::Percept;

/// Stature where neither the recording nor the command line gives one (m).
const DEFAULT_STATURE: f64 = 1.75;
/// Ticks that travel to the report together.
const BATCH: usize = 512;

#[derive(Debug, Parser)]
#[command(version, about)]
struct Options {
    /// Play this recording (JSON Lines, see the book) instead of the one that is shipped
    #[arg(long, value_name = "FILE")]
    recording: Option<PathBuf>,

    /// Stature of the person in metres, in place of the recording's
    #[arg(long, value_name = "METRES", allow_negative_numbers = true)]
    stature: Option<f64>,

    /// Keep people at their protective distances, by stops where there is no other way
    #[arg(long)]
    separation: bool,

    /// Folder for the report
    #[arg(long, value_name = "FOLDER", default_value = "report")]
    report: PathBuf,

    /// Write no report
    #[arg(long)]
    no_report: bool,

    /// Print the summary as one JSON object on the last line
    #[arg(long)]
    json: bool,
}

fn main() -> Result<()> {
    let options = Options::parse();
    let scenario = load(&options)?;
    if !options.no_report {
        fs::create_dir_all(&options.report)
            .with_context(|| format!("making the folder {}", options.report.display()))?;
    }
    let (on, log_on) = play(&scenario, &options, Goal::Ergonomics, "Ergonomics on", "on")?;
    let (off, log_off) = play(&scenario, &options, Goal::LeastMotion, "Ergonomics off", "off")?;
    let comparison = Comparison { on, off };
    println!("{comparison}");
    if let (Some(on), Some(off)) = (log_on, log_off) {
        let path = options.report.join("follow.svg");
        fs::write(&path, figure(&[&on, &off])?)
            .with_context(|| format!("writing {}", path.display()))?;
        println!("report: {}", options.report.display());
    }
    if options.json {
        println!("{}", comparison.json()?);
    }
    Ok(())
}

fn load(options: &Options) -> Result<Scenario> {
    let (percepts, recorded) = match &options.recording {
        Some(path) => {
            read(recording::open(path)?).with_context(|| format!("reading {}", path.display()))?
        }
        None => read(recording::shipped()?)?,
    };
    let stature = options.stature.or(recorded).unwrap_or(DEFAULT_STATURE);
    let person = Person::new(stature)?;
    let bar = progress("map of the person");
    let report = |done: usize, all: usize| {
        bar.set_length(all as u64);
        bar.set_position(done as u64);
    };
    let map = ErgonomicsMap::build(&person, &MapOptions::default(), Some(&report))?;
    bar.finish_and_clear();
    let scenario = Scenario::new(percepts, &person, map)?;
    Ok(if options.separation { scenario.with_separation() } else { scenario })
}

/// The camera frames, and the person's stature if the recording says it.
fn read<R: std::io::BufRead>(reader: Reader<R>) -> Result<(Vec<Percept>, Option<f64>)> {
    let stature = reader.header().stature;
    let percepts: Vec<Percept> = reader.collect::<Result<_, _>>()?;
    ensure!(!percepts.is_empty(), "the recording holds no camera frame");
    Ok((percepts, stature))
}

/// One run; the report is written beside it in another thread, so that the loop only computes.
fn play(
    scenario: &Scenario,
    options: &Options,
    goal: Goal,
    title: &str,
    name: &str,
) -> Result<(Summary, Option<RunLog>)> {
    let run = Run::new(scenario, goal)?;
    let bar = progress(title);
    // A tick a millisecond.
    let ticks = Duration::from_secs_f64(scenario.duration()).as_millis();
    bar.set_length(u64::try_from(ticks).unwrap_or(u64::MAX));
    if options.no_report {
        let summary = run.play(counting(&bar, |_| Ok(())))?;
        bar.finish_and_clear();
        return Ok((summary, None));
    }
    let path = options.report.join(format!("ticks-{name}.csv"));
    thread::scope(|scope| {
        let (sender, receiver) = sync_channel::<Vec<TickRow>>(64);
        let writer = scope.spawn(move || write_ticks(&path, title, &receiver));
        let mut batch = Vec::with_capacity(BATCH);
        let played = run.play(counting(&bar, |row| {
            batch.push(row.clone());
            if batch.len() == BATCH {
                let full = std::mem::replace(&mut batch, Vec::with_capacity(BATCH));
                // A writer that has failed says why when it is joined.
                let _ = sender.send(full);
            }
            Ok(())
        }));
        let _ = sender.send(batch);
        drop(sender);
        let log = writer.join().map_err(|_| anyhow::anyhow!("the report's writer panicked"))??;
        bar.finish_and_clear();
        Ok((played?, Some(log)))
    })
}

fn write_ticks(path: &Path, title: &str, receiver: &Receiver<Vec<TickRow>>) -> Result<RunLog> {
    let mut table = TickTable::create(path)?;
    let mut log = RunLog::new(title);
    for batch in receiver {
        for row in &batch {
            table.write(row)?;
            log.push(row);
        }
    }
    table.finish()?;
    Ok(log)
}

/// Moves the bar now and then.
fn counting<'a>(
    bar: &'a ProgressBar,
    mut each: impl FnMut(&TickRow) -> Result<()> + 'a,
) -> impl FnMut(&TickRow) -> Result<()> + 'a {
    let mut ticks = 0_u64;
    move |row| {
        ticks += 1;
        if ticks.is_multiple_of(1000) {
            bar.set_position(ticks);
        }
        each(row)
    }
}

fn progress(what: &str) -> ProgressBar {
    let style = ProgressStyle::with_template("{msg:20} {wide_bar} {percent:>3} %  {elapsed}")
        .unwrap_or_else(|_| ProgressStyle::default_bar());
    ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr())
        .with_style(style)
        .with_message(what.to_owned())
}
