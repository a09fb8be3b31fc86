//! The loop.

use super::clock::Clock;
use super::deadlines::DeadlineStatistics;
use super::law::ControlLaw;
use super::robot_side::{JointCommand, JointMeasurement, Received, RobotSide};
use super::settings::LoopSettings;
use crate::error::Error;

/// Why a loop stopped.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum StopCause {
    /// It was asked to.
    Requested,
    /// The robot measured nothing for too long.
    RobotSilent,
    /// Nothing was perceived for too long.
    PerceptionSilent,
}

/// How a loop ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LoopEnding {
    /// Why it stopped.
    pub cause: StopCause,
    /// Whether the robot was to be at rest when it was halted; else the time to stop within had passed.
    pub at_rest: bool,
}

/// Why a loop broke off.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LoopError<R, L> {
    /// The robot cannot be reached.
    #[error("the robot: {0}")]
    Robot(R),
    /// The control law refused what it was given.
    #[error("the control law: {0}")]
    Law(L),
    /// The robot has measured nothing since the loop began.
    #[error("the robot has measured nothing for {waited} s; check that it is on and connected")]
    NoMeasurement {
        /// How long the loop waited \[s\].
        waited: f64,
    },
}

/// A loop of a fixed period between a robot and a control law.
///
/// Ticks are due at multiples of the period. A tick that has not begun when the next is due is missed: it
/// is counted and left out, so that no two ticks run in one period. The loop ends when it is asked to, or
/// when robot or perception are silent for too long; it then asks the law to stop, goes on until the law is at
/// rest, and halts the robot. After construction it allocates nothing.
///
/// ```
/// # use std::convert::Infallible;
/// use whole_body::{
///     ControlLaw, ControlLoop, JointCommand, JointMeasurement, LoopSettings, ManualClock, Received, RobotSide,
///     StopCause,
/// };
///
/// /// A robot of one joint that moves as it is told.
/// struct Wheel(f64);
///
/// impl RobotSide for Wheel {
///     type Error = Infallible;
///     fn receive(&mut self, measured: &mut JointMeasurement) -> Result<Received, Infallible> {
///         measured.position[0] = self.0;
///         Ok(Received::Fresh)
///     }
///     fn send(&mut self, command: &JointCommand) -> Result<(), Infallible> {
///         self.0 += 1e-3 * command.velocity[0];
///         Ok(())
///     }
///     fn halt(&mut self) -> Result<(), Infallible> {
///         Ok(())
///     }
/// }
///
/// /// Turns at 1 rad/s.
/// struct Turn(f64);
///
/// impl ControlLaw for Turn {
///     type Error = Infallible;
///     fn step(
///         &mut self,
///         _now: f64,
///         _measured: &JointMeasurement,
///         command: &mut JointCommand,
///     ) -> Result<(), Infallible> {
///         command.velocity[0] = self.0;
///         Ok(())
///     }
///     fn perception_age(&self) -> Option<f64> {
///         None
///     }
///     fn request_stop(&mut self) {
///         self.0 = 0.0;
///     }
///     fn is_at_rest(&self) -> bool {
///         self.0 == 0.0
///     }
/// }
///
/// let (mut wheel, mut turn) = (Wheel(0.0), Turn(1.0));
/// let measured = JointMeasurement::resting(vec![0.0], 1);
/// let mut control = ControlLoop::new(LoopSettings::default(), measured)?;
/// let mut ticks = 0;
/// let ending = control.run(&mut wheel, &mut turn, &mut ManualClock::default(), || {
///     ticks += 1;
///     ticks > 500
/// })?;
/// assert_eq!(ending.cause, StopCause::Requested);
/// assert!((wheel.0 - 0.5).abs() < 1e-9);
/// assert_eq!(control.statistics().missed, 0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct ControlLoop {
    settings: LoopSettings,
    measured: JointMeasurement,
    command: JointCommand,
    statistics: DeadlineStatistics,
}

/// What a loop remembers from tick to tick.
struct Progress {
    /// When it began, and when the last measurement came \[s\].
    begun: f64,
    fresh: f64,
    /// Why and when it began to stop \[s\].
    stopping: Option<(StopCause, f64)>,
}

impl ControlLoop {
    /// For measurements of the shape of `measured`.
    ///
    /// # Errors
    /// [`Error::Parameter`] for settings out of range.
    pub fn new(settings: LoopSettings, measured: JointMeasurement) -> Result<Self, Error> {
        settings.validate()?;
        let command = JointCommand::at_rest(&measured);
        Ok(Self { settings, measured, command, statistics: DeadlineStatistics::new() })
    }

    /// How well the deadlines were kept so far.
    pub fn statistics(&self) -> &DeadlineStatistics {
        &self.statistics
    }

