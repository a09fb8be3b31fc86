//! The commanded velocities of the joints and of the desired pose: their limits, and braking.

use ahqp_core::VelocityInterval;
use nalgebra::Vector6;
use whole_body::limits::{JointIntervals, nearest_to_rest};
use whole_body::torque::Following;

use super::base_drive::BaseDrive;
use crate::command::{Command, Outcome};
use crate::error::{Error, check_positive};
use crate::following_error::FollowingErrorLimit;
use crate::motion_limits::{HELD, HELD_IN_STOP, TickTimes, bound_held_acceleration, clamp};
use crate::robot::kinematics::Kinematics;
use crate::robot::moca::MOCA_BASE_JOINTS;
use crate::settings::{ControllerSettings, Levels};

/// Time in which the robot slows down while nothing is seen, and speeds up again \[s\].
const SLOWS_OVER: f64 = 0.5;
/// Time constant with which the commanded place of the base approaches the measured one \[s\]. It is long against the
/// noise of odometry and short against the slip of wheels.
const ODOMETRY: f64 = 0.15;

/// The state of the commanded motion, and the velocities that limits allow in a tick.
#[derive(Debug, Clone)]
pub(crate) struct CommandedMotion {
    pub(super) following_error: FollowingErrorLimit,
    /// Velocity intervals of the joints, and those of ẋ_d.
    pub(crate) joints: JointIntervals,
    pub(crate) desired: JointIntervals,
    /// Number of joints of the base.
    base: usize,
    pub(crate) base_drive: Option<BaseDrive>,
    /// Configuration at which tasks are computed: commanded for joints that follow positions, measured for others.
    pub(super) reference: Vec<f64>,
    /// Whether each joint follows positions.
    pub(super) follows_position: Vec<bool>,
    /// Velocities of the joints as measured or predicted; empty if they are unknown.
    measured_velocity: Vec<f64>,
    /// Time between the last two ticks before this one \[s\].
    elapsed_before: f64,
    /// q̇* before the last tick, and its rate of change in it.
    last_velocity: Vec<f64>,
    acceleration: Vec<f64>,
    /// Rates of change of q̇* from which a joint may brake ([`TickTimes::accelerations`]).
    brakes_from: Vec<[f64; 2]>,
    /// Velocity intervals of the joints that must return within their limits.
    pub(crate) returns: Vec<VelocityInterval>,
    /// Joint velocities as near to rest as the intervals allow.
    pub(crate) braking: Vec<f64>,
    /// Joint velocities of an emergency stop, which may accelerate more.
    pub(super) stopping: Vec<f64>,
    /// Joint velocities of the hardest stop: those of `stopping` without the bound on held accelerations.
    pub(super) least: Vec<f64>,
    /// Velocities to which joints may go so that a stop recedes. The base's do not get faster, as its wheels share a
    /// limit.
    pub(super) receding: Vec<VelocityInterval>,
    /// Share of all velocity limits, 0 while the person is lost.
    speed: f64,
    /// Whether the last velocities keep the protective distances.
    pub(super) keeps_separation: bool,
}

impl CommandedMotion {
    /// Creates the motion of a robot that rests at the `configuration`, where the robot is. It comes back there.
    ///
    /// # Errors
    /// Settings out of range, or a posture that does not fit the robot.
    pub(super) fn new(
        robot: &mut Kinematics,
        settings: &ControllerSettings,
        configuration: &[f64],
    ) -> Result<Self, Error> {
        let n = configuration.len();
        robot.update(&settings.posture.configuration)?;
        let base_drive = match settings.base {
            Some(_) if settings.levels == Levels::Extended => {
                Some(BaseDrive::new(MOCA_BASE_JOINTS, robot, &settings.posture.configuration)?)
            }
            _ => None,
        };
        robot.update(configuration)?;
        let base = settings.base.map_or(0, |_| MOCA_BASE_JOINTS);
        let limits = robot.model().limits().iter().flat_map(|l| [l.velocity, l.acceleration]);
        check_positive(limits.map(|limit| ("a joint's velocity or acceleration limit", limit)))?;
        let rest = vec![0.0; n];
        Ok(Self {
            following_error: FollowingErrorLimit::new(
                settings.following_error,
                robot.model(),
                settings.period,
            )?,
            joints: JointIntervals::new(robot.model())?,
            desired: JointIntervals::of_limits(&settings.desired.limits())?,
            base_drive,
            reference: configuration.to_vec(),
            follows_position: vec![false; n],
            measured_velocity: Vec::with_capacity(n),
            elapsed_before: settings.period,
            last_velocity: rest.clone(),
            acceleration: rest.clone(),
            brakes_from: vec![[0.0; 2]; n],
            returns: vec![VelocityInterval { lower: 0.0, upper: 0.0 }; n],
            base: base.min(n),
            braking: rest.clone(),
            stopping: rest.clone(),
            least: rest,
            receding: vec![VelocityInterval { lower: 0.0, upper: 0.0 }; n],
            speed: 1.0,
            keeps_separation: true,
        })
    }

