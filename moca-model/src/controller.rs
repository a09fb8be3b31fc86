//! The controller, which takes percepts at camera rate and returns commands once a millisecond.

mod base_drive;
mod coming_to_rest;
mod goal_share;
mod grasping;
mod looking;
mod measuring;
mod observing;
mod reporting;
mod turning;

use ahqp_core::{JerkLimits, Status, VelocityInterval, integrate_pose};
use ergo_map::ErgonomicsQuadratic;
use hrsw::Softening;
use hrsw_safety::{Fault, LoopClock, RobotLimits, Safety, SafetyState};
use nalgebra::{Isometry3, Vector3};
use whole_body::Model;

use crate::command::{Command, Outcome};
use crate::error::{Error, check_size};
use crate::following_error::FollowingErrorLimit;
use crate::grasped_object::{BoxSide, GraspedObject};
use crate::interaction::{Interaction, Transition};
use crate::motion_limits::{
    Motion, TickTimes, admit_braking, bound_held_acceleration, brake, braking_limits,
    desired_limits, joint_limits, write_intervals,
};
use crate::robot::kinematics::Kinematics;
use crate::robot::moca::{MOCA_AXIS_SPEED, MOCA_BASE_JOINTS};
use crate::settings::{ControllerSettings, Goal};
use crate::shared_space::{POSITION_ROWS, SharedSpace};
use crate::stack::{CollaborationStack, GoalTerms, Levels, StackInput, StackSettings};
use base_drive::BaseDrive;
use goal_share::{ACTIVATES_OVER, GoalConditions, GoalShare};
use looking::SeenSurface;
use turning::HandTurn;

/// Time in which the robot slows down while nothing is seen, and speeds up again \[s\].
const SLOWS_OVER: f64 = 0.5;
/// Age of the newest body from which on the robot comes to rest \[s\]. The person has then been lost for a second.
const RESTS_AFTER: f64 = 1.5;

/// Ergonomic collaboration with a person: AHQP over the robot, the shared workspace and the
/// person's ergonomics.
///
/// Ticks and camera frames are timed on one clock, in seconds from any origin. Problems in the loop are a [`Fault`],
/// which is reported to the supervisor of [`safety`](Self::safety) at once. The robot then slows down or stops as
/// [`Fault::state`] says, always within its limits. A stop that needs an acknowledgement ends with
/// [`Supervisor::acknowledge`](hrsw_safety::Supervisor::acknowledge).
///
/// ```
/// use ergo_map::ErgonomicsQuadratic;
/// use moca_model::{Controller, ControllerSettings, MOCA_HOME, moca};
/// use nalgebra::{Matrix3, Vector3};
///
/// // Usually fitted to the person's map: ErgonomicsMap::build, then fit.
/// let ergonomics = ErgonomicsQuadratic::new(Matrix3::identity(), Vector3::new(-0.4, 0.1, -1.1), 0.8)?;
/// let settings = ControllerSettings::default();
/// let mut controller = Controller::new(moca()?, ergonomics, settings, &MOCA_HOME)?;
/// // In the loop: controller.observe(&percept) at each camera frame, and each millisecond
/// let command = controller.step(0.001, &MOCA_HOME)?;
/// assert!(command.outcome.is_optimal());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Controller {
    robot: Kinematics,
    settings: ControllerSettings,
    ergonomics: ErgonomicsQuadratic,
    clock: LoopClock,
    following_error: FollowingErrorLimit,
    space: SharedSpace,
    safety: Safety,
    stack: CollaborationStack,
    joint_limits: Vec<JerkLimits>,
    desired_limits: [JerkLimits; 6],
    /// Limits for coming to rest, of the joints and of ẋ_d.
    joint_braking: Vec<JerkLimits>,
    desired_braking: Vec<JerkLimits>,
    /// Configuration at which tasks are computed: commanded for joints that follow positions, measured for others.
    reference: Vec<f64>,
    /// Whether each joint follows positions.
    follows_position: Vec<bool>,
    /// Velocities of the joints as measured or predicted; empty if they are unknown.
    measured_velocity: Vec<f64>,
    /// Time between the last two ticks before this one \[s\].
    elapsed_before: f64,
    /// q̇* before the last tick, and its rate of change in it.
    last_velocity: Vec<f64>,
    acceleration: Vec<f64>,
    /// Velocity intervals of the joints, then of ẋ_d.
    intervals: Vec<VelocityInterval>,
    /// Velocity intervals of the joints that must return within their limits.
    returns: Vec<VelocityInterval>,
    /// Joint velocities as near to rest as the intervals allow.
    braking: Vec<f64>,
    command: Command,
    /// The worst fault that was reported since the last command.
    fault: Option<Fault>,
    /// The object that the robot holds for the person to work on.
    object: Option<GraspedObject>,
    /// The side of the object that the person sees, or will see after a turn.
    shown: BoxSide,
    base_drive: Option<BaseDrive>,
    /// Velocity intervals of the base while safety does not need more.
    gentle: Vec<VelocityInterval>,
    hand_turn: HandTurn,
    seen_surface: SeenSurface,
    interaction: Interaction,
    /// Change of the phase in the last tick.
    transition: Option<Transition>,
    /// Whether the external force was measured since the last command.
    measures_force: bool,
    /// Last measured yaw of the base \[rad\].
    yaw: f64,
    speed: f64,
    /// Whether the last velocities keep the protective distances.
    keeps_separation: bool,
    /// Whether they are close to the limits of the separation rows.
    at_limit: bool,
    goal_share: GoalShare,
}

