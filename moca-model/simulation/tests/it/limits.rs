//! The check of limits finds every violation that is made by hand, of the right kind and no other.

use std::sync::LazyLock;

use ergo_map::ErgonomicsQuadratic;
use moca_model::whole_body::Model;
use moca_model::whole_body::robot::JointLimits;
use moca_model::{
    Command, Controller, ControllerSettings, DesiredMotion, MOCA_AXIS_SPEED, MOCA_HOME, MOCA_URDF,
    MOCA_WHEEL_LEVER, MOCA_WHEEL_SPEED, moca, moca_description,
};
use moca_simulation::judges::{Breaches, LimitMonitor, Margins, Return};
use nalgebra::{Matrix3, Vector3, Vector6};
use proptest::prelude::*;

const PERIOD: f64 = 0.001;
const DESIRED: DesiredMotion = DesiredMotion {
    velocity: 0.5,
    acceleration: 4.5,
    angular_velocity: 1.0,
    angular_acceleration: 9.0,
};
const NOTHING: Breaches = Breaches {
    limit: false,
    range: false,
    acceleration: false,
    jerk: false,
    desired_acceleration: false,
};
const LIMIT: Breaches = Breaches { limit: true, ..NOTHING };
const RANGE: Breaches = Breaches { range: true, ..NOTHING };
const ACCELERATION: Breaches = Breaches { acceleration: true, ..NOTHING };
const DESIRED_ACCELERATION: Breaches = Breaches { desired_acceleration: true, ..NOTHING };

const JERK: Breaches = Breaches { jerk: true, ..NOTHING };

fn settings() -> ControllerSettings {
    ControllerSettings { period: PERIOD, desired: DESIRED, ..ControllerSettings::default() }
}

/// MOCA without jerk limits, and a command at rest.
static AT_REST: LazyLock<(Model, Command)> = LazyLock::new(|| {
    let mut description = moca_description();
    for (_, limits) in &mut description.limits {
        limits.jerk = None;
    }
    let model = Model::from_urdf(MOCA_URDF, &description).unwrap();
    let ergonomics = ErgonomicsQuadratic::new(Matrix3::identity(), Vector3::zeros(), 0.0).unwrap();
    let settings = ControllerSettings::default();
    let controller = Controller::new(model.clone(), ergonomics, settings, &MOCA_HOME).unwrap();
    let command = controller.command().clone();
    (model, command)
});

/// Commands made by hand, from rest at home, and the monitor that checks them.
struct Hand {
    joints: Vec<JointLimits>,
    monitor: LimitMonitor,
    command: Command,
    q: Vec<f64>,
}

/// The change of velocities in a tick, as a share of the allowed change. Each joint's is in [-1, 1]; the linear and
/// angular parts of the desired pose have a norm of at most 1.
#[derive(Clone, Debug)]
struct Change {
    joints: Vec<f64>,
    desired: [Vector3<f64>; 2],
}

impl Hand {
    fn at(q: &[f64]) -> Self {
        let (model, command) = &*AT_REST;
        Self {
            joints: model.limits().to_vec(),
            monitor: LimitMonitor::new(model, &settings(), q),
            command: command.clone(),
            q: q.to_vec(),
        }
    }

    fn home() -> Self {
        Self::at(&MOCA_HOME)
    }

    /// Checks the present command; the robot then follows it.
    fn check(&mut self, returning: Return) -> Breaches {
        let breaches = self.monitor.check(&self.command, &self.q, returning);
        for (q, v) in self.q.iter_mut().zip(&self.command.joint_velocity) {
            *q += v * PERIOD;
        }
        breaches
    }

    /// Sets a velocity: of joints 0 to 9, of the desired pose 10 to 15.
    fn set(&mut self, index: usize, velocity: f64) {
        match index.checked_sub(10) {
            None => self.command.joint_velocity[index] = velocity,
            Some(axis) => self.command.desired_twist[axis] = velocity,
        }
    }

    /// Changes the velocities within the limits.
    fn change(&mut self, change: &Change) {
        for ((v, limits), share) in
            self.command.joint_velocity.iter_mut().zip(&self.joints).zip(&change.joints)
        {
            let next = *v + share * limits.acceleration * PERIOD;
            *v = next.clamp(-limits.velocity, limits.velocity);
        }
        let [linear, angular] = &change.desired;
        let step = Vector6::new(linear.x, linear.y, linear.z, angular.x, angular.y, angular.z);
        for (axis, v) in self.command.desired_twist.iter_mut().enumerate() {
            let (velocity, acceleration) = desired(axis);
            *v = (*v + step[axis] * acceleration * PERIOD).clamp(-velocity, velocity);
        }
    }
}

