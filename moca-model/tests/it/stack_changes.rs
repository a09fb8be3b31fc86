//! Changes in the stack of tasks do not make the command jump. Working together begins and ends, and ergonomics fade in
//! and out. People enter and leave the protective distance, and contacts are permitted or not.

use ergo_map::ErgonomicsQuadratic;
use moca_model::{Controller, ControllerSettings, Error, MOCA_HOME, SimulatedRobot, moca_safety};
use nalgebra::{Matrix3, Vector3, Vector6};
use proptest::prelude::*;
use vision_models::{Action, Tool};

use crate::drive::{FRAME, PERIOD, doing};
use crate::shared::MOCA;

/// The state of the stack for some time.
#[derive(Debug, Clone)]
struct Change {
    action: Action,
    /// Place of the person's trunk \[m\]; `None` if nobody is seen.
    person: Option<f64>,
    /// True if external forces would be noticed, so that contacts are permitted.
    measures_force: bool,
    ticks: u32,
}

fn change() -> impl Strategy<Value = Change> {
    let action = prop::sample::select(vec![
        Action::Using(Tool::Drill),
        Action::Using(Tool::Polisher),
        Action::DeliverObject,
        Action::Walking,
    ]);
    (action, prop::option::weighted(0.8, 0.8..2.0_f64), any::<bool>(), 200..900_u32).prop_map(
        |(action, person, measures_force, ticks)| Change { action, person, measures_force, ticks },
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    /// Velocities change by at most the accelerations in each tick, and accelerations of the arm by at most its jerks.
    #[test]
    fn stack_changes_never_make_command_jump(
        changes in prop::collection::vec(change(), 3..7), keeps_distance in any::<bool>(),
    ) {
        let hessian = Matrix3::from_diagonal(&Vector3::new(10.0, 5.0, 7.0));
        let best = Vector3::new(0.42, -0.1, 1.1);
        let ergonomics = ErgonomicsQuadratic::new(hessian, -(hessian * best), 8.0).unwrap();
        let safety = if keeps_distance { moca_safety() } else { moca_safety().off() };
        let settings = ControllerSettings { safety, ..ControllerSettings::default() };
        let desired = settings.desired;
        let mut controller = Controller::new(MOCA.clone(), ergonomics, settings, &MOCA_HOME).unwrap();
        let mut robot = SimulatedRobot::new(&MOCA, &MOCA_HOME).unwrap();
        let limits = MOCA.limits();
        let (mut velocity, mut acceleration) = (vec![0.0; 10], vec![0.0; 10]);
        let (mut twist, mut moved, mut tick) = (Vector6::zeros(), false, 0_u32);
        for Change { action, person, measures_force, ticks } in changes {
            for _ in 0..ticks {
                let now = f64::from(tick) * PERIOD;
                if tick.is_multiple_of(FRAME) {
                    let seen = controller.observe(doing(action, now, person));
                    // A person who jumps is only accepted from the next frame on.
                    prop_assert!(matches!(seen, Ok(()) | Err(Error::Safety(hrsw_safety::Error::BodySpeed { .. }))), "{seen:?}");
                }
                if measures_force {
                    controller.set_external_force(0.0);
                }
                let command = controller.step(now, robot.position()).unwrap();
                for (joint, limits) in limits.iter().enumerate() {
                    let change = (command.joint_velocity[joint] - velocity[joint]) / PERIOD;
                    prop_assert!(change.abs() <= limits.acceleration * (1.0 + 1e-6));
                    let jerk = (change - acceleration[joint]) / PERIOD;
                    prop_assert!(jerk.abs() <= limits.jerk * (1.0 + 1e-6), "{joint} at {tick}: {jerk}");
                    (velocity[joint], acceleration[joint]) = (command.joint_velocity[joint], change);
                }
                let change = (command.desired_twist - twist) / PERIOD;
                let (linear, angular) = (change.fixed_rows::<3>(0), change.fixed_rows::<3>(3));
                prop_assert!(linear.norm() <= desired.acceleration * (1.0 + 1e-6));
                prop_assert!(angular.norm() <= desired.angular_acceleration * (1.0 + 1e-6));
                twist = command.desired_twist;
                moved |= twist.norm() > 0.05;
                robot.step(&velocity, PERIOD).unwrap();
                tick += 1;
            }
        }
        // Otherwise the case tests nothing.
        prop_assert!(moved || keeps_distance);
    }
}
