//! Judge of whether commands keep the limits, by finite differences and independent of the controller.
//!
//! The contract is in `moca_model::DesiredMotion` and the robot's `JointLimits`. Speed limits hold for each joint and
//! along and about each axis. Acceleration limits hold for each joint, and for x_d by the norm ‖ẍ_d‖ of the linear and
//! of the angular part. Jerk limits hold for each joint that has one. A joint stays within its range. One that starts
//! outside does not move farther out, and returns. The base keeps within the limits of its wheels.

use hrsw_safety::Fault;
use moca_model::whole_body::Model;
use moca_model::whole_body::robot::JointLimits;
use moca_model::{Command, ControllerSettings, DesiredMotion, MecanumBase, TorqueLoopSettings};
use nalgebra::{Vector3, Vector6};
use serde::{Deserialize, Serialize};

/// Tolerance for rounding: relative to a speed limit, absolute for a position \[m, rad\], and over the period relative
/// to an acceleration limit.
const ROUNDING: f64 = 1e-9;

/// Time in which a joint outside its range must return while nothing hinders it \[s\].
const RETURN_TIME: f64 = 5.0;

/// Difference between where a command begins and where the last one led, from which on it starts anew \[m, rad\].
const JUMP: f64 = 1e-6;

/// Difference up to which a command begins where the robot is, for noise of encoders and motion since then \[m, rad\].
const NOISE: f64 = 1e-3;

/// The limits that a command violates.
#[expect(clippy::struct_excessive_bools, reason = "several kinds of limits can be broken at once")]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Breaches {
    /// A speed limit.
    pub limit: bool,
    /// The range of a joint.
    pub range: bool,
    /// The acceleration limit of a joint.
    pub acceleration: bool,
    /// The jerk limit of a joint.
    pub jerk: bool,
    /// The limit of ‖ẍ_d‖, linear or angular.
    pub desired_acceleration: bool,
}

impl Breaches {
    /// Returns true if any limit is violated.
    pub fn any(self) -> bool {
        self.limit || self.range || self.acceleration || self.jerk || self.desired_acceleration
    }
}

/// Freedom of a joint that started outside its range to return.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Return {
    /// Nothing keeps it from returning.
    Free,
    /// A person or the supervisor may keep the robot where it is.
    Hindered,
}

/// A joint outside its range.
#[derive(Clone, Copy, Debug, Default)]
struct Outside {
    /// Time for which nothing has hindered it from returning \[s\].
    time: f64,
    /// True if it was found outside while it moved, and has not come to rest since.
    brakes: bool,
}

/// The smallest margin of each kind of limit, as a fraction of the limit.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Margins {
    /// Distance from the nearer position limit over half the range.
    pub position: f64,
    /// Margin of joint velocities, the wheels and ẋ_d.
    pub velocity: f64,
    /// Margin of joint accelerations and ‖ẍ_d‖.
    pub acceleration: f64,
    /// Margin of joint jerks.
    pub jerk: f64,
}

impl Margins {
    const FULL: Self = Self { position: 1.0, velocity: 1.0, acceleration: 1.0, jerk: 1.0 };

    /// The smallest margin.
    pub fn worst(&self) -> f64 {
        self.position.min(self.velocity).min(self.acceleration).min(self.jerk)
    }
}

/// Checks the commands of a run tick by tick.
///
/// ```
/// use moca_model::{ControllerSettings, MOCA_HOME, moca};
/// use moca_simulation::judges::LimitMonitor;
///
/// let monitor = LimitMonitor::new(&moca()?, &ControllerSettings::default(), &MOCA_HOME);
/// assert_eq!(monitor.margins().worst(), 1.0);
/// # Ok::<(), moca_model::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct LimitMonitor {
    joints: Vec<JointLimits>,
    desired: DesiredMotion,
    base: Option<MecanumBase>,
    period: f64,
    velocity: Vec<f64>,
    /// Least and greatest rates of the velocities in the last tick. They differ after a missed one: the change may have
    /// come at any time since.
    acceleration: Vec<[f64; 2]>,
    twist: Vector6<f64>,
    /// Time since the last command \[s\].
    elapsed: f64,
    /// Position to which the commands have led each joint; `None` before the first.
    led: Vec<Option<f64>>,
    /// Joints outside their range; `None` for those within.
    outside: Vec<Option<Outside>>,
    margins: Margins,
}

