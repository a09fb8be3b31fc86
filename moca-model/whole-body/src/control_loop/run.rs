//! The control loop.

use super::clock::Clock;
use super::deadlines::DeadlineStatistics;
use super::law::ControlLaw;
use super::robot_side::{JointCommand, JointMeasurement, Received, RobotSide};
use super::settings::LoopSettings;
use crate::error::Error;

/// Reason why a loop stopped.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum StopCause {
    /// A stop was requested.
    Requested,
    /// The robot sent no measurement for too long.
    RobotSilent,
    /// Nothing was perceived for too long.
    PerceptionSilent,
}

/// Ending of a loop.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LoopEnding {
    /// Reason why it stopped.
    pub cause: StopCause,
    /// True if the robot was measured at rest when it was halted; `None` if that was not known. If it was not at rest,
    /// the time allowed for stopping had passed.
    pub at_rest: Option<bool>,
}

/// Reason why a loop failed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LoopError<R, L> {
    /// The robot cannot be reached.
    #[error("the robot: {0}")]
    Robot(R),
    /// The control law refused what it was given.
    #[error("the control law: {0}")]
    Law(L),
    /// The robot has sent no measurement since the loop began.
    #[error("the robot has measured nothing for {waited} s; check that it is on and connected")]
    NoMeasurement {
        /// Time for which the loop waited \[s\].
        waited: f64,
    },
    /// The robot measures too seldom for this control law.
    #[error(
        "the robot measures every {:.1} ms; this control law needs a measurement every {:.1} ms at least, so set the \
         interface to {:.0} Hz or more",
        1e3 * interval, 1e3 * needed, (1.0 / needed).ceil()
    )]
    MeasuresTooSeldom {
        /// Mean time between measurements \[s\].
        interval: f64,
        /// Longest time between measurements that the law allows \[s\].
        needed: f64,
    },
}

/// Share of the period within which a tick counts as due. So no two ticks run in quick succession, and rounding does
/// not decide which ones are missed.
const NEAR: f64 = 0.05;

/// A loop with a fixed period between a robot and a control law.
///
/// Ticks are due at multiples of the period. A tick is missed if it has not begun a twentieth of the period before the
/// next one is due. Missed ticks are counted and left out. So no two ticks run in one period, and after a late one the
/// next begins when it is due.
///
/// Before the first command the loop measures how often measurements come, and refuses a robot that the law cannot
/// control. It ends on request, or when robot or perception are silent for too long. It then asks the law to stop, goes
/// on until the robot is measured at rest, and halts it. If measurements fail meanwhile, it halts the robot soon. After
/// construction it allocates nothing.
///
/// ```
/// # use std::convert::Infallible;
/// use whole_body::control_loop::{
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
///     fn is_at_rest(&self, _measured: &JointMeasurement) -> Option<bool> {
///         Some(self.0 == 0.0)
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

/// State of a run, kept from tick to tick.
struct Progress {
    /// When the run began, and when the last measurement came \[s\].
    begun: f64,
    fresh: f64,
    /// Reason why the run is stopping, and the time since which it is \[s\].
    stopping: Option<(StopCause, f64)>,
}

impl ControlLoop {
    /// Creates a loop for measurements of the shape of `measured`.
    ///
    /// # Errors
    /// [`Error::Value`] for settings out of range.
    pub fn new(settings: LoopSettings, measured: JointMeasurement) -> Result<Self, Error> {
        settings.validate()?;
        let command = JointCommand::at_rest(&measured);
        Ok(Self { settings, measured, command, statistics: DeadlineStatistics::new() })
    }

    /// Statistics of the deadlines so far.
    pub fn statistics(&self) -> &DeadlineStatistics {
        &self.statistics
    }

    /// The last measurement.
    pub fn measured(&self) -> &JointMeasurement {
        &self.measured
    }

    /// The last command.
    pub fn command(&self) -> &JointCommand {
        &self.command
    }

