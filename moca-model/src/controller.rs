//! The controller, which takes percepts at camera rate and returns commands once a millisecond.

mod base_drive;
pub(crate) mod commanded_motion;
mod ergonomic_goal;
mod grasping;
mod looking;
mod observing;
mod reporting;
mod turning;

use ahqp_core::{Status, integrate_pose};
use ergo_map::ErgonomicsQuadratic;
use hrsw_safety::{Fault, LoopClock, Safety, SafetyState};
use nalgebra::Isometry3;
use vision_models::{Freshness, People, PeopleSettings};
use whole_body::Model;
use whole_body::torque::Following;

use crate::command::{Command, Outcome};
use crate::error::{Error, check_size};
use crate::motion_limits::TickTimes;
use crate::robot::kinematics::Kinematics;
use crate::robot::moca::MOCA_AXIS_SPEED;
use crate::settings::{ControllerSettings, Goal, Levels};
use crate::shared_space::SharedSpace;
use crate::situation::Situation;
use crate::stack::{CollaborationStack, GoalTerms, StackInput};
use base_drive::Conditions;
use commanded_motion::CommandedMotion;
use ergonomic_goal::{ACTIVATES_OVER, ErgonomicGoal};
use grasping::Workpiece;
use reporting::Reports;

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
    settings: ControllerSettings,
    robot: Kinematics,
    clock: LoopClock,
    people: People,
    space: SharedSpace,
    safety: Safety,
    goal: ErgonomicGoal,
    workpiece: Workpiece,
    stack: CollaborationStack,
    motion: CommandedMotion,
    reports: Reports,
    command: Command,
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
        let (safety, period) = (settings.safety.clone(), settings.period);
        let safety = Safety::new(layout, safety, &accelerations, MOCA_AXIS_SPEED, period)?;
        let clock = LoopClock::new(settings.period)?;
        let stack = CollaborationStack::new(&robot, &settings, &safety)?;
        let motion = CommandedMotion::new(&mut robot, &settings, configuration)?;
        let tool = *robot.world_from_tool();
        let space = SharedSpace::new(&settings, &tool)?;
        Ok(Self {
            people: People::new(PeopleSettings::untracked(), settings.tracker())?,
            goal: ErgonomicGoal::new(ergonomics),
            workpiece: Workpiece::none(),
            reports: Reports::default(),
            command: Command::at_rest(configuration, tool),
            settings,
            robot,
            clock,
            space,
            safety,
            stack,
            motion,
        })
    }

    /// Sets the ergonomics of another person.
    pub fn set_ergonomics(&mut self, ergonomics: ErgonomicsQuadratic) {
        self.goal.ergonomics = ergonomics;
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
    /// [`Error::Size`] for a configuration of the wrong size. The supervisor is then informed, and
    /// [`command`](Self::command) brakes as well.
    pub fn step(&mut self, now: f64, configuration: &[f64]) -> Result<&Command, Error> {
        let size = check_size("configuration", configuration, self.motion.braking.len());
        let tick = self.clock.tick(now);
        if tick.forgets {
            self.people.forget();
            self.space.forget();
            self.safety.forget();
        }
        tick.fault.into_iter().for_each(|fault| self.report(fault));
        let period = self.settings.period;
        let times = self.motion.begin(tick.elapsed, period);
        // The robot moved at the last velocities until this tick came.
        self.integrate(tick.elapsed - period);
        let in_time = !matches!(tick.fault, Some(Fault::Clock(_) | Fault::EarlyTick));
        let measured = size.is_ok() && self.measure(configuration, tick.elapsed);
        if !measured {
            self.report(Fault::BadMeasurement);
        }
        self.motion.remember_velocity(&self.command);
        self.command.transition = None;
        if !(measured && in_time && self.control(times)) {
            self.motion.halt(&mut self.command, times.step);
            self.safety.wait(self.clock.age(), times.elapsed);
        }
        self.motion.remember_acceleration(&self.command, times);
        self.integrate(period);
        self.finish();
        size.map(|()| &self.command)
    }

    /// Takes the measured configuration and keeps the commanded state near it. Returns false if it cannot be used.
    fn measure(&mut self, configuration: &[f64], elapsed: f64) -> bool {
        let Self { motion, robot, command, .. } = self;
        let following = motion.measure(robot, command, configuration, elapsed);
        if following == Some(Following::Reached) {
            self.report(Fault::FollowingError);
        }
        following.is_some()
    }

    /// Computes tasks at the commanded positions of these joints from now on. They follow positions, by torques.
    pub(crate) fn follow_positions(&mut self, joints: &[usize]) {
        for (index, follows) in self.motion.follows_position.iter_mut().enumerate() {
            *follows = joints.contains(&index);
        }
    }

    /// Takes the velocities of the joints, as measured or predicted.
    pub(crate) fn set_measured_velocity(&mut self, velocity: &[f64]) {
        self.motion.set_measured_velocity(velocity);
    }

    /// Computes the velocities of a tick. Returns false if they cannot be computed.
    fn control(&mut self, times: TickTimes) -> bool {
        let elapsed = times.elapsed;
        if self.watch(elapsed).is_err() {
            self.report(Fault::BadData);
            return false;
        }
        let situation = self.space.situation();
        let is_lost = situation.is_shared && situation.freshness() == Freshness::Lost;
        self.motion.advance_speed(is_lost, elapsed);
        self.advance_activation(elapsed);
        let time = self.clock.now().unwrap_or_default();
        if self.interact(time).and_then(|()| self.advance_hand(elapsed)).is_err() {
            self.report(Fault::BadData);
            return false;
        }
        self.decide_base(elapsed);
        self.motion.write_intervals(&self.command, times, self.safety.speed_scale());
        match self.solve() {
            Ok(Status::Solved) => {}
            Ok(_) => self.report(Fault::IterationLimit),
            Err(_) => {
                self.report(Fault::NoSolution);
                self.motion.brake(&mut self.command);
            }
        }
        true
    }

    /// Updates the share of ergonomics in the third level.
    fn advance_activation(&mut self, elapsed: f64) {
        let situation = self.space.situation();
        let wanted = self.settings.goal == Goal::Ergonomics && situation.is_shared;
        // The paper's ergonomics begin at once.
        let time = match self.settings.levels {
            Levels::Extended => ACTIVATES_OVER,
            Levels::Paper => self.settings.period,
        };
        let (rests, desired) = (situation.is_at_rest, &self.command.desired.translation.vector);
        let gain = self.goal.gain_at_best_place(&situation.frame, self.space.workspace(), desired);
        self.command.activation = self.goal.share.advance(wanted, rests, gain, elapsed, time);
    }

    /// Decides whether the base stands in this tick.
    fn decide_base(&mut self, elapsed: f64) {
        let Some(drive) = &mut self.motion.base_drive else { return };
        let hindered = self.command.safety == SafetyState::Retreat || !self.motion.keeps_separation;
        let rests = self.space.situation().is_at_rest && !self.workpiece.hand_turn.is_turning();
        let conditions = Conditions {
            rests,
            is_hindered: hindered,
            is_at_limit: self.goal.share.at_limit,
            elapsed,
        };
        let state = [&self.motion.reference[..], &self.command.joint_velocity];
        drive.decide(&self.robot, state, &conditions);
        self.command.base_motion = drive.motion();
    }

    fn solve(&mut self) -> Result<Status, Error> {
        let (situation, motion) = (self.space.situation(), &mut self.motion);
        let placed = self.goal.ergonomics.placed(&situation.frame);
        let ergonomics = situation.worker.map(|_| &placed);
        let velocity = &self.command.joint_velocity;
        let input = StackInput {
            desired: &self.command.desired,
            workspace: self.space.workspace(),
            goal: GoalTerms {
                ergonomics,
                drift: situation.velocity,
                activation: self.command.activation,
            },
            velocity,
            motion,
            safety: &self.safety,
        };
        let solution = self.stack.solve(&mut self.robot, &input)?;
        let status = solution.status();
        self.command.outcome = Outcome::Solved(status);
        let (joints, rest) = solution.best().split_at(motion.braking.len());
        let (desired, slack) = rest.split_at(6);
        self.command.joint_velocity.copy_from_slice(joints);
        self.command.desired_twist.copy_from_slice(desired);
        self.command.slack.copy_from_slice(slack);
        let moves = self.robot.motion(&self.command.joint_velocity);
        let (distances, rows) = (self.safety.separation_mut(), self.stack.separation());
        let share = rows.map_or(0.0, |rows| {
            distances.braking_share(&moves, rows, moves.velocity, &motion.stopping)
        });
        if let (Some(rows), true) = (rows, share == 1.0) {
            let bounds = (&motion.least[..], &motion.receding[..]);
            distances.recede(&moves, rows, bounds, &mut motion.stopping);
        }
        motion.keeps_separation = share == 0.0;
        self.goal.share.at_limit =
            rows.is_some_and(|rows| distances.is_at_limit(rows, moves.velocity));
        motion.go_towards_rest(&mut self.command, share);
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
        command.intention = self.space.situation().intention;
        command.safety = self.safety.supervisor().state();
        command.fault = std::mem::take(&mut self.reports).fault;
        self.motion.write_base_twist(command);
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

    /// Returns the situation of the last tick: where the person may be, and what they want.
    pub fn situation(&self) -> &Situation {
        self.space.situation()
    }

    /// The shared workspace.
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
