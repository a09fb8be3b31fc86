//! An arm near singular configurations.

use ergo_map::ErgonomicsQuadratic;
use hrsw::Attachment;
use moca_model::{Controller, ControllerSettings, Levels, MOCA_HOME, SimulatedRobot, moca_safety};
use nalgebra::{Isometry3, Matrix3, Matrix6xX, Vector3};

use crate::drive::percept;
use crate::shared::MOCA;

const PERIOD: f64 = 1e-3;
const BASE: usize = 3;

/// Result of a target for the tool that is out of reach.
struct Reach {
    /// Speed of the fastest joint of the arm over its limit, and the highest place of the tool \[m\], in the last two
    /// seconds.
    fastest: f64,
    height: f64,
    /// Largest w = √det(J Jᵀ) over its value at home, from singular values.
    nearness: f64,
}

/// w from singular values.
fn measure(jacobian: &Matrix6xX<f64>) -> f64 {
    jacobian.clone().svd(false, false).singular_values.iter().product()
}

/// Sets a target for the tool 2 m above its reach, for 8 s.
fn reach(levels: Levels) -> Reach {
    let mut robot = SimulatedRobot::new(&MOCA, &MOCA_HOME).unwrap();
    let ergonomics = ErgonomicsQuadratic::new(Matrix3::identity(), Vector3::zeros(), 1.0).unwrap();
    let safety = moca_safety().off();
    let settings = ControllerSettings { safety, levels, ..ControllerSettings::default() };
    let mut controller = Controller::new(MOCA.clone(), ergonomics, settings, &MOCA_HOME).unwrap();
    let workspace = controller.space().workspace();
    let (position, rotation) = (workspace.position(), workspace.world_from_workspace().rotation);
    let middle = (position.min() + position.max()) * 0.5;
    let place = Vector3::new(0.6, 0.0, 3.5);
    let pose = Isometry3::from_parts((place - rotation * middle).into(), rotation);
    controller.space_mut().assign(Some(Attachment::World(pose))).unwrap();
    let mut reach = Reach { fastest: 0.0, height: 0.0, nearness: 0.0 };
    let home = measure(controller.robot().jacobian());
    let mut before = vec![0.0; MOCA_HOME.len()];
    for tick in 0..8000_u32 {
        let time = f64::from(tick) * PERIOD;
        if tick.is_multiple_of(50) {
            controller.observe(percept(time, None)).unwrap();
        }
        controller.step(time, robot.position()).unwrap();
        let command = controller.command();
        assert!(command.outcome.is_optimal(), "{:?}", command.outcome);
        for ((now, before), limits) in command.joint_velocity.iter().zip(&before).zip(MOCA.limits())
        {
            assert!((now - before).abs() <= limits.acceleration * PERIOD * (1.0 + 1e-9));
        }
        before.clone_from(&command.joint_velocity);
        robot.step(&command.joint_velocity, PERIOD).unwrap();
        if tick >= 6000 {
            for (velocity, limits) in before.iter().zip(MOCA.limits()).skip(BASE) {
                reach.fastest = reach.fastest.max(velocity.abs() / limits.velocity);
            }
            reach.height = reach.height.max(controller.actual().translation.z);
            let now = measure(controller.robot().jacobian());
            reach.nearness = reach.nearness.max(now / home);
        }
    }
    reach
}

/// An arm that cannot reach its workspace comes as near as it can and is slow there, in either stack.
#[test]
fn arm_is_slow_at_its_reach_limit() {
    let (extended, paper) = (reach(Levels::Extended), reach(Levels::Paper));
    for Reach { fastest, nearness, .. } in [&extended, &paper] {
        assert!(*nearness < 0.35 * 0.05, "{nearness}");
        assert!(*fastest <= 0.05, "{fastest}");
    }
    assert!(extended.height > paper.height - 0.001, "{} m, {} m", extended.height, paper.height);
}
