//! Lets MOCA follow a recorded person: the controller at 1 kHz and the simulated robot, with and without ergonomics.

use std::fs;
use std::io::Write;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::mpsc::{Receiver, sync_channel};
use std::thread;
use std::time::Duration;

use anyhow::{Context, Result, anyhow, bail};
use clap::Parser;
use ergo_map::{ErgonomicsMap, MapOptions, Person};
use examples::maps::{build_map, read_map};
use examples::posture::PostureOptions;
#[cfg(feature = "mcap")]
use examples::program::read_bytes;
use examples::program::{
    self, Ending, Interrupt, OutputFile, Printing, Program, Progress, Session, check_folder,
};
use examples::settings::{RobotSettings, SettingsFile, with_settings};
use examples::shipped;
use examples::stacking::{StackingOption, StackingWatch};
use hqp_problems::comparison::Compared;
use moca_model::{Goal, MOCA_URDF};
#[cfg(feature = "mcap")]
use moca_replay::mcap::RobotLog;
use moca_replay::page::page;
use moca_replay::picture::{animation, still};
use moca_replay::recorded::Replay;
use moca_replay::report::{MOCA_COLUMNS, RunLog, TickRow, TickTable, figure};
use moca_simulation::experiment::{Sight, Walk};
use moca_simulation::people::WalkerSettings;
use moca_simulation::plant::Plant;
use moca_simulation::run::{Comparison, Run, Scenario, Summary, TrueMotion};
use percept_recording::{self, Completeness, Header, IfPartial, Recording, RecordingError};
use serde::Serialize;

/// Stature of a person if neither the recording nor the command line gives one \[m\].
const DEFAULT_STATURE: f64 = 1.75;
/// Largest difference of two statures of one person \[m\].
const SAME_STATURE: f64 = 0.01;
/// Largest recording that is written into an MCAP file (bytes).
#[cfg(feature = "mcap")]
const LARGEST_RECORDING: u64 = 1 << 30;
/// Title of the page.
const TITLE: &str = "MOCA follows a person";
/// Number of ticks that are sent to the report together.
const BATCH: usize = 512;

/// Lets the simulated robot MOCA follow a recorded person at 1 kHz, once with ergonomics and once without, and compares
/// the two.
///
/// Prints the quality of the person's posture, tracking errors, margins of limits, and the time of a control period.
/// Writes a page, pictures and a table of every period into the report's folder. Ctrl-C ends early and keeps the
/// results so far in files named *.partial.*.
#[derive(Debug, Parser)]
#[command(version)]
#[expect(clippy::struct_excessive_bools, reason = "each is a switch of the command line")]
struct Options {
    /// Play this recording (JSON Lines, as `record` makes them) instead of the one that is built in.
    #[arg(long, value_name = "FILE")]
    recording: Option<PathBuf>,
    /// Play a recording that was cut off or interrupted, as far as it goes. The result is marked as partial, and the
    /// report's files are named *.partial.*.
    #[arg(long, requires = "recording")]
    partial: bool,
    /// The person's true motion (JSON Lines with all joints at 50 Hz or more, as `record --truth` writes it). It judges
    /// distances in place of the recording.
    #[arg(long, value_name = "FILE")]
    truth: Option<PathBuf>,
    /// Stature of the person in metres, in place of the recording's.
    #[arg(long, value_name = "METRES", allow_negative_numbers = true)]
    stature: Option<f64>,
    /// The person's ergonomics map, as `ergo_map` saves it, in place of one that is built for the stature. It
    /// determines the working hand.
    #[arg(long, value_name = "FILE")]
    map: Option<PathBuf>,
    /// Take these settings in place of the defaults; --write-settings makes a file to begin with. The goal stays that
    /// of each of the two runs.
    #[arg(long, value_name = "FILE")]
    settings: Option<PathBuf>,
    /// Write all settings with their meaning to a TOML file, those of --settings if given, and play nothing.
    #[arg(long, value_name = "FILE")]
    write_settings: Option<PathBuf>,
    /// Write the recording, and what the robot does with ergonomics, to this MCAP file, for Foxglove.
    #[cfg(feature = "mcap")]
    #[arg(long, value_name = "FILE")]
    mcap: Option<PathBuf>,
    /// Only the paper's stack: keep no protective distances, and do not slow down near people.
    #[arg(long)]
    no_separation: bool,
    /// Play the paper's own controller: its three levels, the period as the horizon, and no posture, margin, lead,
    /// following distance or separation.
    #[arg(long)]
    paper: bool,
    #[command(flatten)]
    stacking: StackingOption,
    /// Solve the problem of every so many ticks by both stacking methods, and report the largest difference of a
    /// variable and the times of both.
    #[arg(long, value_name = "TICKS", value_parser = clap::value_parser!(u64).range(1..), conflicts_with = "stacking")]
    compare_stacking: Option<u64>,
    /// A robot that follows velocities exactly and at once, in place of one under torques.
    #[arg(long)]
    kinematic: bool,
    /// Factor on the noise of the robot's own measurements: 0 is none.
    #[arg(
        long,
        value_name = "FACTOR",
        default_value_t = 1.0,
        value_parser = noise,
        allow_negative_numbers = true,
        conflicts_with = "kinematic"
    )]
    robot_noise: f64,
    /// The report's folder, made if it does not exist: follow.html, follow.svg, scene.svg, scene-moving.svg,
    /// ticks-on.csv and ticks-off.csv.
    #[arg(long, short, alias = "report", value_name = "FOLDER", default_value = "report")]
    output: PathBuf,
    /// Write no report.
    #[arg(long)]
    no_report: bool,
    #[command(flatten)]
    posture: PostureOptions,
    #[command(flatten)]
    printing: Printing,
}