    /// Runs until `stop` returns true, or until the robot or the perception are silent. `stop` is asked once a tick.
    /// Nothing is sent before the first measurement. In every case the robot is halted at the end.
    ///
    /// # Errors
    /// [`LoopError`]. The robot was then halted in its motion.
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
                return Ok(LoopEnding { cause: StopCause::Requested, at_rest: None });
            }
            First::Never(waited) => return Err(LoopError::NoMeasurement { waited }),
        };
        let Some(fresh) = self.listen(robot, law, clock, begun, stop)? else {
            return Ok(LoopEnding { cause: StopCause::Requested, at_rest: None });
        };
        law.begin(&self.measured).map_err(LoopError::Law)?;
        let mut progress = Progress { begun, fresh, stopping: None };
        // The first tick comes at once. All others are due at multiples of the period from then on.
        let first = clock.now();
        let (mut tick, mut now) = (0_u64, first);
        loop {
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
                let at_rest = law.is_at_rest(&self.measured);
                let is_blind = law.measurement_age(&self.measured) > self.settings.blind_within;
                let is_over = is_blind || now - since > self.settings.stop_within;
                if at_rest == Some(true) || is_over {
                    return Ok(LoopEnding { cause, at_rest });
                }
            }
            let missed;
            (missed, now) = self.pace(first, tick + 1, clock);
            tick += 1 + missed;
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

    /// Measures how often the robot measures. Returns when the last measurement came, or `None` if a stop is requested.
    fn listen<R: RobotSide, L: ControlLaw>(
        &mut self,
        robot: &mut R,
        law: &L,
        clock: &mut impl Clock,
        begun: f64,
        stop: &mut impl FnMut() -> bool,
    ) -> Result<Option<f64>, LoopError<R::Error, L::Error>> {
        let Some(needed) = law.longest_interval() else { return Ok(Some(begun)) };
        let (mut tick, mut count, mut last) = (0.0, 0.0, begun);
        loop {
            tick += 1.0;
            clock.sleep_until(begun + tick * self.settings.period);
            let now = clock.now();
            if robot.receive(&mut self.measured).map_err(LoopError::Robot)? == Received::Fresh {
                count += 1.0;
                last = now;
            }
            if stop() {
                return Ok(None);
            }
            if now - begun >= self.settings.listening {
                // Measurements count at the ticks that read them, and so does the first one.
                let interval = if count > 0.0 { (last - begun) / count } else { now - begun };
                let allowed = needed * (1.0 + JITTER);
                return if interval > allowed {
                    Err(LoopError::MeasuresTooSeldom { interval, needed })
                } else {
                    Ok(Some(last))
                };
            }
        }
    }

    /// Waits until the tick is due. Returns how many ticks are missed and the time at which this tick begins. Missed
    /// are the ticks that are due before that time or shortly after it.
    fn pace(&mut self, first: f64, tick: u64, clock: &mut impl Clock) -> (u64, f64) {
        let period = self.settings.period;
        let due = first + tick as f64 * period;
        clock.sleep_until(due);
        let now = clock.now();
        let late = now - due;
        // The value is not negative and far below 2^53.
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "as above")]
        let missed = (late / period + NEAR).floor().max(0.0) as u64;
        self.statistics.latency.push(late);
        self.statistics.missed += missed;
        self.statistics.late += u64::from(missed > 0);
        (missed, now)
    }

    fn reason_to_stop<L: ControlLaw>(
        &self,
        progress: &Progress,
        now: f64,
        law: &L,
        stop: &mut impl FnMut() -> bool,
    ) -> Option<StopCause> {
        // Perception that has never come counts from the beginning of the loop.
        let age = law.perception_age().map(|age| age.min(now - progress.begun));
        if stop() {
            Some(StopCause::Requested)
        } else if law.measurement_age(&self.measured) > self.settings.robot_timeout {
            Some(StopCause::RobotSilent)
        } else if age.is_some_and(|age| age > self.settings.perception_timeout) {
            Some(StopCause::PerceptionSilent)
        } else {
            None
        }
    }
}

/// Share by which measurements may come less often than the law needs them, since some are lost.
const JITTER: f64 = 0.15;

/// Ending of the wait for the first measurement.
enum First {
    At(f64),
    StopRequested,
    Never(f64),
}
