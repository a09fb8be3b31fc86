//! Moves MOCA at 1 kHz, simulated in the same process, or behind UDP or ROS 2.

use std::fmt;
use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;

use anyhow::{Context, Result, anyhow, ensure};
use clap::Parser;
use ergo_map::{MapOptions, Person};
use examples::drive::{
    Attendant, DrivenRobot, ObjectOption, Records, RobotAdds, acknowledge_by_keys, alone, recorded,
    watch_percepts,
};
#[cfg(feature = "ros2")]
use examples::drive::{FollowedBy, beneath, seen_by_others, serve_on_ros2};
use examples::maps::{build_map, read_map};
use examples::program::{self, Ending, Printing, Program, RealTime, Session};
use examples::settings::{RobotSettings, SettingsFile};
use examples::shipped;
#[cfg(feature = "ros2")]
use moca_drivers::TopicNames;
#[cfg(feature = "ros2")]
use moca_drivers::ros2::{Ros2Report, Ros2Side, RosDomain};
use moca_drivers::{
    AnnouncedLaw, DriveReport, LinkReport, LockstepSide, SharedKey, UdpServer, UdpSide,
};
use moca_model::whole_body::control_loop::{
    Clock, ControlLoop, JointMeasurement, LoopSettings, ManualClock, MonotonicClock, RobotSide,
    StopCause,
};
use moca_model::{AnswerDelay, Controller, LoopController, TorqueController};
use moca_simulation::run::Scenario;
use percept_recording::{self, IfPartial, Recording};
use serde::Serialize;

/// Stature of a person whose recording gives none \[m\].
const DEFAULT_STATURE: f64 = 1.75;
/// Distance between nodes of the map where nobody comes, in statures.
const COARSE: f64 = 0.1;
/// Moves MOCA, or the robot of `--settings`, in real time at 1 kHz beside a recorded person. Prints how well the
/// deadlines were kept.
///
/// The robot is simulated, in this process or behind UDP. `drive --serve` is such a robot, and shows what a driver of a
/// real one has to do. If built with the feature `ros2`, `--ros2` moves a robot on the ROS 2 graph and sees the person
/// there. `--ros2 --serve` is such a robot.
///
/// The loop ends after the duration, at Ctrl-C, or when robot or perception are silent. It always brakes, and halts the
/// robot at rest. The exit status is 1 if the robot fell silent.
#[derive(Debug, Parser)]
#[command(version)]
#[cfg_attr(
    feature = "ros2",
    expect(clippy::struct_excessive_bools, reason = "each is a switch of the command line")
)]
struct Options {
    /// Move the robot at this address, in place of one in this process.
    #[arg(long, value_name = "HOST:PORT")]
    robot: Option<String>,
    /// Be the simulated robot at this address until Ctrl-C; with `--ros2` on the ROS 2 graph, without an address.
    #[arg(long, value_name = "HOST:PORT", conflicts_with = "robot")]
    #[expect(clippy::option_option, reason = "an option whose value may be left out")]
    serve: Option<Option<String>>,
    /// Take each packet of the robot as one period, whatever its time, for robots in simulators. Runs are then
    /// reproducible. `--serve` is such a robot.
    #[arg(long)]
    lockstep: bool,
    /// Only take packets from senders with the key in this file, for `--robot` and `--serve`: 32 bytes or more, the
    /// same at both ends.
    #[arg(long, value_name = "FILE")]
    key: Option<PathBuf>,
    /// Move the robot on the ROS 2 graph of `ROS_DOMAIN_ID`, and see the person there.
    #[cfg(feature = "ros2")]
    #[arg(long, conflicts_with = "robot")]
    ros2: bool,
    /// The command that the arm on the ROS 2 graph follows.
    #[cfg(feature = "ros2")]
    #[arg(long, value_name = "KIND", value_enum, default_value_t, requires = "ros2")]
    interface: FollowedBy,
    /// Torques that the robot adds by itself. Robots under torques that are not simulated here have no default.
    #[arg(long, value_name = "WHAT", value_enum)]
    compensation: Option<RobotAdds>,
    /// Duration in seconds.
    #[arg(long, value_name = "SECONDS", default_value_t = 60.0)]
    duration: f64,
    /// Play this recording in a loop, in place of the built-in one.
    #[arg(long, value_name = "FILE")]
    recording: Option<PathBuf>,
    /// See the percepts that `perceive --live` writes into this pipe, in place of a recording.
    #[arg(long, value_name = "PIPE", conflicts_with_all = ["recording", "lockstep", "serve", "circle"])]
    percepts: Option<PathBuf>,
    /// The person's ergonomics map, as `ergo_map` saves it, in place of one that is built.
    #[arg(long, value_name = "FILE")]
    map: Option<PathBuf>,
    /// Take these settings in place of the defaults, as `follow` does.
    #[arg(long, value_name = "FILE")]
    settings: Option<PathBuf>,
    /// The object for the robot's gripper, which is left alone without this.
    #[arg(long, value_name = "WHAT", value_enum)]
    object: Option<ObjectOption>,
    /// Move the tool around a small circle, as the first motion of a robot. There is no camera, so nobody may be near.
    #[arg(long, conflicts_with_all = ["recording", "object", "serve"])]
    circle: bool,
    /// Write what the loop sees and does into this folder: recording.jsonl, which `follow` plays, ticks.csv and drive.svg, and drive.mcap if built with the feature `mcap`.
    #[arg(long, short, value_name = "FOLDER")]
    output: Option<PathBuf>,
    /// Acknowledge a stop with Enter, so that the robot goes on. It stands for good otherwise.
    #[arg(long)]
    keys: bool,
    #[command(flatten)]
    real_time: RealTime,
    /// Time before each tick in which the loop waits without sleeping, in microseconds, at most a second.
    #[arg(long, value_name = "MICROSECONDS", default_value_t = 0.0, value_parser = spin, allow_negative_numbers = true)]
    spin: f64,
    #[command(flatten)]
    printing: Printing,
}