fn noise(text: &str) -> std::result::Result<f64, String> {
    let factor = text.parse().ok().filter(|factor: &f64| factor.is_finite() && *factor >= 0.0);
    factor.ok_or_else(|| "give a finite factor of 0 or more".to_owned())
}

/// A callback for every tick of a run.
type Watch<'a> = &'a mut dyn FnMut(&TickRow, &Plant) -> Result<()>;

/// The comparison of the runs, with that of the stacking methods.
#[derive(Serialize)]
struct Line<'a> {
    #[serde(flatten)]
    comparison: &'a Comparison,
    #[serde(skip_serializing_if = "Option::is_none")]
    stacking: Option<Compared>,
}

/// A finished run, with the data of figure and page.
struct Played {
    summary: Summary,
    seen: Option<(RunLog, Replay)>,
}

impl Program for Options {
    fn run(self, session: &mut Session) -> Result<Ending> {
        if let Some(path) = &self.write_settings {
            return self.write_settings(path);
        }
        let folder = (!self.no_report).then_some(self.output.as_path());
        if let Some(folder) = folder {
            check_folder(folder)?;
        }
        // Settings are read before the work.
        self.settings()?;
        let (scenario, recorded) = self.load(session)?;
        if let Some(folder) = folder {
            fs::create_dir_all(folder)
                .with_context(|| format!("cannot make the folder {}", folder.display()))?;
        }
        #[cfg(feature = "mcap")]
        let mut log = self.mcap_log(&scenario)?;
        let play = |goal, title: &str, name, watch: Watch<'_>| {
            let table = folder.map(|folder| folder.join(format!("ticks-{name}.csv")));
            let played = play(session, &scenario, goal, title, table.as_deref(), recorded, watch);
            // Settings that a controller refuses are in the settings file, if there is one.
            match &self.settings {
                Some(path) => played.with_context(|| format!("with {}", path.display())),
                None => played,
            }
        };
        let title = |ergonomics: &str| {
            let separation = if scenario.has_separation() { "" } else { ", NO SEPARATION" };
            let paper = if self.paper { ", as in the paper" } else { "" };
            format!("Ergonomics {ergonomics}{paper}{separation}")
        };
        let mut stacking = StackingWatch::new(self.compare_stacking);
        let mut watch = |row: &TickRow, plant: &Plant| -> Result<()> {
            stacking.see(plant.controller().stack());
            #[cfg(feature = "mcap")]
            if let Some((log, _)) = &mut log {
                log.push(row)?;
            }
            #[cfg(not(feature = "mcap"))]
            let _ = row;
            Ok(())
        };
        let on = play(Goal::Ergonomics, &title("on"), "on", &mut watch)?;
        let off = if on.summary.is_complete {
            let mut watch = |_: &TickRow, plant: &Plant| -> Result<()> {
                stacking.see(plant.controller().stack());
                Ok(())
            };
            Some(play(Goal::LeastMotion, &title("off"), "off", &mut watch)?)
        } else {
            None
        };
        let seen = [Some(&on), off.as_ref()].into_iter().flatten().filter_map(|p| p.seen.as_ref());
        let (logs, replays): (Vec<&RunLog>, Vec<&Replay>) =
            seen.map(|(log, replay)| (log, replay)).unzip();
        let comparison = Comparison {
            separation: scenario.has_separation(),
            on: on.summary.clone(),
            off: off.as_ref().map(|off| off.summary.clone()),
        };
        let unsolved = comparison.unsolved(scenario.settings.period);
        let ending = match comparison.is_complete() {
            _ if unsolved => Ending::Failed,
            true => Ending::Complete,
            false => Ending::Partial,
        };
        // Files come before prints, so that a closed output loses nothing of the report.
        if let Some(folder) = folder
            && comparison.on.duration > 0.0
        {
            write_report(folder, (&logs, &replays), &comparison, [ending, recorded])?;
        }
        #[cfg(feature = "mcap")]
        if let Some((log, mut file)) = log {
            file.push(&log.finish()?)?;
            keep(file, [ending, recorded])?;
        }
        if ending == Ending::Partial {
            session.warn("interrupted: what follows is of the time up to there");
        }
        if unsolved {
            session.warn(
                "no control period of a run was solved: the robot only braked; check the settings",
            );
        }
        writeln!(session.output(), "{comparison}")?;
        let stacking = stacking.result();
        if let Some(stacking) = &stacking {
            writeln!(session.output(), "{stacking}")?;
        }
        if let Some(folder) = folder {
            writeln!(session.output(), "report: {}", folder.display())?;
        }
        let whole = [ending, recorded].iter().all(|part| *part != Ending::Partial);
        let marked = if whole { Ending::Complete } else { Ending::Partial };
        session.print_json(self.printing, &Line { comparison: &comparison, stacking }, marked)?;
        // A partial recording that was asked for is played in full.
        Ok(ending)
    }
}