    /// Begins a tick that comes `elapsed` \[s\] after the last one.
    pub(super) fn begin(&mut self, elapsed: f64, period: f64) -> TickTimes {
        let before = std::mem::replace(&mut self.elapsed_before, elapsed);
        TickTimes::new(elapsed, before, period)
    }

    /// Keeps the velocity before the tick changes it.
    pub(super) fn remember_velocity(&mut self, command: &Command) {
        self.last_velocity.copy_from_slice(&command.joint_velocity);
    }

    /// Updates the acceleration from the change of q̇* in a tick.
    pub(super) fn remember_acceleration(&mut self, command: &Command, times: TickTimes) {
        let change = command.joint_velocity.iter().zip(&self.last_velocity);
        let accelerations = self.acceleration.iter_mut().zip(&mut self.brakes_from);
        for (((acceleration, from), (velocity, last)), limits) in
            accelerations.zip(change).zip(self.joints.limits())
        {
            let Some(limits) = limits else { continue };
            *from = times.accelerations(limits, velocity - last, *acceleration);
            [*acceleration, _] = *from;
        }
    }

    /// Restarts at rest from the measured state in the next ticks.
    pub(super) fn resynchronise(&mut self) {
        self.following_error.resynchronise();
        self.acceleration.fill(0.0);
        self.brakes_from.fill([0.0; 2]);
    }

    /// Takes the velocities of the joints, as measured or predicted.
    pub(super) fn set_measured_velocity(&mut self, velocity: &[f64]) {
        self.measured_velocity.clear();
        self.measured_velocity.extend_from_slice(velocity);
    }

    /// Takes the measured configuration, moves the robot to the one that tasks see, and keeps the commanded state near
    /// it. Returns `None` if it cannot be used.
    pub(super) fn measure(
        &mut self,
        robot: &mut Kinematics,
        command: &mut Command,
        configuration: &[f64],
        elapsed: f64,
    ) -> Option<Following> {
        // An error would allocate its message.
        if !robot.model().is_configuration(configuration) {
            return None;
        }
        let tool = robot.world_from_tool().translation.vector;
        let follows = &self.follows_position;
        let following = self.following_error.clamp(command, configuration, follows, &tool).ok()?;
        self.refer(command, configuration, following, elapsed);
        robot.update(&self.reference).ok()?;
        FollowingErrorLimit::clamp_pose(&mut command.desired, &robot.world_from_hand(), following);
        Some(following)
    }

    /// Sets the configuration that tasks see. The base's part is commanded and approaches the measured one slowly, so
    /// that noise of odometry does not reach the command.
    fn refer(
        &mut self,
        command: &Command,
        configuration: &[f64],
        following: Following,
        elapsed: f64,
    ) {
        let base = if following == Following::Follows { self.base } else { 0 };
        let drawn = -(-elapsed / ODOMETRY).exp_m1();
        let joints = self.reference.iter_mut().zip(configuration).zip(&command.joint_velocity);
        for (index, ((reference, measured), velocity)) in joints.enumerate() {
            let expected = *reference + velocity * elapsed;
            *reference =
                if index < base { expected + drawn * (measured - expected) } else { *measured };
        }
        let commanded = self.follows_position.iter().zip(&command.joint_position);
        for (reference, (follows, commanded)) in self.reference.iter_mut().zip(commanded) {
            if *follows {
                *reference = *commanded;
            }
        }
    }

    /// Lowers the share of the velocity limits to zero while the person is lost, and raises it again otherwise.
    pub(super) fn advance_speed(&mut self, is_lost: bool, elapsed: f64) {
        let step = elapsed / SLOWS_OVER;
        self.speed = (self.speed + if is_lost { -step } else { step }).clamp(0.0, 1.0);
    }