fn spin(text: &str) -> std::result::Result<f64, &'static str> {
    let number = text.parse().ok().filter(|number| (0.0..=1e6).contains(number));
    number.ok_or("give 0 to 1000000 microseconds")
}

/// Options for a robot over UDP.
#[derive(Debug, Serialize)]
struct OverUdp {
    #[serde(flatten)]
    report: DriveReport,
    link: LinkReport,
}

/// Options for a robot on the ROS 2 graph.
#[cfg(feature = "ros2")]
#[derive(Debug, Serialize)]
struct OnRos2 {
    #[serde(flatten)]
    report: DriveReport,
    ros2: Ros2Report,
}

impl Program for Options {
    fn run(self, session: &mut Session) -> Result<Ending> {
        let duration = self.duration;
        ensure!(duration > 0.0, "--duration {duration}: give the seconds to drive, above 0");
        let key = self.key()?;
        ensure!(
            !self.lockstep || self.robot.is_some() || matches!(self.serve, Some(Some(_))),
            "--lockstep: only packets are a clock; give --robot or --serve as well"
        );
        if let (Some(address), false) = (&self.serve, self.is_on_ros2()) {
            return self.serve(session, address.as_deref(), key.as_ref());
        }
        let mut scenario = self.scenario(session)?;
        self.compensate(&mut scenario)?;
        let clock = MonotonicClock::new(1e-6 * self.spin);
        #[cfg(feature = "ros2")]
        if self.ros2 {
            return self.on_ros2(session, &scenario, clock);
        }
        let camera = |attendant: &mut Attendant<'_>, ended: &AtomicBool, clock| {
            let Some(pipe) = &self.percepts else { return recorded(attendant, ended, clock) };
            if let Err(error) = watch_percepts(pipe, attendant, ended, clock) {
                program::warn(format_args!("{error:#}"));
            }
        };
        if let Some(address) = &self.robot {
            let mut robot = UdpSide::connect(address, scenario.start.len(), key.as_ref())
                .with_context(|| format!("--robot {address}"))?;
            let (driven, link) = if self.lockstep {
                let mut robot = LockstepSide::new(robot)?;
                let driven = self.drive_in_lockstep(session, &scenario, &mut robot);
                (driven, LinkReport::from(robot.statistics()))
            } else {
                let driven = self.drive(session, &scenario, &mut robot, clock, camera);
                (driven, LinkReport::from(robot.statistics()))
            };
            let report = driven.inspect_err(|_| session.warn(&link))?;
            let (cause, report) = (report.cause, OverUdp { report, link });
            writeln!(session.output(), "{}\n{}", report.report, report.link)?;
            return session.conclude(self.printing, &report, ended(session, cause));
        }
        let mut robot = DrivenRobot::from(&scenario).simulated()?;
        let report = self.drive(session, &scenario, &mut robot, clock, camera)?;
        writeln!(session.output(), "{report}")?;
        session.conclude(self.printing, &report, ended(session, report.cause))
    }
}

