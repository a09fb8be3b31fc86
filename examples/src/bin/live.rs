//! MOCA in real time, led and watched on a page in a browser.

use std::fmt;
use std::io::Write;
use std::path::PathBuf;
use std::process::{Command, ExitCode, Stdio};
use std::sync::Arc;
use std::thread;

use anyhow::{Context, Result, anyhow, ensure};
use clap::Parser;
use ergo_map::{MapOptions, Person};
use examples::maps::{build_map, read_map};
use examples::program::{self, Ending, Interrupt, Printing, Program, RealTime, Session};
use examples::settings::{RobotSettings, SettingsFile};
use moca_drivers::DriveReport;
use moca_live::whole_body::control_loop::{
    Clock, ControlLoop, JointMeasurement, LoopSettings, MonotonicClock,
};
use moca_live::{Desk, Law, Server, SettingsText};
use moca_simulation::plant::PlantSettings;
use moca_simulation::workcell::{Setup, Workcell};
use serde::Serialize;

/// Distance between nodes of the person's map (m).
const MAP_SPACING: f64 = 0.08;

/// Moves MOCA in real time, at 1 kHz, beside a simulated person whom you lead on a page in a browser.
///
/// Prints the address of the page, which only this machine can open. On it you drag the person about, bend them, give
/// them tools, switch faults on and off, and see what the controller thinks. The loop ends at Ctrl-C, or after the
/// duration, in order: the robot brakes and halts at rest.
#[derive(Debug, Parser)]
#[command(version)]
struct Options {
    /// Open the page in the system's browser.
    #[arg(long)]
    open: bool,
    /// Serve the page on this port, in place of any that is free.
    #[arg(long, default_value_t = 0)]
    port: u16,
    /// Duration (s); until Ctrl-C by default.
    #[arg(long, value_name = "SECONDS")]
    duration: Option<f64>,
    /// The person's stature in metres.
    #[arg(long, value_name = "METRES", default_value_t = 1.75, conflicts_with = "map")]
    stature: f64,
    /// The person's ergonomics map, as `ergo_map` saves it, in place of one that is built.
    #[arg(long, value_name = "FILE")]
    map: Option<PathBuf>,
    /// Take these settings in place of the defaults, as `follow` does.
    #[arg(long, value_name = "FILE")]
    settings: Option<PathBuf>,
    #[command(flatten)]
    real_time: RealTime,
    #[command(flatten)]
    printing: Printing,
}

/// Figures of the loop, and counts of the last workcell's judges.
#[derive(Debug, Serialize)]
struct Report {
    #[serde(flatten)]
    drive: DriveReport,
    limit_violations: u64,
    separation_violations: u64,
    solver_failures: u64,
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}", self.drive)?;
        for (what, count) in [
            ("ticks with a violated limit", self.limit_violations),
            ("ticks too near to a person", self.separation_violations),
        ] {
            writeln!(f, "{what:30} {count:>10}")?;
        }
        write!(f, "{:30} {:>10}", "ticks not solved", self.solver_failures)
    }
}

impl Program for Options {
    fn run(self, session: &mut Session) -> Result<Ending> {
        if let Some(duration) = self.duration {
            ensure!(duration > 0.0, "--duration {duration}: give seconds above 0");
        }
        let setup = self.setup(session)?;
        let mut cell = Workcell::new(setup)?;
        cell.welcome()?;
        let (law, desk) = Law::new(cell, settings_text())?;
        let server = Server::bind(self.port, Arc::clone(&desk))?;
        let address = server.address();
        writeln!(session.output(), "{address}  (Ctrl-C ends it)")?;
        session.output().flush()?;
        if self.open && !open(&address) {
            session.warn(format_args!("no browser was found; open {address}"));
        }
        let report = self.drive(law, &server, &desk, session.interrupt())?;
        writeln!(session.output(), "{report}")?;
        session.conclude(self.printing, &report, Ending::Complete)
    }
}

impl Options {
    fn setup(&self, session: &Session) -> Result<Setup> {
        // A page is waited for: a quarter of the nodes take a quarter of the time.
        let options = MapOptions { spacing: MAP_SPACING, ..MapOptions::default() };
        let map = match &self.map {
            Some(path) => read_map(path)?,
            None => build_map(session, &Person::new(self.stature)?, &options, None)?,
        };
        let mut setup = Setup::new(map)?;
        if let Some(path) = &self.settings {
            let shown = || path.display().to_string();
            let file = SettingsFile::read(path).with_context(shown)?;
            setup.robot = over(&file, &setup.robot).with_context(shown)?;
        }
        Ok(setup)
    }

    /// Moves the robot from a thread of its own; this one serves pages until the loop has ended.
    fn drive(
        &self,
        mut law: Law,
        server: &Server,
        desk: &Desk,
        interrupt: &Interrupt,
    ) -> Result<Report> {
        let model = law.cell().plant().controller().robot().model().clone();
        let times = LoopSettings { period: law.cell().period(), ..LoopSettings::default() };
        let mut control = ControlLoop::new(times, JointMeasurement::at_rest(&model))?;
        let mut clock = MonotonicClock::default();
        let (watch, duration) = (clock, self.duration.unwrap_or(f64::INFINITY));
        let ending = thread::scope(|scope| {
            let looping = scope.spawn(|| {
                // A browser that draws by the processor else makes some ticks late.
                let applied = self.real_time.apply().map_err(|error| anyhow!(error));
                let ending = applied.and_then(|()| {
                    let begun = watch.now();
                    let stop = || interrupt.requested() || watch.now() - begun > duration;
                    control
                        .run(&mut moca_live::Within, &mut law, &mut clock, stop)
                        .map_err(|error| anyhow!("{error}"))
                });
                desk.end();
                ending
            });
            server.serve();
            looping.join().map_err(|_| anyhow!("the loop panicked"))?
        })?;
        let counts = law.cell().counts();
        Ok(Report {
            drive: DriveReport::new(ending, control.statistics(), law.faults(), None),
            limit_violations: counts.limits,
            separation_violations: counts.too_near,
            solver_failures: counts.unsolved,
        })
    }
}

/// The settings with what a file says in place of its own.
fn over(file: &SettingsFile, settings: &PlantSettings) -> Result<PlantSettings> {
    Ok(file.over(&RobotSettings::from(settings))?.of_plant(settings.drive))
}

/// Settings for the page, as `follow --settings` reads them.
fn settings_text() -> SettingsText {
    SettingsText {
        write: |settings| {
            RobotSettings::from(settings).to_toml().map_err(|error| error.to_string())
        },
        read: |text, settings| {
            let file = SettingsFile::parse(text).map_err(|error| error.to_string())?;
            over(&file, settings).map_err(|error| format!("{error:#}"))
        },
    }
}

/// Opens an address in the system's browser; returns false if there is none.
fn open(address: &str) -> bool {
    let mut openers = ["xdg-open", "open"].into_iter();
    openers.any(|opener| {
        let mut command = Command::new(opener);
        command.arg(address).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
        command.spawn().is_ok()
    })
}

fn main() -> ExitCode {
    program::main::<Options>()
}