impl Options {
    /// The scenario, and whether it is the whole recording.
    fn load(&self, session: &Session) -> Result<(Scenario, Ending)> {
        let Recording { header, percepts, others, timings, completeness } = match &self.recording {
            Some(path) => self.read(path)?,
            None => Recording::read(shipped::recording()?, IfPartial::Refuse)?,
        };
        let name = self.recording.as_deref().unwrap_or(Path::new("the recording")).display();
        let recorded = match completeness {
            Completeness::Complete => Ending::Complete,
            Completeness::Unmarked => {
                session.warn(format_args!(
                    "{name} is of version 1, which has no closing line: it may have been cut off"
                ));
                Ending::Complete
            }
            Completeness::Partial => {
                let frames = percepts.len();
                session.warn(format_args!("{name} is partial: {frames} whole camera frames"));
                Ending::Partial
            }
        };
        let (person, map) = self.person(session, &header)?;
        let mut scenario = Scenario::new(percepts, &person, map)?.among(others)?.arriving(&timings);
        scenario.posture = self.posture.settings()?;
        scenario.truth = match &self.truth {
            Some(path) => Some(TrueMotion::read(path)?),
            // The built-in recording shows the default person.
            None if self.recording.is_none() => {
                Walk::new(WalkerSettings::default(), Sight::default())?.motion
            }
            None => None,
        };
        let scenario = match self.settings()? {
            Some((path, file)) => with_settings(scenario, &file).context(path)?,
            None => scenario,
        };
        let mut scenario = if self.paper { scenario.as_in_paper() } else { scenario };
        scenario.settings.stacking = self.stacking.method();
        scenario.robot = scenario.robot.with_noise(self.robot_noise);
        let scenario = if self.no_separation { scenario.without_separation() } else { scenario };
        let scenario = if self.kinematic { scenario.kinematic() } else { scenario };
        Ok((scenario, recorded))
    }

