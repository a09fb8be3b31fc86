//! Simulated robots move as rigid bodies, and contacts act on them.

use std::sync::LazyLock;

use nalgebra::Vector3;
use serde_json::Value;
use whole_body::robot::LimitOverride;
use whole_body::simulation::{
    Contact, JointDrive, RandomSource, RigidBodySimulation, SensorSettings, Sensors, Transmission,
};
use whole_body::{Base, Data, Description, Error, Model};

use crate::momentum::{HOME, arm};
use crate::support::stacks::Random;

const PERIOD: f64 = 1e-3;

static GOLDEN: LazyLock<Value> =
    LazyLock::new(|| serde_json::from_str(include_str!("../golden/simulation.json")).unwrap());

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|number| number.as_f64().unwrap()).collect()
}

/// The largest difference from Pinocchio in a second \[rad\].
fn difference(case: &Value, substeps: u32) -> f64 {
    let model = arm(case["friction"].as_bool().unwrap());
    let drives: Vec<_> = numbers(&case["rotors"])
        .into_iter()
        .map(|rotor_inertia| JointDrive::Torque { rotor_inertia })
        .collect();
    let start = numbers(&case["start"]);
    let mut robot =
        RigidBodySimulation::new(&model, &drives, &start).unwrap().with_substeps(substeps).unwrap();
    let ticks = GOLDEN["hold_ms"].as_u64().unwrap();
    let mut most = 0.0_f64;
    let torques = case["torques"].as_array().unwrap().iter();
    for (torques, expected) in torques.zip(case["positions"].as_array().unwrap()) {
        for _ in 0..ticks {
            robot.step(&numbers(torques), &[], PERIOD).unwrap();
        }
        for (q, expected) in robot.position().iter().zip(numbers(expected)) {
            most = most.max((q - expected).abs());
        }
    }
    most
}

#[test]
fn a_second_of_random_torques_is_pinocchios() {
    // The last joint reaches 60 rad/s without rotors and friction.
    for (case, substeps) in GOLDEN["cases"].as_array().unwrap().iter().zip([4, 1, 1]) {
        let most = difference(case, substeps);
        assert!(most < 1e-6, "{most} rad");
        let finer = difference(case, 2 * substeps);
        assert!(finer < 0.15 * most, "fourth order: {most} to {finer} rad");
    }
}

#[test]
fn energy_stays_where_nothing_takes_it() {
    let model = arm(false);
    let mut robot = RigidBodySimulation::new(&model, &[JointDrive::TORQUE; 7], &HOME).unwrap();
    let mut data = Data::new(&model);
    let mut energy = |robot: &RigidBodySimulation| {
        let posed = data.pose(&model, robot.position()).unwrap();
        let potential = posed.potential_energy();
        posed.moving(robot.velocity()).unwrap().kinetic_energy() + potential
    };
    let start = energy(&robot);
    for _ in 0..300 {
        robot.step(&[0.0; 7], &[], PERIOD).unwrap();
    }
    assert!(robot.velocity().iter().any(|v| v.abs() > 1.0), "it falls");
    assert!((energy(&robot) - start).abs() < 1e-5, "{} J", energy(&robot) - start);
}

/// MOCA's arm on a planar base.
fn mobile() -> Model {
    let unlimited = || LimitOverride::of_speed(1.5, 0.6);
    let description = Description {
        root: Some("panda_link0".into()),
        tips: vec!["panda_tcp".into()],
        ..Description::on_planar_base(unlimited(), unlimited())
    };
    Model::from_urdf(include_str!("../../examples/urdf/moca.urdf"), &description).unwrap()
}