impl Options {
    /// Runs the simulated robot until Ctrl-C.
    fn serve(
        &self,
        session: &mut Session,
        address: Option<&str>,
        key: Option<&SharedKey>,
    ) -> Result<Ending> {
        let address = address.context("--serve: give an address, HOST:PORT")?;
        let robot = self.robot(RobotSettings::default())?;
        let period = robot.settings.controller.period;
        if !self.lockstep {
            self.real_time.apply()?;
        }
        let mut server = UdpServer::bind(address, robot.simulated()?, &robot.start, key)
            .with_context(|| format!("--serve {address}"))?;
        writeln!(session.output(), "a robot at {}; Ctrl-C ends it", server.address()?)?;
        session.output().flush()?;
        let interrupt = session.interrupt().clone();
        if self.lockstep {
            server.serve_in_lockstep(|| interrupt.requested())?;
        } else {
            let mut clock = MonotonicClock::new(1e-6 * self.spin);
            server.serve(period, &mut clock, || interrupt.requested())?;
        }
        writeln!(session.output(), "{}", LinkReport::from(server.statistics()))?;
        Ok(Ending::Complete)
    }

    /// The settings file, if there is one, with its content.
    fn settings(&self) -> Result<Option<(&PathBuf, SettingsFile)>> {
        let Some(path) = &self.settings else { return Ok(None) };
        let file = SettingsFile::read(path).with_context(|| path.display().to_string())?;
        Ok(Some((path, file)))
    }

    /// The robot of the settings file, or MOCA, with these settings where the file has none.
    fn robot(&self, base: RobotSettings) -> Result<DrivenRobot> {
        let settings = self.settings()?;
        DrivenRobot::read(base, settings.as_ref().map(|(path, file)| (path.as_path(), file)))
    }

    /// Sets the compensation of the robot, which must be stated for a robot that is not simulated here.
    fn compensate(&self, scenario: &mut Scenario) -> Result<()> {
        #[cfg(feature = "ros2")]
        let takes_torques = self.interface == FollowedBy::Effort;
        #[cfg(not(feature = "ros2"))]
        let takes_torques = true;
        if !takes_torques {
            // No joint responds to torques.
            scenario.torques.delay = AnswerDelay::Known(0.0);
        }
        match self.compensation {
            Some(adds) => scenario.torques.compensation = adds.into(),
            None => ensure!(
                self.serve.is_some() || !self.is_elsewhere() || !takes_torques,
                "--compensation: say what the robot adds to the torques that it is sent: `nothing`, as plain motors \
                 and the simulated robot do, or `franka` for gravity and friction; gravity that both add drives the \
                 arm up"
            ),
        }
        Ok(())
    }

    /// True if the robot is not simulated in this process.
    fn is_elsewhere(&self) -> bool {
        self.is_on_ros2() || self.robot.is_some()
    }

    #[cfg(feature = "ros2")]
    fn is_on_ros2(&self) -> bool {
        self.ros2
    }

    #[cfg(not(feature = "ros2"))]
    #[expect(clippy::unused_self, reason = "with the feature, it is asked")]
    fn is_on_ros2(&self) -> bool {
        false
    }