    /// What was measured last.
    pub fn measured(&self) -> &JointMeasurement {
        &self.measured
    }

    /// What was sent last.
    pub fn command(&self) -> &JointCommand {
        &self.command
    }

    /// Runs until `stop`, which is asked once a tick, returns true, or until the robot or the perception are
    /// silent. Nothing is sent before the first measurement. However it ends, the robot is halted.
    ///
    /// # Errors
    /// [`LoopError`]; the robot was then halted as it moved.
    pub fn run<R: RobotSide, L: ControlLaw>(
        &mut self,
        robot: &mut R,
        law: &mut L,
        clock: &mut impl Clock,
        mut stop: impl FnMut() -> bool,
    ) -> Result<LoopEnding, LoopError<R::Error, L::Error>> {
        let ended = self.ticks(robot, law, clock, &mut stop);
        let halted = robot.halt().map_err(LoopError::Robot);
        ended.and_then(|ending| halted.map(|()| ending))
    }

    fn ticks<R: RobotSide, L: ControlLaw>(
        &mut self,
        robot: &mut R,
        law: &mut L,
        clock: &mut impl Clock,
        stop: &mut impl FnMut() -> bool,
    ) -> Result<LoopEnding, LoopError<R::Error, L::Error>> {
        let begun = match self.wait(robot, clock, stop).map_err(LoopError::Robot)? {
            First::At(time) => time,
            First::StopRequested => {
                return Ok(LoopEnding { cause: StopCause::Requested, at_rest: true });
            }
            First::Never(waited) => return Err(LoopError::NoMeasurement { waited }),
        };
        law.begin(&self.measured).map_err(LoopError::Law)?;
        let mut progress = Progress { begun, fresh: begun, stopping: None };
        let mut tick = 0_u64;
        loop {
            tick += self.pace(begun, tick, clock);
            let now = clock.now();
            match robot.receive(&mut self.measured).map_err(LoopError::Robot)? {
                Received::Fresh => progress.fresh = now,
                Received::Nothing => self.statistics.unmeasured += 1,
            }
            self.measured.age = now - progress.fresh;
            if progress.stopping.is_none()
                && let Some(cause) = self.reason_to_stop(&progress, now, law, stop)
            {
                law.request_stop();
                progress.stopping = Some((cause, now));
            }
            law.step(now, &self.measured, &mut self.command).map_err(LoopError::Law)?;
            robot.send(&self.command).map_err(LoopError::Robot)?;
            self.statistics.duration.push(clock.now() - now);
            self.statistics.ticks += 1;
            if let Some((cause, since)) = progress.stopping {
                let at_rest = law.is_at_rest();
                if at_rest || now - since > self.settings.stop_within {
                    return Ok(LoopEnding { cause, at_rest });
                }
            }
            tick += 1;
        }
    }

    /// Waits for the first measurement.
    fn wait<R: RobotSide>(
        &mut self,
        robot: &mut R,
        clock: &mut impl Clock,
        stop: &mut impl FnMut() -> bool,
    ) -> Result<First, R::Error> {
        let from = clock.now();
        loop {
            let now = clock.now();
            if robot.receive(&mut self.measured)? == Received::Fresh {
                return Ok(First::At(now));
            }
            if stop() {
                return Ok(First::StopRequested);
            }
            if now - from > self.settings.first_measurement {
                return Ok(First::Never(now - from));
            }
            clock.sleep_until(now + self.settings.period);
        }
    }

    /// Waits until the tick is due; returns how many ticks are missed by then.
    fn pace(&mut self, begun: f64, tick: u64, clock: &mut impl Clock) -> u64 {
        let period = self.settings.period;
        let due = begun + tick as f64 * period;
        clock.sleep_until(due);
        let late = clock.now() - due;
        // A number that is not negative, and far below 2^53.
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "as above")]
        let missed = (late / period).floor().max(0.0) as u64;
        self.statistics.latency.push(late);
        self.statistics.missed += missed;
        missed
    }

    fn reason_to_stop<L: ControlLaw>(
        &self,
        progress: &Progress,
        now: f64,
        law: &L,
        stop: &mut impl FnMut() -> bool,
    ) -> Option<StopCause> {
        // What was never perceived is as old as the loop.
        let age = law.perception_age().map(|age| age.min(now - progress.begun));
        if stop() {
            Some(StopCause::Requested)
        } else if now - progress.fresh > self.settings.robot_timeout {
            Some(StopCause::RobotSilent)
        } else if age.is_some_and(|age| age > self.settings.perception_timeout) {
            Some(StopCause::PerceptionSilent)
        } else {
            None
        }
    }
}

/// How the wait for the first measurement ended.
enum First {
    At(f64),
    StopRequested,
    Never(f64),
}
