//! External torques are found from the robot's momentum.

use nalgebra::Vector3;
use proptest::prelude::*;
use whole_body::robot::JointFriction;
use whole_body::simulation::{JointDrive, RigidBodySimulation};
use whole_body::state::ExternalWrench;
use whole_body::torque::{ContactForce, MomentumObserver, ObservedFriction, ObserverSettings};
use whole_body::{Axes, Data, Description, Error, Model};

use crate::support::robots_with_states;
use crate::support::stacks::Random;

const PERIOD: f64 = 1e-3;

/// MOCA's arm alone, with a Panda's friction.
pub(crate) fn arm(has_friction: bool) -> Model {
    let names = (1..=7).map(|joint| format!("panda_joint{joint}"));
    let friction = names.zip(JointFriction::PANDA).filter(|_| has_friction).collect();
    let description = Description {
        root: Some("panda_link0".into()),
        tips: vec!["panda_tcp".into()],
        friction,
        ..Description::default()
    };
    Model::from_urdf(include_str!("../../examples/urdf/moca.urdf"), &description).unwrap()
}

pub(crate) const HOME: [f64; 7] = [0.0, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785];

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// ṗ = τ + Cᵀ q̇ − g is checked by a difference along the motion, and p = M q̇.
    #[test]
    fn momentum_changes_by_torque_and_bias((robot, state) in robots_with_states()) {
        let model = robot.model();
        let n = model.velocity_count();
        let mut data = Data::new(&model);
        let (mut momentum, mut bias) = (vec![0.0; n], vec![0.0; n]);
        let (mut torque, mut mass) = (vec![0.0; n], nalgebra::DMatrix::zeros(n, n));
        let mut posed = data.pose(&model, &state.q).unwrap();
        posed.mass_matrix_into(&mut mass).unwrap();
        let mut moving = posed.moving(&state.v).unwrap();
        moving.inverse_dynamics_into(&state.a, &[], &mut torque).unwrap();
        moving.joint_momentum_into(&mut momentum, &mut bias).unwrap();
        let product = &mass * nalgebra::DVector::from_column_slice(&state.v);
        let size = 1.0 + momentum.iter().fold(0.0, |most: f64, p| most.max(p.abs()));
        for (momentum, product) in momentum.iter().zip(&product) {
            prop_assert!((momentum - product).abs() < 1e-11 * size);
        }
        let step = 1e-6;
        let mut after = |sign: f64| {
            let by: Vec<f64> = state.v.iter().zip(&state.a)
                .map(|(v, a)| sign * step * (v + 0.5 * sign * step * a)).collect();
            let v: Vec<f64> = state.v.iter().zip(&state.a).map(|(v, a)| v + sign * step * a).collect();
            let mut q = state.q.clone();
            model.integrate(&mut q, &by).unwrap();
            let mut moving = data.pose(&model, &q).unwrap().moving(&v).unwrap();
            let (mut momentum, mut bias) = (vec![0.0; n], vec![0.0; n]);
            moving.joint_momentum_into(&mut momentum, &mut bias).unwrap();
            momentum
        };
        let (ahead, behind) = (after(1.0), after(-1.0));
        let scale = 1.0 + torque.iter().chain(&bias).fold(0.0, |most: f64, t| most.max(t.abs()));
        for joint in 0..n {
            let rate = (ahead[joint] - behind[joint]) / (2.0 * step);
            prop_assert!((rate - torque[joint] - bias[joint]).abs() < 1e-5 * scale,
                "{joint}: {rate} is not {} + {}", torque[joint], bias[joint]);
        }
    }
}

/// Observes an arm under random torques for half a second. Returns the final estimate and the largest one.
fn observed(
    model: &Model,
    rotor_inertia: f64,
    friction: ObservedFriction,
    external: &[ExternalWrench],
    seed: u64,
) -> ([f64; 7], f64, RigidBodySimulation) {
    let drives = [JointDrive::Torque { rotor_inertia }; 7];
    let mut arm = RigidBodySimulation::new(model, &drives, &HOME).unwrap();
    let settings = ObserverSettings { friction, ..ObserverSettings::default() };
    let mut observer = MomentumObserver::new(model, settings).unwrap();
    let (mut data, mut random) = (Data::new(model), Random(seed));
    let (mut gravity, mut push) = ([0.0; 7], [0.0; 7]);
    let mut largest = 0.0_f64;
    // An arm that is pushed yields slowly, so that it hardly changes within the observer's lag.
    let damping = if external.is_empty() { 5.0 } else { 60.0 };
    for tick in 0..500 {
        if tick % 25 == 0 {
            push = std::array::from_fn(|joint| random.within(-1.0, 1.0) * [9.0, 2.0][joint / 4]);
        }
        let mut moving = data.pose(model, arm.position()).unwrap().moving(arm.velocity()).unwrap();
        let found = observer.update(&mut moving, arm.torque(), PERIOD).unwrap();
        largest = found.iter().fold(largest, |most, torque| most.max(torque.abs()));
        moving.posed_mut().gravity_into(&mut gravity).unwrap();
        let command: [f64; 7] = std::array::from_fn(|joint| {
            gravity[joint] + push[joint] - damping * arm.velocity()[joint]
        });
        arm.step(&command, external, PERIOD).unwrap();
    }
    (observer.torque().try_into().unwrap(), largest, arm)
}