    /// The key of the packets, if they have one.
    fn key(&self) -> Result<Option<SharedKey>> {
        let Some(path) = &self.key else { return Ok(None) };
        ensure!(
            self.robot.is_some() || matches!(self.serve, Some(Some(_))),
            "--key: only packets to and from a robot at HOST:PORT have one; give --robot or --serve as well"
        );
        let key = SharedKey::read(path).with_context(|| format!("--key {}", path.display()))?;
        Ok(Some(key))
    }

    /// The scenario that `follow` plays, for real time.
    fn scenario(&self, session: &Session) -> Result<Scenario> {
        // Settings are read before the work.
        self.robot(RobotSettings::default())?;
        let Recording { header, percepts, others, .. } = match &self.recording {
            Some(path) => Recording::read(percept_recording::open(path)?, IfPartial::Refuse)
                .with_context(|| path.display().to_string())?,
            None => Recording::read(shipped::recording()?, IfPartial::Refuse)?,
        };
        let (person, map) = if let Some(path) = &self.map {
            let map = read_map(path)?;
            (Person::new(map.stature())?, map)
        } else {
            let person = Person::new(header.stature.unwrap_or(DEFAULT_STATURE))?;
            // Nobody comes to the circle, so the map need not be fine.
            let spacing = if self.circle { COARSE } else { MapOptions::default().spacing };
            let options = MapOptions { spacing, ..MapOptions::default() };
            let map = build_map(session, &person, &options, None)?;
            (person, map)
        };
        let scenario = Scenario::new(percepts, &person, map)?.among(others)?;
        let base = DrivenRobot::from(&scenario).settings;
        let scenario = self.robot(base)?.in_scenario(scenario);
        Ok(match self.object {
            Some(object) => object.in_scenario(scenario),
            None if self.circle => alone(scenario),
            None => scenario,
        })
    }

    /// Runs on the ROS 2 graph.
    #[cfg(feature = "ros2")]
    fn on_ros2(
        &self,
        session: &mut Session,
        scenario: &Scenario,
        mut clock: MonotonicClock,
    ) -> Result<Ending> {
        let topics = match self.settings()? {
            Some((_, file)) => file.unchecked_over(&RobotSettings::default())?.topics,
            None => TopicNames::default(),
        };
        if let Some(address) = &self.serve {
            ensure!(address.is_none(), "--ros2 --serve: give no address");
            serve_on_ros2(session, scenario, &topics, (&mut clock, self.real_time.scheduling()))?;
            return Ok(Ending::Complete);
        }
        let (domain, joints) =
            (RosDomain::of_environment()?, DrivenRobot::from(scenario).ros2_joints()?);
        let joined = beneath(self.real_time.scheduling(), || {
            Ros2Side::join(domain, &topics, joints, self.interface.into())
        })?;
        let (mut robot, people) = joined?;
        let driven = self.drive(session, scenario, &mut robot, clock, |attendant, ended, clock| {
            seen_by_others(&people, attendant, ended, clock);
        });
        let messages = Ros2Report::from(&robot.close()?);
        let report = driven.inspect_err(|_| session.warn(&messages))?;
        let (cause, report) = (report.cause, OnRos2 { report, ros2: messages });
        writeln!(session.output(), "{}\n{}", report.report, report.ros2)?;
        session.conclude(self.printing, &report, ended(session, cause))
    }