/// Speed and acceleration limits along or about an axis of the desired twist.
fn desired(axis: usize) -> (f64, f64) {
    if axis < 3 {
        (DESIRED.velocity, DESIRED.acceleration)
    } else {
        (DESIRED.angular_velocity, DESIRED.angular_acceleration)
    }
}

fn direction() -> impl Strategy<Value = Vector3<f64>> {
    prop::array::uniform3(-1.0..1.0_f64)
        .prop_map(Vector3::from)
        .prop_filter_map("a direction", |v| v.try_normalize(1e-3))
}

fn changes() -> impl Strategy<Value = Vec<Change>> {
    let part = || (direction(), 0.0..=1.0_f64).prop_map(|(direction, share)| direction * share);
    let change = (prop::collection::vec(-1.0..=1.0_f64, 10), [part(), part()])
        .prop_map(|(joints, desired)| Change { joints, desired });
    prop::collection::vec(change, 1..40)
}

/// Ratio by which a violation exceeds its limit, beginning just above rounding.
fn excess() -> impl Strategy<Value = f64> {
    (-4.0..1.0_f64).prop_map(|exponent| 1.0 + 10.0_f64.powf(exponent))
}

proptest! {
    /// Commands within the limits are not blamed, and later ones are judged as if alone.
    #[test]
    fn what_keeps_the_limits_breaks_none(changes in changes()) {
        let mut hand = Hand::home();
        for change in &changes {
            hand.change(change);
            prop_assert_eq!(hand.check(Return::Free), NOTHING);
        }
        prop_assert!(hand.monitor.margins().worst() >= -1e-6);
    }

    #[test]
    fn excessive_joint_acceleration_is_found(
        changes in changes(), joint in 0..10_usize, excess in excess(), forwards in any::<bool>(),
    ) {
        let mut hand = Hand::home();
        for change in &changes {
            hand.change(change);
            hand.check(Return::Free);
        }
        let step = hand.joints[joint].acceleration * PERIOD * excess;
        let v = &mut hand.command.joint_velocity[joint];
        // The step goes towards rest if there is no room in the other direction.
        *v += if forwards == (*v < 0.0) { step } else { -step };
        prop_assume!(v.abs() <= hand.joints[joint].velocity);
        prop_assert_eq!(hand.check(Return::Free), ACCELERATION);
        prop_assert!(hand.monitor.margins().acceleration < 0.0);
        prop_assert_eq!(hand.check(Return::Free), NOTHING);
    }

    /// The jerk limits of the arm's joints are 500 times their accelerations.
    #[test]
    fn too_high_a_jerk_is_found(
        joint in 0..10_usize, shares in prop::collection::vec(-0.5..=0.5_f64, 0..20),
        excess in excess(), forwards in any::<bool>(),
    ) {
        let (model, command) = (moca().unwrap(), &AT_REST.1);
        let mut monitor = LimitMonitor::new(&model, &settings(), &MOCA_HOME);
        let mut command = command.clone();
        let acceleration = model.limits()[joint].acceleration;
        // A tick gains at most half of the acceleration limit.
        let mut share = 0.0_f64;
        let mut next = |share: f64| {
            command.joint_velocity[joint] += share * acceleration * PERIOD;
            monitor.check(&command, &MOCA_HOME, Return::Free)
        };
        for change in shares {
            share = (share + change).clamp(-1.0, 1.0);
            prop_assert_eq!(next(share), NOTHING);
        }
        let change = if forwards == (share < 0.0) { 0.5 * excess } else { -0.5 * excess };
        prop_assume!((share + change).abs() <= 1.0);
        let expected = if joint < 3 { NOTHING } else { JERK };
        prop_assert_eq!(next(share + change), expected);
    }

    /// A command that starts anew outside must brake, and must find the robot there.
    #[test]
    fn restart_outside_needs_robot_there(
        joint in 3..10_usize, upwards in any::<bool>(), beyond in 1e-4..0.1_f64,
        apart in -2e-3..2e-3_f64, ticks in 1..10_usize,
    ) {
        let sign = if upwards { 1.0 } else { -1.0 };
        let start = |joints: &[JointLimits]| {
            let (lower, upper) = (joints[joint].lower, joints[joint].upper);
            if upwards { upper - 1e-3 } else { lower + 1e-3 }
        };
        let mut q = MOCA_HOME.to_vec();
        q[joint] = start(&Hand::home().joints);
        let mut hand = Hand::at(&q);
        let step = hand.joints[joint].acceleration * PERIOD;
        // It moves out slowly enough to stay within its range up to here.
        for _ in 0..ticks {
            hand.command.joint_velocity[joint] += 0.01 * sign * step;
            prop_assert_eq!(hand.check(Return::Free), NOTHING);
        }
        // The robot is found outside, and the command starts there.
        hand.q[joint] = start(&hand.joints) + sign * (1e-3 + beyond);
        let mut measured = hand.q.clone();
        measured[joint] += apart;
        hand.monitor.restart(&hand.q, &measured);
        let accepted = apart.abs() <= 1e-3;
        hand.command.joint_velocity[joint] -= 0.005 * sign * step;
        prop_assert_eq!(hand.check(Return::Hindered).range, !accepted);
        prop_assume!(accepted);
        // No later tick may lead farther out than its predecessor, and none after rest.
        hand.command.joint_velocity[joint] += 0.001 * sign * step;
        prop_assert!(hand.check(Return::Hindered).range);
        hand.command.joint_velocity[joint] = 0.0;
        prop_assert_eq!(hand.check(Return::Hindered), NOTHING);
        hand.command.joint_velocity[joint] = 1e-3 * sign * step;
        prop_assert!(hand.check(Return::Hindered).range);
    }

    /// Noise of a measurement excuses no command that leads out of the range.
    #[test]
    fn steady_command_cannot_restart(joint in 3..10_usize, noise in -1e-3..1e-3_f64) {
        let mut q = MOCA_HOME.to_vec();
        q[joint] = Hand::home().joints[joint].upper - 1e-6;
        let mut hand = Hand::at(&q);
        hand.command.joint_velocity[joint] = 0.5e-3;
        prop_assert_eq!(hand.check(Return::Free), NOTHING);
        for _ in 0..10 {
            let mut measured = hand.q.clone();
            measured[joint] += noise;
            let out = hand.q[joint] + 0.5e-6 > hand.joints[joint].upper + 1e-9;
            hand.monitor.restart(&hand.q, &measured);
            prop_assert_eq!(hand.check(Return::Free).range, out);
        }
    }

    /// The norm counts, even if no axis alone exceeds the limit.
    #[test]
    fn excessive_desired_acceleration_is_found(
        changes in changes(), direction in direction(), excess in excess(), angular in any::<bool>(),
    ) {
        let mut hand = Hand::home();
        for change in &changes {
            hand.change(change);
            hand.check(Return::Free);
        }
        let at = if angular { 3 } else { 0 };
        let (velocity, acceleration) = desired(at);
        let mut part = hand.command.desired_twist.fixed_rows_mut::<3>(at);
        part += direction * (acceleration * PERIOD * excess);
        prop_assume!(part.amax() <= velocity);
        prop_assert_eq!(hand.check(Return::Free), DESIRED_ACCELERATION);
        prop_assert!(hand.monitor.margins().acceleration < 0.0);
        prop_assert_eq!(hand.check(Return::Free), NOTHING);
    }

    /// Only the speed is too high: it is reached within the acceleration limits.
    #[test]
    fn too_high_a_speed_is_found(index in 0..16_usize, excess in excess(), forwards in any::<bool>()) {
        let mut hand = Hand::home();
        let (limit, acceleration) = match index.checked_sub(10) {
            None => (hand.joints[index].velocity, hand.joints[index].acceleration),
            Some(axis) => desired(axis),
        };
        let sign = if forwards { 1.0 } else { -1.0 };
        let step = acceleration * PERIOD;
        let mut speed = 0.0;
        while speed < limit {
            speed = (speed + step).min(limit);
            hand.set(index, sign * speed);
            prop_assert_eq!(hand.check(Return::Free), NOTHING);
            // The position stays at home, since only the speed matters here.
            hand.q = MOCA_HOME.to_vec();
        }
        hand.set(index, sign * (limit * excess).min(limit + step));
        prop_assert_eq!(hand.check(Return::Free), LIMIT);
        prop_assert!(hand.monitor.margins().velocity < 0.0);
    }

    /// The wheels may be too fast even if each axis of the base is slow enough.
    #[test]
    fn too_fast_wheels_are_found(shares in prop::array::uniform3(0.05..1.0_f64), excess in 1.0001..1.1_f64) {
        let mut hand = Hand::home();
        let total: f64 = shares.iter().sum();
        let [x, y, turn] = shares.map(|share| share / total * MOCA_WHEEL_SPEED);
        prop_assume!(x.max(y) * excess <= MOCA_AXIS_SPEED);
        hand.command.base_twist = [x, -y, turn / MOCA_WHEEL_LEVER];
        prop_assert_eq!(hand.check(Return::Free), NOTHING);
        hand.command.base_twist = hand.command.base_twist.map(|v| v * excess);
        prop_assert_eq!(hand.check(Return::Free), LIMIT);
    }

    #[test]
    fn leaving_the_range_is_found(joint in 3..10_usize, up in any::<bool>(), speed in 0.01..1.0_f64) {
        let limits = AT_REST.0.limits()[joint];
        let mut q = MOCA_HOME.to_vec();
        q[joint] = if up { limits.upper } else { limits.lower };
        let mut hand = Hand::at(&q);
        prop_assert_eq!(hand.check(Return::Free), NOTHING);
        // The speed is low enough for the acceleration limit.
        let v = speed * limits.acceleration * PERIOD;
        hand.command.joint_velocity[joint] = if up { v } else { -v };
        prop_assert_eq!(hand.check(Return::Free), RANGE);
        prop_assert!(hand.monitor.margins().position < 0.0);
    }

    /// A joint that starts outside may stand and return, but not go farther.
    #[test]
    fn going_farther_out_is_found(joint in 3..10_usize, up in any::<bool>(), beyond in 1e-3..0.2_f64) {
        let limits = AT_REST.0.limits()[joint];
        let (from, outwards) = if up { (limits.upper, 1.0) } else { (limits.lower, -1.0) };
        let mut q = MOCA_HOME.to_vec();
        q[joint] = from + outwards * beyond;
        let step = limits.acceleration * PERIOD;
        let after = |v: f64| {
            let mut hand = Hand::at(&q);
            hand.command.joint_velocity[joint] = v;
            (hand.check(Return::Free), hand.monitor.margins())
        };
        prop_assert_eq!(after(0.0).0, NOTHING);
        prop_assert_eq!(after(-outwards * step).0, NOTHING);
        prop_assert_eq!(after(outwards * step).0, RANGE);
        prop_assert!(after(0.0).1.position > 0.0);
    }

    #[test]
    fn a_number_that_is_not_finite_is_found(
        index in 0..19_usize, value in prop::sample::select(vec![f64::NAN, f64::INFINITY]),
    ) {
        let mut hand = Hand::home();
        match index {
            0..16 => hand.set(index, value),
            _ => hand.command.base_twist[index - 16] = value,
        }
        prop_assert!(hand.check(Return::Free).any());
    }
}

