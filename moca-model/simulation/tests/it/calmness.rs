//! The judge of calmness on motions with a known result.

use moca_model::{BaseMotion, Command, Controller, ControllerSettings, MOCA_HOME, moca};
use moca_simulation::judges::{Calmness, CalmnessMonitor};
use moca_simulation::people::Joints;
use nalgebra::{Matrix3, Point3, Vector3};

const PERIOD: f64 = 1e-3;

/// Fourteen seconds with a person who stands for ten and then walks at 0.3 m/s, and a robot with these motions.
fn judge(workpiece: impl Fn(f64) -> f64, base: impl Fn(f64) -> f64) -> Calmness {
    judge_beside(0.0, workpiece, base)
}

/// The same beside a person who also turns all the time, at `turns` \[rad/s\].
fn judge_beside(turns: f64, workpiece: impl Fn(f64) -> f64, base: impl Fn(f64) -> f64) -> Calmness {
    let ergonomics =
        ergo_map::ErgonomicsQuadratic::new(Matrix3::identity(), Vector3::zeros(), 1.0).unwrap();
    let settings = ControllerSettings::default();
    let controller = Controller::new(moca().unwrap(), ergonomics, settings, &MOCA_HOME).unwrap();
    let mut monitor = CalmnessMonitor::new(&moca().unwrap(), 3, PERIOD);
    let mut command: Command = controller.command().clone();
    for tick in 0..14_000 {
        let time = f64::from(tick) * PERIOD;
        command.joint_velocity[0] = base(time);
        monitor.watch(&command, Vector3::new(workpiece(time), 0.0, 1.0), true);
    }
    let person = |time: f64| -> Option<Joints> {
        let x = 0.3 * (time - 10.0).max(0.0);
        let mut joints = [Point3::new(x, 0.0, 1.0); 25];
        let (sine, cosine) = (turns * time).sin_cos();
        for (joint, aside) in [(5, 0.2), (12, 0.15), (2, -0.2), (9, -0.15)] {
            joints[joint] += Vector3::new(-sine, cosine, 0.0) * aside;
        }
        Some(joints)
    };
    monitor.judge(person)
}

#[test]
fn a_robot_at_rest_is_calm() {
    let calm = judge(|_| 0.5, |_| 0.0);
    let standing = calm.standing.unwrap();
    assert!((standing.workpiece, standing.base_reversals) == (0.0, 0.0));
    assert!((standing.base_at_rest - 1.0).abs() < 1e-12 && standing.base_at_limit == 0.0);
    assert!(standing.person < 0.05, "{standing:?}");
    // The time is from 1 s after 3 s of working together to the first steps.
    assert!((standing.duration - 5.7).abs() < 0.5, "{standing:?}");
    let walking = calm.walking.unwrap();
    assert!((walking.person - 0.3).abs() < 0.02, "{walking:?}");
    // From 2 s after the same beginning until they walk, their first step is on the spot.
    let on_the_spot = calm.on_the_spot.unwrap();
    assert!((on_the_spot.duration - 5.0).abs() < 0.5, "{on_the_spot:?}");
    assert!(on_the_spot.person < 0.1 && on_the_spot.base_at_rest == 1.0, "{on_the_spot:?}");
}

#[test]
fn who_turns_is_on_the_spot() {
    let calm = judge_beside(0.3, |time| 0.1 * time, |_| 0.0);
    assert!(calm.standing.is_none() && calm.settled.is_none(), "{calm:?}");
    let on_the_spot = calm.on_the_spot.unwrap();
    assert!((on_the_spot.duration - 5.0).abs() < 0.5, "{on_the_spot:?}");
    assert!((on_the_spot.workpiece - 0.1).abs() < 1e-3, "{on_the_spot:?}");
}

#[test]
fn a_swinging_workpiece_is_measured() {
    // An amplitude of 20 mm at 1 Hz gives 2π · 20/√2 = 88.9 mm/s, and at most 125.7 mm/s.
    let calm = judge(|time| 0.02 * (std::f64::consts::TAU * time).sin(), |_| 0.0);
    let standing = calm.standing.unwrap();
    assert!((standing.workpiece - 0.0889).abs() < 0.002, "{standing:?}");
    assert!((standing.workpiece_p99 - 0.1257).abs() < 0.002, "{standing:?}");
}

#[test]
fn a_late_workpiece_lags_behind_its_place() {
    // The person's mean speed over 0.2 s exceeds 0.2 m/s 33 ms after their first step.
    for late in [0.0, 0.4] {
        let calm = judge(|time| 0.5 + 0.3 * (time - 10.0 - late).max(0.0), |_| 0.0);
        let following = calm.following.unwrap();
        assert_eq!(following.settings_out, 1);
        let onset = (late - 0.033_f64).max(0.0);
        assert!((following.onset.unwrap() - onset).abs() < 0.015, "{following:?}");
        assert_eq!(following.onset, following.onset_worst);
        assert!((following.lag.unwrap() - 0.3 * late).abs() < 2e-3, "{following:?}");
    }
    // A workpiece that stays behind is behind for the whole walk.
    let following = judge(|_| 0.5, |_| 0.0).following.unwrap();
    assert!((following.onset.unwrap() - 4.0).abs() < 0.2, "{following:?}");
}

#[test]
fn bang_bang_motion_of_base_is_counted() {
    // The velocity is a triangle between ± 15 mm/s at the limit of 0.6 m/s², 10 times a second. It is never zero in a
    // tick.
    let triangle =
        |time: f64| 1e-5 + 0.03 * (2.0 * ((10.0 * time).rem_euclid(1.0) - 0.5).abs() - 0.5);
    let calm = judge(|_| 0.5, triangle);
    let standing = calm.standing.unwrap();
    assert!(standing.base_at_limit > 0.95, "{standing:?}");
    assert!((standing.base_reversals - 20.0).abs() < 1.0, "{standing:?}");
    assert!(standing.base_at_rest < 0.1, "{standing:?}");
    assert!((standing.base - 0.015 / 3.0_f64.sqrt()).abs() < 1e-3, "{standing:?}");
}

#[test]
fn a_command_says_why_the_base_moves() {
    let ergonomics =
        ergo_map::ErgonomicsQuadratic::new(Matrix3::identity(), Vector3::zeros(), 1.0).unwrap();
    let settings = ControllerSettings::default();
    let mut controller =
        Controller::new(moca().unwrap(), ergonomics, settings, &MOCA_HOME).unwrap();
    let command = controller.step(PERIOD, &MOCA_HOME).unwrap();
    assert!(matches!(command.base_motion, BaseMotion::Drives(_)), "nobody is there");
}