#[test]
fn arm_reacts_to_velocity_of_its_base() {
    let model = mobile();
    assert_eq!(model.base(), Base::Planar);
    let mut drives = [JointDrive::TORQUE; 10];
    drives[..3].fill(JointDrive::Velocity { time_constant: 0.05 });
    let mut start = [0.0; 10];
    start[3..].copy_from_slice(&HOME);
    let mut robot = RigidBodySimulation::new(&model, &drives, &start).unwrap();
    let mut data = Data::new(&model);
    let mut command = [0.0; 10];
    data.pose(&model, &start).unwrap().gravity_into(&mut command).unwrap();
    command[0] = 0.5;
    robot.step(&command, &[], PERIOD).unwrap();
    // M_ab q̈_b = −M_aa q̈_a: the arm stays behind.
    let acceleration = 0.5 / 0.05;
    let mut expected = [0.0; 10];
    let mut moving = data.pose(&model, &start).unwrap().moving(&[0.0; 10]).unwrap();
    let mut along = [0.0; 10];
    for (entry, (of_robot, before)) in along.iter_mut().zip(robot.velocity().iter().zip([0.0; 10]))
    {
        *entry = (of_robot - before) / PERIOD;
    }
    moving.inverse_dynamics_into(&along, &[], &mut expected).unwrap();
    for joint in 3..10 {
        assert!((expected[joint] - command[joint]).abs() < 0.05, "joint {joint} gets its torque");
    }
    assert!(along[4..].iter().any(|a| a.abs() > 1.0) && (along[0] - acceleration).abs() < 0.2);
    for _ in 0..49 {
        robot.step(&command, &[], PERIOD).unwrap();
    }
    assert!((robot.velocity()[0] - 0.5 * (1.0 - (-1.0_f64).exp())).abs() < 1e-6);
}

#[test]
fn a_collision_is_that_of_two_masses() {
    let model = arm(false);
    let tool = model.frame_id("panda_tcp").unwrap();
    let mut data = Data::new(&model);
    for (mass, stiffness) in [(0.6, 75e3), (2.0, 40e3), (40.0, 25e3)] {
        let mut posed = data.pose(&model, &HOME).unwrap();
        let normal = Vector3::x_axis();
        let own = posed.effective_mass(tool, &normal).unwrap();
        let point = posed.world_from(tool).unwrap().translation.vector.dot(&normal);
        let mut torque = [0.0; 7];
        posed.gravity_into(&mut torque).unwrap();
        let mut robot = RigidBodySimulation::new(&model, &[JointDrive::TORQUE; 7], &HOME)
            .unwrap()
            .with_substeps(4)
            .unwrap();
        let speed = 0.25;
        robot.contacts_mut().push(Contact::body(tool, normal, [point, speed], [mass, stiffness]));
        for _ in 0..60 {
            robot.step(&torque, &[], PERIOD).unwrap();
        }
        let reduced = 1.0 / (1.0 / mass + 1.0 / own);
        let expected = speed * (stiffness * reduced).sqrt();
        let contact = robot.contacts()[0];
        assert!((contact.peak_force - expected).abs() < 0.02 * expected, "{contact:?} {expected}");
        assert_eq!(contact.force, 0.0, "they have parted");
        // The robot bounces off by the laws of elastic impact.
        let after = speed * (mass - own) / (mass + own);
        assert!((contact.velocity - after).abs() < 0.05 * speed, "{} {after}", contact.velocity);
    }
}

#[test]
fn torques_stay_within_the_effort_limits() {
    let model = arm(false);
    let efforts: Vec<f64> = model.limits().iter().map(|limits| limits.effort).collect();
    let run = |torque: &[f64]| {
        let mut robot = RigidBodySimulation::new(&model, &[JointDrive::TORQUE; 7], &HOME).unwrap();
        robot.step(torque, &[], PERIOD).unwrap();
        assert_eq!(robot.torque(), efforts, "what the sensor says");
        robot.velocity().to_vec()
    };
    assert_eq!(run(&[1e4; 7]), run(&efforts));
}

pub(crate) struct Noise(pub(crate) Random);

impl RandomSource for Noise {
    /// The sum of twelve uniform numbers minus six is nearly normal.
    fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.0.unit()).sum::<f64>() - 6.0
    }

    fn uniform(&mut self) -> f64 {
        self.0.unit()
    }
}