    /// The MCAP file, if one is asked for, created before the work.
    #[cfg(feature = "mcap")]
    fn mcap_log(&self, scenario: &Scenario) -> Result<Option<(RobotLog, OutputFile)>> {
        let Some(path) = &self.mcap else { return Ok(None) };
        let file = OutputFile::create(path)?;
        let text = match &self.recording {
            Some(recording) => read_bytes(recording, LARGEST_RECORDING)
                .with_context(|| recording.display().to_string())?,
            None => shipped::bytes().to_vec(),
        };
        Ok(Some((RobotLog::new(&text, &scenario.model)?, file)))
    }

    /// The content of the settings file, and its name.
    fn settings(&self) -> Result<Option<(String, SettingsFile)>> {
        let Some(path) = &self.settings else { return Ok(None) };
        let name = path.display().to_string();
        let file = SettingsFile::read(path).context(name.clone())?;
        file.over(&RobotSettings::default()).context(name.clone())?;
        Ok(Some((name, file)))
    }

    fn write_settings(&self, path: &Path) -> Result<Ending> {
        let defaults = RobotSettings::default();
        let settings = match self.settings()? {
            Some((name, file)) => file.over(&defaults).context(name)?,
            None => defaults,
        };
        OutputFile::write_whole(path, settings.to_toml()?.as_bytes())?;
        Ok(Ending::Complete)
    }

    /// The person with the recorded stature, and their map.
    fn person(&self, session: &Session, header: &Header) -> Result<(Person, ErgonomicsMap)> {
        let stated = self.stature.or(header.stature);
        let Some(path) = &self.map else {
            let mut person = Person::new(stated.unwrap_or(DEFAULT_STATURE)).context("--stature")?;
            if self.stature.is_none()
                && let Some(stature) = header.stature
            {
                let segments = header.segments.of_stature(stature);
                person = person.with_segments(&segments).context("the recording's segments")?;
            }
            let map = build_map(session, &person, &MapOptions::default(), None)?;
            return Ok((person, map));
        };
        let map = read_map(path)?;
        let own = map.stature();
        if let Some(stated) = stated
            && (stated.is_nan() || (stated - own).abs() > SAME_STATURE)
        {
            let whose = if self.stature.is_some() { "--stature" } else { "the recording" };
            bail!(
                "{}: this map is of a person of {own} m, but {whose} says {stated} m: give that \
                 person's map, or --stature {own}",
                path.display()
            );
        }
        Ok((Person::new(own)?, map))
    }

    fn read(&self, path: &Path) -> Result<Recording> {
        let if_partial = if self.partial { IfPartial::Take } else { IfPartial::Refuse };
        let fail = |error: RecordingError| match error {
            RecordingError::Open { .. } => error.into(),
            error if error.is_early_end() && !self.partial => {
                anyhow!("{}: {error}; --partial plays the frames that are there", path.display())
            }
            error => anyhow::Error::from(error).context(path.display().to_string()),
        };
        let reader = percept_recording::open(path).map_err(fail)?;
        Recording::read(reader, if_partial).map_err(fail)
    }
}