    /// Computes the velocities that joints and desired pose may take, with the share of their speeds that safety allows
    /// the joints.
    pub(super) fn write_intervals(&mut self, command: &Command, times: TickTimes, share: f64) {
        let (q, v, a) = (&self.reference[..], &command.joint_velocity[..], &self.acceleration[..]);
        let scale = self.speed.min(share);
        self.joints.update_by(q, v, a, |limits, state| times.interval(limits, state, scale));
        if let Some(drive) = &mut self.base_drive {
            drive.write(v, times.step, &mut self.joints.now);
        }
        self.joints.admit_braking(q, v, a, times.step, &mut self.returns);
        // Comes to rest without passing it: near it, the acceleration fades at the limit of jerk.
        self.stopping.copy_from_slice(v);
        self.joints.brake(self.brakes_from.iter().copied(), times.step, &mut self.stopping);
        let joints = &mut self.joints.now;
        // A stop goes on as it began in a late tick.
        for (interval, stop) in joints.iter_mut().zip(&self.stopping) {
            if stop.abs() < nearest_to_rest(interval).abs() {
                interval.lower = interval.lower.min(*stop);
                interval.upper = interval.upper.max(*stop);
            }
        }
        let measured = self.measured_velocity.get(self.base..);
        let (of_base, of_arm) = v.split_at(self.base);
        let measured = measured.filter(|own| !own.is_empty()).unwrap_or(of_arm);
        let bound = |joints: &mut [VelocityInterval], held| {
            let (_, joints) = joints.split_at_mut(self.base);
            bound_held_acceleration([of_arm, measured], held, times.step, joints);
        };
        self.least.copy_from_slice(&self.stopping);
        clamp(&mut self.least, joints);
        bound(joints, HELD_IN_STOP);
        clamp(&mut self.stopping, joints);
        bound(joints, HELD);
        self.receding.copy_from_slice(joints);
        for (interval, velocity) in self.receding.iter_mut().zip(of_base) {
            interval.lower = interval.lower.max(-velocity.abs());
            interval.upper = interval.upper.min(velocity.abs());
        }
        self.braking.copy_from_slice(&self.stopping);
        clamp(&mut self.braking, joints);
        let twist = command.desired_twist.as_slice();
        let speed = self.speed;
        // Safety does not slow down the desired pose, which moves along with a robot that stops.
        self.desired
            .update_by(&[], twist, &[0.0; 6], |limits, state| times.interval(limits, state, speed));
    }

    /// Sets every joint and the desired pose as near to rest as their limits allow.
    pub(super) fn brake(&self, command: &mut Command) {
        self.go_towards_rest(command, 1.0);
        command.outcome = Outcome::Braking;
    }

    /// Moves the velocities by this share towards those of an emergency stop.
    pub(super) fn go_towards_rest(&self, command: &mut Command, share: f64) {
        if share == 0.0 {
            return;
        }
        let velocities = command.joint_velocity.iter_mut().zip(&self.stopping);
        velocities.for_each(|(velocity, stopping)| *velocity += share * (stopping - *velocity));
        for (velocity, interval) in command.desired_twist.iter_mut().zip(&self.desired.now) {
            *velocity += share * (nearest_to_rest(interval) - *velocity);
        }
        command.slack *= 1.0 - share;
    }

    /// Brakes at the limits of acceleration and jerk, whatever the tasks ask, for `step` seconds.
    pub(super) fn halt(&self, command: &mut Command, step: f64) {
        let from = self.brakes_from.iter().copied();
        self.joints.brake(from, step, &mut command.joint_velocity);
        self.desired.brake([[0.0; 2]; 6], step, command.desired_twist.as_mut_slice());
        command.slack = Vector6::zeros();
        command.outcome = Outcome::Braking;
    }