#[test]
fn sensors_are_noisy_late_and_lossy_and_repeatable() {
    let model = arm(false);
    let settings = SensorSettings {
        position_noise: vec![1e-3; 7],
        loss: 0.2,
        delay: 2,
        ..SensorSettings::ideal(&model)
    };
    let run = |seed| {
        let mut robot = RigidBodySimulation::new(&model, &[JointDrive::TORQUE; 7], &HOME).unwrap();
        let mut sensors = Sensors::new(settings.clone(), &HOME).unwrap();
        let mut noise = Noise(Random(seed));
        let (mut measured, mut truth) = (Vec::new(), Vec::new());
        for _ in 0..400 {
            robot.step(&[0.0; 7], &[], PERIOD).unwrap();
            sensors.measure(&robot, &mut noise).unwrap();
            measured.push((sensors.position()[3], sensors.velocity()[3]));
            truth.push((robot.position()[3], robot.velocity()[3]));
        }
        (measured, truth)
    };
    let (measured, truth) = run(1);
    assert_eq!(run(1).0, measured, "the same seed, the same bits");
    assert_ne!(run(2).0, measured);
    let repeated = measured.windows(2).filter(|pair| pair[0] == pair[1]).count();
    assert!((50..110).contains(&repeated), "a fifth is lost: {repeated}");
    // Velocities are exact here: each is that of two ticks before, or older.
    for (tick, (_, velocity)) in measured.iter().enumerate().skip(10) {
        let age = (2..9).find(|age| truth[tick - age].1 == *velocity);
        assert!(age.is_some(), "tick {tick}");
    }
    let errors: Vec<f64> = (10..400)
        .filter(|&tick| truth[tick - 2].1 == measured[tick].1)
        .map(|tick| measured[tick].0 - truth[tick - 2].0)
        .collect();
    let mean_square = errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64;
    assert!((mean_square.sqrt() - 1e-3).abs() < 2e-4, "{}", mean_square.sqrt());
}

#[test]
fn what_cannot_be_simulated() {
    let model = arm(false);
    let new = |drives: &[JointDrive]| RigidBodySimulation::new(&model, drives, &HOME);
    assert!(matches!(new(&[JointDrive::TORQUE; 6]), Err(Error::Size { wanted: 7, .. })));
    for time_constant in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let bad = new(&[JointDrive::Velocity { time_constant }; 7]);
        assert!(matches!(bad, Err(Error::Value { .. })));
    }
    assert!(new(&[JointDrive::Torque { rotor_inertia: -0.1 }; 7]).is_err());
    assert!(new(&[JointDrive::TORQUE; 7]).unwrap().with_substeps(0).is_err());
    let floating = Description { base: Base::Floating, ..Description::default() };
    let humanoid = Model::from_urdf(include_str!("../golden/humanoid.urdf"), &floating).unwrap();
    let drives = vec![JointDrive::TORQUE; humanoid.velocity_count()];
    let error = RigidBodySimulation::new(&humanoid, &drives, &humanoid.neutral()).unwrap_err();
    assert!(matches!(error, Error::Unsuitable { .. }));
    let fingers = include_str!("../golden/two_arms.urdf");
    let fingers = Model::from_urdf(fingers, &Description::default()).unwrap();
    let drives = vec![JointDrive::TORQUE; fingers.velocity_count()];
    let error = RigidBodySimulation::new(&fingers, &drives, &fingers.neutral()).unwrap_err();
    assert!(matches!(error, Error::Unsuitable { .. }));

    let mut robot = new(&[JointDrive::TORQUE; 7]).unwrap();
    assert!(robot.step(&[0.0; 6], &[], PERIOD).is_err());
    assert!(robot.step(&[f64::NAN; 7], &[], PERIOD).is_err());
    assert!(robot.step(&[0.0; 7], &[], 0.0).is_err());
    let tool = model.frame_id("panda_tcp").unwrap();
    robot.contacts_mut().push(Contact { mass: 0.0, ..Contact::wall(tool, Vector3::x_axis(), 0.0) });
    assert!(matches!(robot.step(&[0.0; 7], &[], PERIOD), Err(Error::Value { .. })));
    assert_eq!((robot.position(), robot.velocity()), (&HOME[..], &[0.0; 7][..]));
    assert!(Transmission::new(0, 1.5, &[]).is_err());
    let noise = SensorSettings { position_noise: vec![-1.0; 7], ..SensorSettings::ideal(&model) };
    assert!(Sensors::new(noise, &HOME).is_err());
}
