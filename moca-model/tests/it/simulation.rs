//! The simulated robot follows its command as a first-order lag.

use approx::assert_abs_diff_eq;
use moca_model::{Error, MOCA_HOME, SimulatedRobot};
use proptest::prelude::*;

use crate::shared::MOCA;

fn robot() -> SimulatedRobot {
    SimulatedRobot::new(&MOCA, &MOCA_HOME).unwrap()
}

proptest! {
    #[test]
    fn position_without_lag_is_sum_of_commands(
        commands in prop::collection::vec(prop::collection::vec(-2.0..2.0, 10), 1..100),
    ) {
        let mut robot = robot();
        let mut expected = MOCA_HOME.to_vec();
        for command in &commands {
            robot.step(command, 0.001).unwrap();
            prop_assert_eq!(robot.velocity(), &command[..]);
            for (position, velocity) in expected.iter_mut().zip(command) {
                *position += 0.001 * velocity;
            }
        }
        for (position, expected) in robot.position().iter().zip(expected) {
            assert_abs_diff_eq!(*position, expected, epsilon = 1e-12);
        }
    }

    #[test]
    fn lagging_motion_is_independent_of_step_size(
        constant in 1e-3..1.0, command in prop::collection::vec(-2.0..2.0, 10), cuts in 2_u32..50,
    ) {
        let mut whole = robot().with_time_constants(&[constant; 10]).unwrap();
        let mut cut = whole.clone();
        whole.step(&command, 0.1).unwrap();
        for _ in 0..cuts {
            cut.step(&command, 0.1 / f64::from(cuts)).unwrap();
        }
        for joint in 0..10 {
            assert_abs_diff_eq!(whole.position()[joint], cut.position()[joint], epsilon = 1e-12);
            assert_abs_diff_eq!(whole.velocity()[joint], cut.velocity()[joint], epsilon = 1e-12);
        }
    }
}

#[test]
fn lag_reaches_63_percent_after_time_constant() {
    let mut robot = robot().with_time_constants(&[0.05; 10]).unwrap();
    for _ in 0..50 {
        robot.step(&[1.0; 10], 0.001).unwrap();
    }
    assert_abs_diff_eq!(robot.velocity()[4], 1.0 - (-1.0_f64).exp(), epsilon = 1e-12);
    let lost = 0.05 * (1.0 - (-1.0_f64).exp()); // ∫ (1 − v) dt
    assert_abs_diff_eq!(robot.position()[4] - MOCA_HOME[4], 0.05 - lost, epsilon = 1e-12);
}

#[test]
fn bad_input_gives_an_error_and_no_motion() {
    let model = &*MOCA;
    assert!(matches!(
        SimulatedRobot::new(model, &[0.0; 9]),
        Err(Error::WrongSize { expected: 10, got: 9, .. })
    ));
    assert!(matches!(SimulatedRobot::new(model, &[f64::NAN; 10]), Err(Error::Value { .. })));
    assert!(matches!(robot().with_time_constants(&[-0.1; 10]), Err(Error::Value { .. })));
    let mut robot = robot();
    let mut command = [1.0; 10];
    command[9] = f64::INFINITY;
    let error = robot.step(&command, 0.001).unwrap_err();
    assert!(error.to_string().contains("joint 10"), "{error}");
    assert!(matches!(robot.step(&[0.0; 3], 0.001), Err(Error::WrongSize { .. })));
    assert!(matches!(robot.step(&[0.0; 10], 0.0), Err(Error::Value { .. })));
    assert!(matches!(robot.step(&[0.0; 10], f64::NAN), Err(Error::Value { .. })));
    assert_eq!(robot.position(), MOCA_HOME);
    assert_eq!(robot.velocity(), [0.0; 10]);
}