#[test]
fn in_free_motion_nothing_is_found() {
    for seed in 0..3 {
        let (_, most, arm) = observed(&arm(false), 0.0, ObservedFriction::External, &[], seed);
        assert!(arm.velocity().iter().any(|v| v.abs() > 0.1), "it moves");
        assert!(most < 5e-3, "{most} Nm");
        // The arm has rotors and friction, a sensor behind the gear and a model of the friction.
        let (_, most, _) = observed(&self::arm(true), 0.2, ObservedFriction::Modelled, &[], seed);
        assert!(most < 5e-3, "{most} Nm");
        let (_, most, _) = observed(&self::arm(true), 0.2, ObservedFriction::External, &[], seed);
        assert!(most > 0.2, "unmodelled friction is found: {most} Nm");
    }
}

#[test]
fn constant_push_is_estimated_as_a_force() {
    let model = arm(true);
    let tool = model.frame_id("panda_tcp").unwrap();
    for (seed, force) in
        [Vector3::new(12.0, -7.0, 5.0), Vector3::new(0.0, 0.0, -30.0)].iter().enumerate()
    {
        let wrench = nalgebra::Vector6::new(force.x, force.y, force.z, 0.0, 0.0, 0.0);
        let external = [ExternalWrench { frame: tool, wrench }];
        let (found, _, arm) =
            observed(&model, 0.1, ObservedFriction::Modelled, &external, seed as u64);
        let mut data = Data::new(&model);
        let posed = data.pose(&model, arm.position()).unwrap();
        let mut jacobian = nalgebra::Matrix6xX::zeros(7);
        posed.jacobian_into(tool, Axes::World, &mut jacobian).unwrap();
        let expected = jacobian.transpose() * wrench;
        for joint in 0..7 {
            // The tolerance is what changed within the observer's lag of 20 ms.
            let apart = (found[joint] - expected[joint]).abs();
            assert!(apart < 0.03 * (1.0 + expected.amax()), "{joint}: {found:?} {expected}");
        }
        let mut contact = ContactForce::new(&model, tool, &[]).unwrap();
        let explained = contact.estimate(&posed, &found).unwrap();
        assert!((explained - force).norm() < 0.1 * force.norm(), "{explained} {force}");
    }
}

#[test]
fn estimate_follows_a_push_at_its_rate() {
    let model = arm(false);
    let settings = ObserverSettings { rates: vec![20.0; 7], ..ObserverSettings::default() };
    let mut observer = MomentumObserver::new(&model, settings).unwrap();
    let mut data = Data::new(&model);
    let mut gravity = [0.0; 7];
    // The motor of the second joint exerts 4 Nm too much, but the arm is at rest because somebody holds it.
    for _ in 0..51 {
        let mut moving = data.pose(&model, &HOME).unwrap().moving(&[0.0; 7]).unwrap();
        moving.posed_mut().gravity_into(&mut gravity).unwrap();
        gravity[1] += 4.0;
        observer.update(&mut moving, &gravity, PERIOD).unwrap();
    }
    let expected = -4.0 * (1.0 - (-1.0_f64).exp());
    assert!((observer.torque()[1] - expected).abs() < 0.05, "{}", observer.torque()[1]);
    observer.reset();
    assert_eq!(observer.torque(), [0.0; 7]);
}

#[test]
fn what_an_observer_cannot_use() {
    let model = arm(false);
    let new = |settings| MomentumObserver::new(&model, settings).unwrap_err();
    let default = ObserverSettings::default;
    let error = new(ObserverSettings { rates: vec![50.0; 3], ..default() });
    assert!(matches!(error, Error::Size { got: 3, wanted: 7, .. }));
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let error = new(ObserverSettings { rates: vec![bad; 7], ..default() });
        assert!(matches!(error, Error::Value { what, .. } if what == "the rate of joint 1"));
    }
    let error = new(ObserverSettings { joints: vec!["elbow".into()], ..default() });
    assert!(matches!(error, Error::UnknownName { .. }));
    let mut observer = MomentumObserver::new(&model, default()).unwrap();
    let mut data = Data::new(&model);
    let mut moving = data.pose(&model, &HOME).unwrap().moving(&[0.0; 7]).unwrap();
    assert!(observer.update(&mut moving, &[0.0; 6], PERIOD).is_err());
    assert!(observer.update(&mut moving, &[f64::NAN; 7], PERIOD).is_err());
    assert!(observer.update(&mut moving, &[0.0; 7], 0.0).is_err());
    assert_eq!(observer.torque(), [0.0; 7]);
}
