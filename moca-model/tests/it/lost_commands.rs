//! Commands that the robot does not take.

use hrsw_safety::Fault;
use moca_model::whole_body::control_loop::{ControlLaw, JointCommand};
use moca_model::{DynamicRobot, DynamicRobotSettings, MOCA_HOME, Scene};

use crate::drive::{FRAME, PERIOD, loop_controller, percept};
use crate::shared::MOCA;
use crate::torque::Noise;

/// Starts to drive and loses the commands of `lost` ticks at each of `moments` moments. Returns the faults by tick
/// since a moment, and the largest excess speed. The excess is what a joint is faster than 1.2 times its speed at the
/// moment's end plus 0.1 rad/s.
fn drive(lost: u32, moments: u32) -> (Vec<(u32, Fault)>, f64) {
    let (mut law, frames, mut measured) = loop_controller();
    let settings = DynamicRobotSettings { loss: 0.0, ..DynamicRobotSettings::default() };
    let mut robot = DynamicRobot::new(&MOCA, &settings, &MOCA_HOME).unwrap();
    let (mut noise, mut command) = (Noise(4), JointCommand::at_rest(&measured));
    let speeds = |robot: &DynamicRobot| -> Vec<f64> {
        robot.simulation().velocity().iter().skip(3).map(|v| v.abs()).collect()
    };
    let (mut faults, mut worst, mut before) = (Vec::new(), f64::NEG_INFINITY, speeds(&robot));
    for tick in 0..1000 * (moments + 1) {
        let now = f64::from(tick) * PERIOD;
        if tick.is_multiple_of(FRAME) {
            let _ = frames.try_send(Scene::from(percept(now, None)));
        }
        robot.measure(&mut noise).unwrap();
        measured.take(robot.measured());
        law.step(now, &measured, &mut command).unwrap();
        let since = tick % 1000;
        faults.extend(law.controller().controller().command().fault.map(|fault| (since, fault)));
        if tick >= 1000 && since < lost {
            robot.miss(&[], PERIOD).unwrap();
            before = speeds(&robot);
        } else {
            let torque = &command.torque[3..];
            robot.drive(&command.velocity, torque, &[], PERIOD, &mut noise).unwrap();
            if tick >= 1000 && since < lost + 100 {
                for (now, before) in speeds(&robot).iter().zip(&before) {
                    worst = worst.max(now - (1.2 * before + 0.1));
                }
            }
        }
    }
    (faults, worst)
}

#[test]
fn lost_commands_are_reported_within_10_ms() {
    let (faults, worst) = drive(19, 5);
    assert!(faults.iter().all(|(_, fault)| *fault == Fault::LostCommand), "{faults:?}");
    // The tick before reports in which the robot has not taken a command.
    assert_eq!(faults.iter().filter(|(tick, _)| *tick == 6).count(), 5, "{faults:?}");
    assert!(worst < 0.0, "{worst} rad/s too fast when commands come again");
}

#[test]
fn a_few_lost_commands_are_no_fault() {
    for lost in 1..=3 {
        let (faults, worst) = drive(lost, 5);
        assert!(faults.is_empty(), "{lost}: {faults:?}");
        assert!(worst < 0.0, "{lost}: {worst} rad/s");
    }
}