    /// Moves the robot from its own thread. This thread is the camera until the loop has ended.
    fn drive<R>(
        &self,
        session: &Session,
        scenario: &Scenario,
        robot: &mut R,
        mut clock: MonotonicClock,
        camera: impl FnOnce(&mut Attendant<'_>, &AtomicBool, MonotonicClock),
    ) -> Result<DriveReport>
    where
        R: RobotSide + Send,
        R::Error: fmt::Display + Send,
    {
        let (mut law, mut attendant) = self.begin(session, scenario)?;
        let mut control = of_settings(self.settings.as_ref(), control_loop(scenario))?;
        let (interrupt, ended) = (session.interrupt().clone(), AtomicBool::new(false));
        let watch = clock;
        let ending = thread::scope(|scope| {
            let looping = scope.spawn(|| {
                let applied = self.real_time.apply().map_err(|error| anyhow!(error));
                let ending = applied.and_then(|()| {
                    // The condition is asked once a tick; the time counts from the first one.
                    let mut begun = None;
                    let stop = || {
                        let now = watch.now();
                        let driven = now - *begun.get_or_insert(now);
                        interrupt.requested() || driven > self.duration
                    };
                    control
                        .run(robot, &mut law, &mut clock, stop)
                        .map_err(|error| anyhow!("{error}"))
                });
                ended.store(true, Ordering::Release);
                ending
            });
            camera(&mut attendant, &ended, watch);
            looping.join().map_err(|_| anyhow!("the loop panicked"))?
        });
        let book = attendant.finish();
        Ok(DriveReport::new(ending?, control.statistics(), law.faults(), Some(book?)))
    }

    /// Moves the robot and plays its camera as its packets come.
    fn drive_in_lockstep(
        &self,
        session: &Session,
        scenario: &Scenario,
        robot: &mut LockstepSide,
    ) -> Result<DriveReport> {
        let (mut law, mut attendant) = self.begin(session, scenario)?;
        let mut control = of_settings(self.settings.as_ref(), control_loop(scenario))?;
        let mut clock = ManualClock::default();
        let mut camera = attendant.camera();
        let watch = clock.clone();
        let stop = || {
            attendant.attend();
            camera.show(watch.now(), |frame| attendant.show(frame));
            session.interrupt().requested() || watch.now() > self.duration
        };
        let ending = control.run(robot, &mut law, &mut clock, stop);
        let book = attendant.finish();
        let ending = ending.map_err(|error| anyhow!("{error}"))?;
        Ok(DriveReport::new(ending, control.statistics(), law.faults(), Some(book?)))
    }

    /// The law of the loop, and its attendant.
    fn begin<'a>(
        &self,
        session: &'a Session,
        scenario: &'a Scenario,
    ) -> Result<(AnnouncedLaw<impl FnMut(&str) + use<'a>>, Attendant<'a>)> {
        let Scenario { model, ergonomics, settings, torques, start, .. } = scenario;
        let made = Controller::new(model.clone(), *ergonomics, settings.clone(), start)
            .and_then(|controller| TorqueController::new(controller, torques.clone()))
            .map_err(anyhow::Error::from);
        let (mut law, frames) = LoopController::new(of_settings(self.settings.as_ref(), made)?);
        if self.object.is_some() {
            law = ObjectOption::taken_by(law, scenario)?;
        }
        let (law, ticks) = AnnouncedLaw::new(law, |text: &str| session.warn(text));
        let law = if self.circle { law.circling() } else { law };
        if self.keys {
            acknowledge_by_keys(session, law.acknowledgement())?;
        }
        let records = self.output.as_deref();
        let records = records.map(|folder| Records::create(folder, scenario));
        let ends = (ticks, frames, law.acknowledgement());
        Ok((law, Attendant::new(session, scenario, ends, records.transpose()?)))
    }
}

/// Adds the name of the settings file, if there is one, to errors of the controller.
fn of_settings<T>(settings: Option<&PathBuf>, result: Result<T>) -> Result<T> {
    match settings {
        Some(path) => result.with_context(|| format!("with {}", path.display())),
        None => result,
    }
}

fn control_loop(scenario: &Scenario) -> Result<ControlLoop> {
    let period = scenario.settings.period;
    let times = LoopSettings { period, ..LoopSettings::default() };
    Ok(ControlLoop::new(times, JointMeasurement::at_rest(&scenario.model))?)
}

/// The ending of a program whose loop ends by this cause.
fn ended(session: &Session, cause: StopCause) -> Ending {
    match cause {
        StopCause::Requested if session.interrupt().requested() => Ending::Partial,
        StopCause::Requested => Ending::Complete,
        _ => Ending::Failed,
    }
}

fn main() -> ExitCode {
    program::main::<Options>()
}