impl Controller {
    /// Creates a controller with the person's ergonomics in their own frame, for a robot at this configuration.
    ///
    /// # Errors
    /// Settings out of range, or a configuration that does not fit the robot.
    pub fn new(
        model: Model,
        ergonomics: ErgonomicsQuadratic,
        settings: ControllerSettings,
        configuration: &[f64],
    ) -> Result<Self, Error> {
        settings.validate()?;
        let bodies = &settings.safety.bodies;
        let mut robot = Kinematics::new(model, &settings.tool, bodies, configuration)?;
        let n = configuration.len();
        let layout = CollaborationStack::layout(n);
        let limits = robot.model().limits().iter();
        let accelerations: Vec<f64> = limits.map(|limits| limits.acceleration).collect();
        let limits = RobotLimits { accelerations: &accelerations, speed: MOCA_AXIS_SPEED };
        let safety = Safety::new(layout, settings.safety.clone(), &limits, settings.period)?;
        let clock = LoopClock::new(settings.period, settings.clock())?;
        let rest = vec![0.0; n];
        let softening = Softening {
            margin: settings.space.margin,
            position_rows: POSITION_ROWS,
            ..Softening::default()
        };
        let stack = StackSettings {
            gain: settings.gain,
            period: settings.period,
            horizon: settings.horizon,
            softening,
            base: settings.base,
            posture: settings.posture.clone(),
            levels: settings.levels,
            stacking: settings.stacking,
            budget: settings.budget,
        };
        let stack = CollaborationStack::new(&robot, &stack, &safety)?;
        robot.update(&settings.posture.configuration)?;
        let base_drive = match settings.base {
            Some(_) if settings.levels == Levels::Extended => {
                Some(BaseDrive::new(MOCA_BASE_JOINTS, &robot, &settings.posture.configuration)?)
            }
            _ => None,
        };
        robot.update(configuration)?;
        let tool = *robot.world_from_tool();
        let joint_limits = joint_limits(robot.model())?;
        let desired_limits = desired_limits(&settings.desired)?;
        let free = VelocityInterval { lower: f64::NEG_INFINITY, upper: f64::INFINITY };
        Ok(Self {
            space: SharedSpace::new(&settings, &tool)?,
            joint_braking: braking_limits(&joint_limits)?,
            desired_braking: braking_limits(&desired_limits)?,
            joint_limits,
            desired_limits,
            reference: configuration.to_vec(),
            measured_velocity: Vec::with_capacity(n),
            follows_position: vec![false; n],
            elapsed_before: settings.period,
            last_velocity: rest.clone(),
            acceleration: rest.clone(),
            intervals: vec![VelocityInterval { lower: 0.0, upper: 0.0 }; n + 6],
            returns: vec![VelocityInterval { lower: 0.0, upper: 0.0 }; n],
            braking: rest,
            command: Command::at_rest(configuration, tool),
            following_error: FollowingErrorLimit::new(
                settings.following_error,
                robot.model(),
                settings.period,
            )?,
            fault: None,
            object: None,
            shown: BoxSide::Front,
            gentle: vec![free; settings.base.map_or(0, |_| MOCA_BASE_JOINTS)],
            base_drive,
            hand_turn: HandTurn::resting(Vector3::x_axis()),
            seen_surface: SeenSurface::default(),
            interaction: Interaction::default(),
            transition: None,
            measures_force: false,
            yaw: 0.0,
            speed: 1.0,
            keeps_separation: true,
            at_limit: false,
            goal_share: GoalShare::NONE,
            clock,
            robot,
            settings,
            ergonomics,
            safety,
            stack,
        })
    }

