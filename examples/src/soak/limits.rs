//! Whether commands keep the limits, by finite differences.

use moca_model::{
    Command, DesiredMotion, JointLimits, MOCA_AXIS_SPEED, MOCA_WHEEL_LEVER, MOCA_WHEEL_SPEED,
    RobotModel,
};
use nalgebra::{Vector3, Vector6};

/// What rounding may add, relative to a limit.
const ROUNDING: f64 = 1e-9;
/// How long a joint that starts outside its range may take to return while nothing stops it (s).
const RETURN_TIME: f64 = 5.0;

/// What a command broke.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Breaks {
    pub(super) limit: bool,
    pub(super) acceleration: bool,
    pub(super) discontinuity: bool,
}

#[derive(Clone, Debug)]
pub(super) struct LimitCheck {
    joints: Vec<JointLimits>,
    desired: DesiredMotion,
    period: f64,
    velocity: Vec<f64>,
    twist: Vector6<f64>,
    /// How long each joint has been outside since the start (s); none for those that are within.
    outside: Vec<Option<f64>>,
}

impl LimitCheck {
    /// For a robot at rest.
    pub(super) fn new(
        model: &RobotModel,
        desired: DesiredMotion,
        period: f64,
        configuration: &[f64],
    ) -> Self {
        let joints = model.limits().to_vec();
        let outside = joints
            .iter()
            .zip(configuration)
            .map(|(limits, q)| (*q < limits.lower || *q > limits.upper).then_some(0.0))
            .collect();
        let velocity = vec![0.0; joints.len()];
        Self { joints, desired, period, velocity, twist: Vector6::zeros(), outside }
    }

    /// Takes a command and the configuration before it; `free` says that nothing else keeps a
    /// joint from returning within its range.
    pub(super) fn check(&mut self, command: &Command, configuration: &[f64], free: bool) -> Breaks {
        let mut breaks = Breaks::default();
        let velocities = command.joint_velocity.iter().zip(configuration);
        for (index, (limits, (&v, &q))) in self.joints.iter().zip(velocities).enumerate() {
            let step = v - self.velocity[index];
            breaks.limit |= v.abs() > limits.velocity * (1.0 + ROUNDING);
            breaks.acceleration |= step.abs() > limits.acceleration * self.period * (1.0 + 1e-6);
            let next = q + v * self.period;
            let beyond = (next - limits.upper).max(limits.lower - next);
            match &mut self.outside[index] {
                Some(_) if beyond <= 0.0 => self.outside[index] = None,
                Some(time) => {
                    // From rest there is no reason to go farther out, nor to stay for long.
                    let outwards = if next > limits.upper { v } else { -v };
                    breaks.limit |= outwards > ROUNDING;
                    *time += if free { self.period } else { 0.0 };
                    breaks.limit |= *time > RETURN_TIME;
                }
                None => breaks.limit |= beyond > ROUNDING,
            }
            self.velocity[index] = v;
        }
        let [x, y, turn] = command.base_twist;
        let wheels = x.abs() + y.abs() + MOCA_WHEEL_LEVER * turn.abs();
        breaks.limit |= wheels > MOCA_WHEEL_SPEED * (1.0 + ROUNDING);
        breaks.limit |= x.abs().max(y.abs()) > MOCA_AXIS_SPEED * (1.0 + ROUNDING);
        self.check_desired(&command.desired_twist, &mut breaks);
        breaks
    }

    fn check_desired(&mut self, twist: &Vector6<f64>, breaks: &mut Breaks) {
        let desired = &self.desired;
        let change = twist - self.twist;
        for (at, velocity, acceleration) in [
            (0, desired.velocity, desired.acceleration),
            (3, desired.angular_velocity, desired.angular_acceleration),
        ] {
            let part = |v: &Vector6<f64>| Vector3::new(v[at], v[at + 1], v[at + 2]);
            breaks.limit |= part(twist).amax() > velocity * (1.0 + ROUNDING);
            let step = acceleration * self.period;
            breaks.discontinuity |= part(&change).norm() > step * (1.0 + 1e-6);
        }
        self.twist = *twist;
    }
}
