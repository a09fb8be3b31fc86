//! Whether every command keeps every limit, checked apart from the controller.

use moca_model::{
    Command, DesiredMotion, JointLimits, MOCA_AXIS_SPEED, MOCA_BASE_JOINTS, MOCA_WHEEL_LEVER,
    MOCA_WHEEL_SPEED, RobotModel,
};

/// What rounding may add, relative to a limit; positions \[m, rad\].
const ROUNDING: f64 = 1e-9;

/// How much of each limit was left at the worst tick, as a fraction of the limit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Margins {
    /// Distance from the nearer position limit over half the range.
    pub position: f64,
    /// Of joint velocities and ẋ_d.
    pub velocity: f64,
    /// Of joint accelerations and ẍ_d.
    pub acceleration: f64,
}

impl Margins {
    fn full() -> Self {
        Self { position: 1.0, velocity: 1.0, acceleration: 1.0 }
    }

    /// The smallest of all.
    pub fn worst(&self) -> f64 {
        self.position.min(self.velocity).min(self.acceleration)
    }
}

/// Watches the commands of a run.
#[derive(Debug, Clone)]
pub struct LimitMonitor {
    joints: Vec<JointLimits>,
    desired: DesiredMotion,
    period: f64,
    joint_velocity: Vec<f64>,
    desired_twist: [f64; 6],
    /// Joints that started outside their position range and have not returned yet.
    outside: Vec<bool>,
    /// The worst so far.
    pub margins: Margins,
    /// Ticks with a limit violated.
    pub violations: u64,
}

impl LimitMonitor {
    /// For a robot at rest at `configuration`.
    pub fn new(
        model: &RobotModel,
        desired: DesiredMotion,
        period: f64,
        configuration: &[f64],
    ) -> Self {
        let joints = model.limits().to_vec();
        let outside = joints
            .iter()
            .zip(configuration)
            .map(|(limits, q)| !(limits.lower..=limits.upper).contains(q))
            .collect();
        Self {
            joint_velocity: vec![0.0; joints.len()],
            desired_twist: [0.0; 6],
            joints,
            desired,
            period,
            outside,
            margins: Margins::full(),
            violations: 0,
        }
    }

    /// Checks a command and the configuration it leads to.
    pub fn check(&mut self, command: &Command, configuration: &[f64]) {
        let mut margins = Margins::full();
        let mut finite = true;
        for (index, (limits, &q)) in self.joints.iter().zip(configuration).enumerate() {
            let velocity = command.joint_velocity[index];
            let acceleration = (velocity - self.joint_velocity[index]) / self.period;
            finite &= q.is_finite() && velocity.is_finite();
            let inside = (limits.lower..=limits.upper).contains(&q);
            self.outside[index] &= !inside;
            if limits.upper.is_finite() && !self.outside[index] {
                let half = 0.5 * (limits.upper - limits.lower);
                let left = (limits.upper - q).min(q - limits.lower) / half;
                margins.position = margins.position.min(left);
            }
            margins.velocity = margins.velocity.min(1.0 - velocity.abs() / limits.velocity);
            margins.acceleration =
                margins.acceleration.min(1.0 - acceleration.abs() / limits.acceleration);
            self.joint_velocity[index] = velocity;
        }
        for (index, &velocity) in command.desired_twist.iter().enumerate() {
            let acceleration = (velocity - self.desired_twist[index]) / self.period;
            finite &= velocity.is_finite();
            let (most, change) = if index < 3 {
                (self.desired.velocity, self.desired.acceleration)
            } else {
                (self.desired.angular_velocity, self.desired.angular_acceleration)
            };
            margins.velocity = margins.velocity.min(1.0 - velocity.abs() / most);
            margins.acceleration = margins.acceleration.min(1.0 - acceleration.abs() / change);
            self.desired_twist[index] = velocity;
        }
        if self.joints.len() > MOCA_BASE_JOINTS {
            let [x, y, turn] = command.base_twist;
            let wheels = x.abs() + y.abs() + MOCA_WHEEL_LEVER * turn.abs();
            let axis = x.abs().max(y.abs());
            margins.velocity = margins.velocity.min(1.0 - wheels / MOCA_WHEEL_SPEED);
            margins.velocity = margins.velocity.min(1.0 - axis / MOCA_AXIS_SPEED);
        }
        let rounding = [-ROUNDING, -ROUNDING, -ROUNDING / self.period];
        let kept = margins.position >= rounding[0]
            && margins.velocity >= rounding[1]
            && margins.acceleration >= rounding[2];
        self.violations += u64::from(!(kept && finite));
        self.margins.position = self.margins.position.min(margins.position);
        self.margins.velocity = self.margins.velocity.min(margins.velocity);
        self.margins.acceleration = self.margins.acceleration.min(margins.acceleration);
    }
}