    /// Sets the ergonomics of another person.
    pub fn set_ergonomics(&mut self, ergonomics: ErgonomicsQuadratic) {
        self.ergonomics = ergonomics;
    }

    /// Asks for the person's ergonomics from now on, or for no more than the least motion.
    pub fn set_goal(&mut self, goal: Goal) {
        self.settings.goal = goal;
    }

    /// The command for the period that begins at `now` \[s\], with the robot at the
    /// `configuration` measured \[m or rad\]. Allocates nothing.
    ///
    /// A tick that cannot be computed brakes every joint at its limit, and [`Command::outcome`] and [`Command::fault`]
    /// say so. Causes are an invalid time, a measurement that is not finite, and a hierarchy that cannot be solved.
    ///
    /// # Errors
    /// [`Error::WrongSize`] for a configuration of the wrong size. The supervisor is then informed, and
    /// [`command`](Self::command) brakes as well.
    pub fn step(&mut self, now: f64, configuration: &[f64]) -> Result<&Command, Error> {
        let size = check_size("configuration", configuration, self.braking.len());
        let tick = self.clock.tick(now);
        if tick.forgets {
            self.space.forget();
            self.safety.forget();
        }
        tick.fault.into_iter().for_each(|fault| self.report(fault));
        let period = self.settings.period;
        let before = std::mem::replace(&mut self.elapsed_before, tick.elapsed);
        let times = TickTimes::new(tick.elapsed, before, &self.settings);
        // The robot moved at the last velocities until this tick came.
        self.integrate(tick.elapsed - period);
        let in_time = !matches!(tick.fault, Some(Fault::Clock(_) | Fault::EarlyTick));
        let measured = size.is_ok() && self.measure(configuration, tick.elapsed);
        if !measured {
            self.report(Fault::BadMeasurement);
        }
        self.last_velocity.copy_from_slice(&self.command.joint_velocity);
        if !(measured && in_time && self.control(times)) {
            self.halt(times);
        }
        self.remember_acceleration(times.step);
        self.integrate(period);
        self.measures_force = false;
        self.finish();
        size.map(|()| &self.command)
    }

    /// Computes the velocities of a tick. Returns false if they cannot be computed.
    fn control(&mut self, times: TickTimes) -> bool {
        let elapsed = times.elapsed;
        if self.watch(elapsed).is_err() {
            self.report(Fault::BadData);
            return false;
        }
        self.advance_speed(elapsed);
        self.advance_activation(elapsed);
        let time = self.clock.now().unwrap_or_default();
        if self.interact(time).and_then(|()| self.advance_hand(elapsed)).is_err() {
            self.report(Fault::BadData);
            return false;
        }
        self.decide_base();
        self.write_intervals(times);
        match self.solve() {
            Ok(Status::Solved) => {}
            Ok(_) => self.report(Fault::IterationLimit),
            Err(_) => {
                self.report(Fault::NoSolution);
                self.brake();
            }
        }
        true
    }