/// A check by axes would accept this: 4.5 m/s² along each of three axes are 7.8 m/s².
#[test]
fn three_axes_at_their_limits_violate_norm() {
    let mut hand = Hand::home();
    let most = DESIRED.acceleration * PERIOD;
    hand.command.desired_twist = Vector6::new(most, most, most, 0.0, 0.0, 0.0);
    assert_eq!(hand.check(Return::Free), DESIRED_ACCELERATION);
    let worst = hand.monitor.margins().acceleration;
    assert!((worst - (1.0 - 3.0_f64.sqrt())).abs() < 1e-9, "{worst}");
}

#[test]
fn joint_outside_must_return_unless_hindered() {
    let ticks_until_found = |returning| {
        let mut q = MOCA_HOME.to_vec();
        q[6] = 0.1; // the fourth joint of the arm ends at -0.0698 rad
        let mut hand = Hand::at(&q);
        (1..=6000).find(|_| hand.check(returning).any())
    };
    assert!((4999..=5001).contains(&ticks_until_found(Return::Free).unwrap()));
    assert_eq!(ticks_until_found(Return::Hindered), None);
}

/// A joint that has returned into its range is like any other.
#[test]
fn returned_joint_may_not_leave_again() {
    let mut q = MOCA_HOME.to_vec();
    let mut hand = Hand::home();
    let JointLimits { upper, acceleration, .. } = hand.joints[6];
    q[6] = upper + 1e-6;
    hand = Hand::at(&q);
    let step = acceleration * PERIOD;
    for v in [-step, 0.0] {
        hand.set(6, v);
        assert_eq!(hand.check(Return::Free), NOTHING);
    }
    assert!(hand.q[6] < upper);
    hand.q[6] = upper;
    hand.set(6, step);
    assert_eq!(hand.check(Return::Free), RANGE);
    let Margins { position, .. } = hand.monitor.margins();
    assert!(position < 0.0, "{position}");
}
