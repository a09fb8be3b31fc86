//! The simulated robot follows its command at once.

use approx::assert_abs_diff_eq;
use moca_model::{Error, MOCA_HOME, SimulatedRobot};
use proptest::prelude::*;

use crate::shared::MOCA;

fn robot() -> SimulatedRobot {
    SimulatedRobot::new(&MOCA, &MOCA_HOME).unwrap()
}

proptest! {
    #[test]
    fn position_is_sum_of_commands(
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
}

#[test]
fn bad_input_gives_an_error_and_no_motion() {
    let model = &*MOCA;
    assert!(matches!(
        SimulatedRobot::new(model, &[0.0; 9]),
        Err(Error::Size { got: 9, wanted: 10, .. })
    ));
    assert!(matches!(SimulatedRobot::new(model, &[f64::NAN; 10]), Err(Error::Value { .. })));
    let mut robot = robot();
    let mut command = [1.0; 10];
    command[9] = f64::INFINITY;
    let error = robot.step(&command, 0.001).unwrap_err();
    assert!(error.to_string().contains("joint 10"), "{error}");
    assert!(matches!(robot.step(&[0.0; 3], 0.001), Err(Error::Size { .. })));
    assert!(matches!(robot.step(&[0.0; 10], 0.0), Err(Error::Value { .. })));
    assert!(matches!(robot.step(&[0.0; 10], f64::NAN), Err(Error::Value { .. })));
    assert_eq!(robot.position(), MOCA_HOME);
    assert_eq!(robot.velocity(), [0.0; 10]);
}