/// Writes figure, page and pictures of runs.
fn write_report(
    folder: &Path,
    (logs, replays): (&[&RunLog], &[&Replay]),
    comparison: &Comparison,
    of: [Ending; 2],
) -> Result<()> {
    for (name, text) in [
        ("follow.svg", figure(logs)?),
        ("follow.html", page(TITLE, replays, &comparison.results("")?)?),
        ("scene.svg", still(replays)?),
        ("scene-moving.svg", animation(replays)?),
    ] {
        let mut file = OutputFile::create(folder.join(name))?;
        file.push(text.as_bytes())?;
        keep(file, of)?;
    }
    Ok(())
}

/// Keeps a file as partial unless all its runs are complete.
fn keep(file: OutputFile, of: [Ending; 2]) -> Result<()> {
    if of.contains(&Ending::Partial) {
        file.keep_partial()?;
    } else {
        file.keep()?;
    }
    Ok(())
}

/// Plays a run. Another thread writes its table, so that the loop only computes.
fn play(
    session: &Session,
    scenario: &Scenario,
    goal: Goal,
    title: &str,
    table: Option<&Path>,
    recorded: Ending,
    watch: Watch<'_>,
) -> Result<Played> {
    let run = Run::new(scenario, goal)?;
    // A tick takes a millisecond.
    let ticks = Duration::from_secs_f64(scenario.duration()).as_millis();
    let progress = session.progress(title, u64::try_from(ticks).unwrap_or(u64::MAX));
    let interrupt = session.interrupt();
    let Some(path) = table else {
        let summary = play_until(run, interrupt, &progress, watch)?;
        return Ok(Played { summary, seen: None });
    };
    let mut recorder = scenario.recorder(title, MOCA_URDF)?;
    let run = run.recorded_by(&mut recorder);
    let file = OutputFile::create(path)?;
    let (summary, log) = thread::scope(|scope| -> Result<_> {
        let (sender, receiver) = sync_channel::<Vec<TickRow>>(64);
        let writer = scope.spawn(move || write_ticks(file, title, &receiver));
        let mut batch = Vec::with_capacity(BATCH);
        let played = play_until(run, interrupt, &progress, |row, plant| {
            watch(row, plant)?;
            batch.push(row.clone());
            if batch.len() == BATCH {
                let full = std::mem::replace(&mut batch, Vec::with_capacity(BATCH));
                if sender.send(full).is_err() {
                    bail!("the table is not written on");
                }
            }
            Ok(())
        });
        // A failed writer reports its error when it is joined.
        let _ = sender.send(batch);
        drop(sender);
        let written = writer.join().map_err(|_| anyhow::anyhow!("the table's writer panicked"))?;
        let (file, log) = written?;
        let summary = played?;
        let ending = if summary.is_complete { Ending::Complete } else { Ending::Partial };
        keep(file, [ending, recorded])?;
        Ok((summary, log))
    })?;
    Ok(Played { summary, seen: Some((log, recorder.finish())) })
}

/// Plays a run to its end, to an interrupt or until `each` fails, and updates the progress.
fn play_until(
    run: Run<'_>,
    interrupt: &Interrupt,
    progress: &Progress,
    mut each: impl FnMut(&TickRow, &Plant) -> Result<()>,
) -> Result<Summary> {
    let (mut ticks, mut failure) = (0_u64, None);
    let summary = run.play(|row, plant| {
        ticks += 1;
        if ticks.is_multiple_of(1000) {
            progress.set(ticks);
        }
        match each(row, plant) {
            Ok(()) => interrupt.flow(),
            Err(error) => {
                failure = Some(error);
                ControlFlow::Break(())
            }
        }
    })?;
    failure.map_or(Ok(summary), Err)
}

fn write_ticks(
    file: OutputFile,
    title: &str,
    receiver: &Receiver<Vec<TickRow>>,
) -> Result<(OutputFile, RunLog)> {
    let mut table = TickTable::new(file, &MOCA_COLUMNS)?;
    let mut log = RunLog::new(title);
    for batch in receiver {
        for row in &batch {
            table.write(row)?;
            log.push(row);
        }
    }
    Ok((table.finish()?, log))
}

fn main() -> ExitCode {
    program::main::<Options>()
}