impl LimitMonitor {
    /// Creates a monitor for a robot at rest at `configuration`, n \[rad or m\]. It only uses the period and the limits
    /// of the desired pose and the base from the settings.
    pub fn new(model: &Model, settings: &ControllerSettings, configuration: &[f64]) -> Self {
        let &ControllerSettings { desired, base, period, .. } = settings;
        let joints = model.limits().to_vec();
        let outside = joints
            .iter()
            .zip(configuration)
            .map(|(limits, q)| is_outside(limits, *q).then(Outside::default))
            .collect();
        let (velocity, acceleration) = (vec![0.0; joints.len()], vec![[0.0; 2]; joints.len()]);
        let (twist, margins) = (Vector6::zeros(), Margins::FULL);
        let led = vec![None; joints.len()];
        Self {
            joints,
            desired,
            base,
            period,
            velocity,
            acceleration,
            twist,
            elapsed: period,
            led,
            outside,
            margins,
        }
    }

    /// The smallest margins so far.
    pub fn margins(&self) -> Margins {
        self.margins
    }

    /// Takes a period in which no command came. Velocities of the next one may change for that time, too.
    pub fn miss(&mut self) {
        self.elapsed += self.period;
        for (led, velocity) in self.led.iter_mut().flatten().zip(&self.velocity) {
            *led += velocity * self.period;
        }
    }

    /// Takes a command and the configuration before it, n \[rad or m\]. A number that is not finite violates its limit.
    pub fn check(
        &mut self,
        command: &Command,
        configuration: &[f64],
        returning: Return,
    ) -> Breaches {
        let mut breaches = Breaches::default();
        if command.fault == Some(Fault::RobotStopped) {
            // The robot takes no commands, so that the next one begins at rest.
            self.velocity.copy_from_slice(&command.joint_velocity);
            self.acceleration.fill([0.0; 2]);
            self.twist = command.desired_twist;
        }
        for (index, (&v, &q)) in command.joint_velocity.iter().zip(configuration).enumerate() {
            let Some(limits) = self.joints.get(index).copied() else { continue };
            let JointLimits { velocity, acceleration, .. } = limits;
            breaches.limit |= self.speed(v.abs(), velocity);
            let change = v - std::mem::replace(&mut self.velocity[index], v);
            breaches.acceleration |= self.change(change.abs(), acceleration);
            breaches.jerk |= self.jerk(index, change, limits);
            breaches.range |= self.position(index, [q, v, v - change], returning);
            self.led[index] = Some(q + v * self.period);
        }
        if let Some(MecanumBase { speed, lever, axis_speed }) = self.base {
            let [x, y, turn] = command.base_twist.map(f64::abs);
            breaches.limit |= self.speed(x + y + lever * turn, speed);
            breaches.limit |= self.speed(x, axis_speed) | self.speed(y, axis_speed);
        }
        let twist = command.desired_twist;
        let change = twist - std::mem::replace(&mut self.twist, twist);
        let DesiredMotion { velocity, acceleration, angular_velocity, angular_acceleration } =
            self.desired;
        for (at, velocity, acceleration) in
            [(0, velocity, acceleration), (3, angular_velocity, angular_acceleration)]
        {
            let part = |v: &Vector6<f64>| -> Vector3<f64> { v.fixed_rows::<3>(at).into() };
            for speed in part(&twist).iter() {
                breaches.limit |= self.speed(speed.abs(), velocity);
            }
            breaches.desired_acceleration |= self.change(part(&change).norm(), acceleration);
        }
        self.elapsed = self.period;
        breaches
    }

    /// Accepts that joints outside their range were moved there by external causes.
    pub(crate) fn move_outside(&mut self, configuration: &[f64]) {
        for ((outside, limits), q) in self.outside.iter_mut().zip(&self.joints).zip(configuration) {
            *outside = is_outside(limits, *q).then(Outside::default);
        }
    }

    /// Accepts joints outside their range if the next command begins at the `measured` robot instead of where the last
    /// one led. No command took them there. A joint that was moving out must brake.
    pub fn restart(&mut self, configuration: &[f64], measured: &[f64]) {
        let joints = self.outside.iter_mut().zip(&self.joints).zip(&self.led);
        for (((outside, limits), led), (q, measured)) in
            joints.zip(configuration.iter().zip(measured))
        {
            let jumps = led.is_none_or(|led| (q - led).abs() > JUMP);
            if jumps && (q - measured).abs() <= NOISE && is_outside(limits, *q) {
                *outside = Some(Outside { time: 0.0, brakes: true });
            }
        }
    }

    /// Returns true if a speed is too high, or NaN.
    fn speed(&mut self, speed: f64, limit: f64) -> bool {
        let left = 1.0 - speed / limit;
        self.margins.velocity = self.margins.velocity.min(left);
        let kept = left >= -ROUNDING;
        !kept
    }

    /// Returns true if a velocity changes too much since the last command.
    fn change(&mut self, change: f64, limit: f64) -> bool {
        let left = 1.0 - change / self.elapsed / limit;
        self.margins.acceleration = self.margins.acceleration.min(left);
        let kept = left >= -ROUNDING / self.elapsed;
        !kept
    }