    /// Lowers the speed scale to zero when nothing has been seen for too long, and raises it again otherwise.
    fn advance_speed(&mut self, elapsed: f64) {
        let step = elapsed / SLOWS_OVER;
        let seen = !self.space.is_shared() || self.space.age() <= RESTS_AFTER;
        self.speed = (self.speed + if seen { step } else { -step }).clamp(0.0, 1.0);
    }

    /// Updates the share of ergonomics in the third level.
    fn advance_activation(&mut self, elapsed: f64) {
        let conditions = GoalConditions {
            wanted: self.settings.goal == Goal::Ergonomics && self.space.is_shared(),
            rests: self.space.is_at_rest(),
            at_limit: self.at_limit,
        };
        // The paper's ergonomics begin at once.
        let time = match self.settings.levels {
            Levels::Extended => ACTIVATES_OVER,
            Levels::Paper => self.settings.period,
        };
        self.command.activation = self.goal_share.advance(conditions, elapsed, time);
    }

    /// Decides whether the base stands in this tick.
    fn decide_base(&mut self) {
        let Some(drive) = &mut self.base_drive else { return };
        let hindered = self.command.safety == SafetyState::Retreat || !self.keeps_separation;
        let turns = self.hand_turn.is_turning();
        drive.decide(&self.robot, &self.reference, self.space.is_at_rest() && !turns, hindered);
        self.command.base_motion = drive.motion();
    }

    fn write_intervals(&mut self, times: TickTimes) {
        let (joints, desired) = self.intervals.split_at_mut(self.reference.len());
        let motion = Motion {
            position: &self.reference,
            velocity: &self.command.joint_velocity,
            acceleration: &self.acceleration,
        };
        let scale = self.speed.min(self.safety.speed_scale());
        let base = self.settings.base.map_or(0, |_| MOCA_BASE_JOINTS.min(joints.len()));
        let (limits, (of_base, of_arm)) =
            (self.joint_limits.split_at(base), joints.split_at_mut(base));
        let (base, arm) = motion.split_at(base);
        write_intervals(limits.0, base, scale, times, of_base);
        write_intervals(limits.1, arm, scale, times, of_arm);
        let measured = self.measured_velocity.get(of_base.len()..);
        let measured = measured.filter(|own| !own.is_empty()).unwrap_or(arm.velocity);
        bound_held_acceleration(arm.velocity, measured, times.step, of_arm);
        if let Some(drive) = &self.base_drive {
            drive.write(&self.command.joint_velocity, times.step, joints, &mut self.gentle);
        }
        let limits = [&self.joint_limits[..], &self.joint_braking];
        admit_braking(limits, motion, times.step, joints, &mut self.returns);
        // Comes to rest without passing it: near it, the acceleration fades at the limit of jerk.
        self.braking.copy_from_slice(&self.command.joint_velocity);
        brake(&self.joint_braking, &self.acceleration, times.step, &mut self.braking);
        for (braking, interval) in self.braking.iter_mut().zip(joints) {
            *braking = braking.max(interval.lower).min(interval.upper);
        }
        let twist = self.command.desired_twist.as_slice();
        let motion = Motion { position: &[0.0; 6], velocity: twist, acceleration: &[0.0; 6] };
        // Safety does not slow down the desired pose, which moves along with a robot that stops.
        write_intervals(&self.desired_limits, motion, self.speed, times, desired);
    }

    /// Updates the acceleration from the change of q̇* in `step` \[s\]. If q̇* had to change for longer, the limit is
    /// used.
    fn remember_acceleration(&mut self, step: f64) {
        let change = self.command.joint_velocity.iter().zip(&self.last_velocity);
        let all = self.acceleration.iter_mut().zip(change).zip(&self.joint_limits);
        for ((acceleration, (velocity, last)), limits) in all {
            let most = limits.limits().acceleration();
            *acceleration = ((velocity - last) / step).clamp(-most, most);
        }
    }