    /// Writes the base's velocity in its own frame, at the yaw for which the limits of its wheels hold.
    pub(super) fn write_base_twist(&self, command: &mut Command) {
        let velocity = &command.joint_velocity[..];
        if let ([x, y, turn, ..], [_, _, yaw, ..], true) =
            (velocity, &self.reference[..], self.base > 0)
        {
            let (sine, cosine) = yaw.sin_cos();
            command.base_twist = [cosine * x + sine * y, cosine * y - sine * x, *turn];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::moca::{MOCA_HOME, moca};
    use proptest::prelude::*;

    proptest! {
        /// The last part of a stop, from the acceleration α to rest, satisfies α² = 2 j v. From v at a constant
        /// speed, α Δt + α²/(2 j) = v leads to it. Held for 20 ms, no acceleration leads beyond 1.2 v + 0.1 rad/s.
        #[test]
        fn emergency_stops_use_what_limits_allow(
            velocity in prop::collection::vec(-0.5..0.5_f64, 7), share in 0.0..1.0_f64,
        ) {
            let settings = ControllerSettings::default();
            let model = moca().unwrap();
            let mut robot = Kinematics::new(model.clone(), &settings.tool, &[], &MOCA_HOME).unwrap();
            let mut motion = CommandedMotion::new(&mut robot, &settings, &MOCA_HOME).unwrap();
            let mut command = Command::at_rest(&MOCA_HOME, *robot.world_from_tool());
            let joints = command.joint_velocity.iter_mut().skip(MOCA_BASE_JOINTS);
            joints.zip(&velocity).for_each(|(own, velocity)| *own = share * share * velocity);
            let before = command.joint_velocity.clone();
            let step = settings.period;
            motion.write_intervals(&command, TickTimes { elapsed: step, step }, 1.0);
            motion.brake(&mut command);
            let joints = model.limits().iter().zip(before.iter().zip(&command.joint_velocity));
            for (limits, (before, now)) in joints.skip(MOCA_BASE_JOINTS) {
                let jerk = limits.jerk;
                let fading = jerk * ((step * step + 2.0 * before.abs() / jerk).sqrt() - step);
                let held = (2.2 * before.abs() + 0.1) / 0.02;
                let change = fading.min(limits.acceleration).min(jerk * step).min(held) * step;
                prop_assert!((now.abs() - (before.abs() - change)).abs() < 1e-12, "{before} {now}");
            }
        }

        /// A stop that began in a late tick brakes no less in the next one, as long as joints are far from rest.
        #[test]
        fn late_ticks_interrupt_no_stop(
            shares in prop::collection::vec(prop_oneof![-1.0..-0.3_f64, 0.3..1.0_f64], 10), late in 1e-3..0.02_f64,
        ) {
            let settings = ControllerSettings::default();
            let model = moca().unwrap();
            let mut robot = Kinematics::new(model.clone(), &settings.tool, &[], &MOCA_HOME).unwrap();
            let mut motion = CommandedMotion::new(&mut robot, &settings, &MOCA_HOME).unwrap();
            let mut command = Command::at_rest(&MOCA_HOME, *robot.world_from_tool());
            let joints = command.joint_velocity.iter_mut().zip(model.limits());
            joints.zip(&shares).for_each(|((own, limits), share)| *own = share * limits.velocity);
            let mut changes = Vec::new();
            for elapsed in [late, settings.period] {
                let times = motion.begin(elapsed, settings.period);
                motion.remember_velocity(&command);
                let before = command.joint_velocity.clone();
                motion.write_intervals(&command, times, 1.0);
                motion.brake(&mut command);
                motion.remember_acceleration(&command, times);
                let joints = before.iter().zip(&command.joint_velocity);
                changes.push(joints.map(|(before, now)| before.abs() - now.abs()).collect::<Vec<_>>());
            }
            for (late, next) in changes[0].iter().zip(&changes[1]) {
                prop_assert!(*next >= late - 1e-12, "{changes:?}");
            }
        }
    }

    /// Rows of wheels are written at the yaw that tasks see. The measured one differs by noise.
    #[test]
    fn noise_of_yaw_exceeds_no_limit_of_wheels() {
        let settings = ControllerSettings::default();
        let mut robot = Kinematics::new(moca().unwrap(), &settings.tool, &[], &MOCA_HOME).unwrap();
        let mut motion = CommandedMotion::new(&mut robot, &settings, &MOCA_HOME).unwrap();
        let mut command = Command::at_rest(&MOCA_HOME, *robot.world_from_tool());
        let mut measured = MOCA_HOME;
        measured[2] += 0.01;
        motion.measure(&mut robot, &mut command, &measured, settings.period).unwrap();
        let yaw = robot.posed().unwrap().configuration()[2];
        let limit = settings.base.unwrap().axis_speed;
        command.joint_velocity[0] = limit * yaw.cos();
        command.joint_velocity[1] = limit * yaw.sin();
        motion.write_base_twist(&mut command);
        let [x, y, _] = command.base_twist;
        assert!((x - limit).abs() < 1e-12 && y.abs() < 1e-12, "{x} {y} m/s");
    }
}