    /// Returns true if the acceleration of a joint changes too much since the last command.
    fn jerk(&mut self, index: usize, change: f64, limits: JointLimits) -> bool {
        let (slow, fast) = (change / self.elapsed, change / self.period);
        let fast = if self.elapsed > self.period {
            fast.clamp(-limits.acceleration, limits.acceleration)
        } else {
            fast
        };
        let now = [slow.min(fast), slow.max(fast)];
        let before = std::mem::replace(&mut self.acceleration[index], now);
        if limits.jerk.is_infinite() {
            return false;
        }
        let gap = (now[0] - before[1]).max(before[0] - now[1]).max(0.0);
        let left = 1.0 - gap / self.elapsed / limits.jerk;
        self.margins.jerk = self.margins.jerk.min(left);
        let kept = left >= -ROUNDING / self.elapsed;
        if kept {
            let most = limits.jerk * self.elapsed;
            let reached = [now[0].max(before[0] - most), now[1].min(before[1] + most)];
            // Rounding may leave nothing between the two.
            if reached[0] <= reached[1] {
                self.acceleration[index] = reached;
            }
        }
        !kept
    }

    /// Returns true if the velocity `v`, after `before`, moves a joint out of its range, or leaves it outside for too long.
    fn position(&mut self, index: usize, [q, v, before]: [f64; 3], returning: Return) -> bool {
        let JointLimits { lower, upper, .. } = self.joints[index];
        let next = q + v * self.period;
        let beyond = (next - upper).max(lower - next);
        let outside = &mut self.outside[index];
        let within = beyond <= 0.0;
        if let Some(Outside { time, brakes }) = outside
            && !within
        {
            // A joint that starts from rest must not go farther out or stay for long.
            let [outwards, before] = if next > upper { [v, before] } else { [-v, -before] };
            *time += if returning == Return::Free { self.period } else { 0.0 };
            *brakes &= outwards > ROUNDING;
            let stays = outwards <= ROUNDING || *brakes && outwards < before;
            let kept = stays && *time <= RETURN_TIME;
            return !kept;
        }
        *outside = None;
        if upper.is_finite() {
            let left = -beyond / (0.5 * (upper - lower));
            self.margins.position = self.margins.position.min(left);
        }
        let kept = beyond <= ROUNDING;
        !kept
    }
}

/// Returns true if the robot's position is only predicted.
pub(crate) fn is_unseen(command: &Command) -> bool {
    let faults = [Fault::MissingMeasurement, Fault::FrozenMeasurement, Fault::LostCommand];
    command.fault.is_some_and(|fault| faults.contains(&fault))
}

fn is_outside(limits: &JointLimits, q: f64) -> bool {
    !(limits.lower..=limits.upper).contains(&q)
}

/// Checks the torques of a run tick by tick: sizes within the joints' efforts, and changes within the torque rate.
///
/// ```
/// use moca_simulation::judges::TorqueMonitor;
/// use moca_model::whole_body::torque::Compensation;
/// use moca_model::{TorqueLoopSettings, moca};
///
/// let settings = TorqueLoopSettings::new(Compensation::BARE);
/// let mut monitor = TorqueMonitor::new(&moca()?, &settings, 0.001);
/// assert!(!monitor.check(&[80.0; 7][..4])); // the first counts as reached
/// assert!(!monitor.check(&[81.0; 7][..4]));
/// assert!(monitor.check(&[83.0; 7][..4])); // 2 Nm in a millisecond
/// # Ok::<(), moca_model::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct TorqueMonitor {
    efforts: Vec<f64>,
    /// Largest change in a period \[Nm\].
    change: f64,
    last: Option<Vec<f64>>,
}

impl TorqueMonitor {
    /// Creates a monitor for the torques of these settings, with a command each `period` \[s\].
    pub fn new(model: &Model, settings: &TorqueLoopSettings, period: f64) -> Self {
        let joints = model.joints().iter().zip(model.limits());
        let driven = joints.filter(|(joint, _)| settings.joints.contains(&joint.name));
        let efforts = driven.map(|(_, limits)| limits.effort).collect();
        Self { efforts, change: settings.impedance.torque_rate * period, last: None }
    }

    /// Takes the torques of a tick \[Nm\]. Returns true if a limit is violated or a number is NaN.
    pub fn check(&mut self, torque: &[f64]) -> bool {
        let largest = torque.iter().zip(&self.efforts).all(|(torque, most)| torque.abs() <= *most);
        let change = self.change * (1.0 + 1e-9);
        let slow = self.last.as_ref().is_none_or(|last| {
            torque.iter().zip(last).all(|(torque, last)| (torque - last).abs() <= change)
        });
        match &mut self.last {
            Some(last) => last.clone_from_slice(torque),
            last => *last = Some(torque.to_vec()),
        }
        !(largest && slow)
    }
}