    fn solve(&mut self) -> Result<Status, Error> {
        let placed = self.ergonomics.placed(&self.space.working_frame()?);
        let ergonomics = self.space.person().map(|_| &placed);
        let velocity = &self.command.joint_velocity;
        let input = StackInput {
            desired: &self.command.desired,
            workspace: self.space.workspace(),
            goal: GoalTerms {
                ergonomics,
                drift: self.space.person_velocity(),
                activation: self.command.activation,
            },
            velocity,
            intervals: &self.intervals,
            returns: &self.returns,
            gentle: &self.gentle,
            safety: &self.safety,
            braking: &self.braking,
        };
        let solution = self.stack.solve(&mut self.robot, &input)?;
        let status = solution.status();
        self.command.outcome = Outcome::Solved(status);
        let (joints, rest) = solution.best().split_at(self.braking.len());
        let (desired, slack) = rest.split_at(6);
        self.command.joint_velocity.copy_from_slice(joints);
        self.command.desired_twist.copy_from_slice(desired);
        self.command.slack.copy_from_slice(slack);
        let motion = self.robot.motion(&self.command.joint_velocity);
        let separation = self.stack.separation();
        let share =
            separation.map_or(0.0, |rows| self.safety.braking_share(&motion, rows, &self.braking));
        self.keeps_separation = share == 0.0;
        self.at_limit =
            separation.is_some_and(|rows| self.safety.is_at_limit(rows, motion.velocity));
        self.go_towards_rest(share);
        Ok(status)
    }

    /// Integrates the commanded state over `time` \[s\] at the commanded velocities.
    fn integrate(&mut self, time: f64) {
        if time == 0.0 {
            return;
        }
        let command = &mut self.command;
        command.desired = integrate_pose(&command.desired, &command.desired_twist, time);
        for (position, velocity) in command.joint_position.iter_mut().zip(&command.joint_velocity) {
            *position += velocity * time;
        }
    }

    /// Writes the parts of the command other than velocities and positions.
    fn finish(&mut self) {
        let command = &mut self.command;
        command.intention = self.space.intention();
        command.phase = self.interaction.phase();
        command.transition = self.transition.take();
        command.safety = self.safety.supervisor().state();
        command.fault = self.fault.take();
        if let ([x, y, turn, ..], true) =
            (&command.joint_velocity[..], self.settings.base.is_some())
        {
            let (sine, cosine) = self.yaw.sin_cos();
            command.base_twist = [cosine * x + sine * y, cosine * y - sine * x, *turn];
        }
    }

    /// The last command; at rest before the first step.
    pub fn command(&self) -> &Command {
        &self.command
    }

    /// The robot at the last measured configuration: tool, Jacobian, bodies.
    pub fn robot(&self) -> &Kinematics {
        &self.robot
    }

    /// The stack of tasks, with the problem and the solution of the last tick.
    pub fn stack(&self) -> &CollaborationStack {
        &self.stack
    }

    /// The shared workspace and the tracked person.
    pub fn space(&self) -> &SharedSpace {
        &self.space
    }

    /// The shared workspace, to set its place or shape.
    pub fn space_mut(&mut self) -> &mut SharedSpace {
        &mut self.space
    }

    /// The clock of ticks and camera frames.
    pub fn clock(&self) -> &LoopClock {
        &self.clock
    }

    /// Separation and supervision.
    pub fn safety(&self) -> &Safety {
        &self.safety
    }

    /// Separation and supervision, to acknowledge a stop.
    pub fn safety_mut(&mut self) -> &mut Safety {
        &mut self.safety
    }

    /// The settings.
    pub fn settings(&self) -> &ControllerSettings {
        &self.settings
    }

    /// x_a at the last configuration: the pose of the person's hand that works on the grasped object, with the tool's
    /// axes. It is the tool's pose if the tool holds nothing.
    pub fn actual(&self) -> Isometry3<f64> {
        self.robot.world_from_hand()
    }
}
