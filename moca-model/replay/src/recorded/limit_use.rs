//! Use of each limit.

use moca_model::whole_body::Model;
use moca_model::whole_body::robot::JointLimits;
use moca_model::{Command, ControllerSettings, DesiredMotion, MecanumBase};

/// Greatest shares of limits since the last call of `take`; 1 is at the limit.
#[derive(Clone, Debug)]
pub(super) struct LimitUse {
    joints: Vec<JointLimits>,
    desired: DesiredMotion,
    base: Option<MecanumBase>,
    period: f64,
    velocity: Vec<f64>,
    shares: Vec<f32>,
}

impl LimitUse {
    pub(super) fn new(model: &Model, settings: &ControllerSettings) -> Self {
        let &ControllerSettings { desired, base, period, .. } = settings;
        let joints = model.limits().to_vec();
        let count = columns(model, base.is_some()).len();
        Self {
            velocity: vec![0.0; joints.len()],
            shares: vec![0.0; count],
            joints,
            desired,
            base,
            period,
        }
    }

    /// Adds the command of a tick and the configuration at which it was given.
    #[expect(clippy::cast_possible_truncation, reason = "f32 is what is kept")]
    pub(super) fn update(&mut self, command: &Command, configuration: &[f64]) {
        let Self { joints, desired, base, period, velocity, shares } = self;
        let mut shares = shares.iter_mut();
        let mut raise = |share: f64| {
            if let Some(most) = shares.next() {
                *most = most.max(share as f32);
            }
        };
        let commanded = &command.joint_velocity;
        for (limits, v) in joints.iter().zip(commanded) {
            raise(v.abs() / limits.velocity);
        }
        for ((limits, v), last) in joints.iter().zip(commanded).zip(velocity.iter_mut()) {
            raise((v - *last).abs() / *period / limits.acceleration);
            *last = *v;
        }
        for (limits, q) in joints.iter().zip(configuration) {
            if limits.upper.is_finite() {
                let middle = 0.5 * (limits.lower + limits.upper);
                raise((q - middle).abs() / (0.5 * (limits.upper - limits.lower)));
            }
        }
        if let Some(base) = base {
            let [x, y, turn] = command.base_twist.map(f64::abs);
            raise((x + y + base.lever * turn) / base.speed);
        }
        let twist = &command.desired_twist;
        raise(twist.fixed_rows::<3>(0).amax() / desired.velocity);
        raise(twist.fixed_rows::<3>(3).amax() / desired.angular_velocity);
    }

    /// Returns true if the robot has wheels.
    pub(super) fn is_of_wheels(&self) -> bool {
        self.base.is_some()
    }

    /// Appends the greatest shares since the last call to `row`, and starts anew.
    pub(super) fn take(&mut self, row: &mut Vec<f32>) {
        row.append(&mut self.shares.clone());
        self.shares.fill(0.0);
    }
}

/// Returns the names of the shares in their order, for a robot with or without wheels.
pub(super) fn columns(model: &Model, on_wheels: bool) -> Vec<String> {
    let (names, limits) = (model.velocity_names(), model.limits());
    let of = |what: &'static str| names.iter().map(move |name| format!("{name} {what}"));
    let ranged = names.iter().zip(limits).filter(|(_, limits)| limits.upper.is_finite());
    let ranges = ranged.map(|(name, _)| format!("{name} range"));
    let wheels = on_wheels.then(|| "wheels speed".to_owned());
    let desired = ["desired pose speed", "desired pose turning"].map(str::to_owned);
    of("speed").chain(of("acceleration")).chain(ranges).chain(wheels).chain(desired).collect()
}
