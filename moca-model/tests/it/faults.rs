//! Faults of clocks, frames and measurements with a person in the way. The robot stops or slows down, reports the
//! reason, and never drives into a person.

use ahqp_core::Budget;
use ergo_map::ErgonomicsQuadratic;
use hrsw::Capsule;
use hrsw_safety::{ClockFault, Fault, FrameFault, SafetyState};
use moca_model::{ControllerSettings, Error, FollowingErrorSettings, MOCA_HOME, Outcome};
use nalgebra::{Matrix3, Vector3};
use vision_models::{Action, Tool};

use crate::drive::{Clock, Drive, FRAME, PERIOD, doing, percept};

#[test]
fn an_empty_frame_an_hour_ahead_blinds_nobody() {
    let mut drive = Drive::towards_a_person();
    let ahead = drive.time() + 3600.0;
    let refused = drive.controller.observe(percept(ahead, None)).unwrap_err();
    assert!(matches!(refused, Error::Frame { fault: FrameFault::Future, .. }), "{refused}");
    assert_eq!(drive.cause(), Some(FrameFault::Future.into()));
    assert_eq!(drive.state(), SafetyState::ProtectiveStop);
    // Later frames are taken. The robot recovers, approaches as near as allowed, and passes by.
    drive.run(8.0);
    assert!(drive.controller.clock().age().seconds() < 0.1);
    drive.assert_near_but_not_too_near();
}

#[test]
fn future_frame_before_first_tick_expires_then() {
    let mut drive = Drive::new();
    drive.controller.observe(percept(3600.0, None)).unwrap();
    drive.camera = false;
    drive.step();
    assert_eq!(drive.cause(), Some(FrameFault::Future.into()));
    drive.camera = true;
    drive.run(3.0);
    assert_eq!(drive.state(), SafetyState::Normal);
}

#[test]
fn frames_from_future_clock_do_not_count() {
    let mut drive = Drive::new();
    drive.stamp = |time| if time < 5.0 { time + 20.0 } else { time };
    drive.run(5.0);
    assert_eq!(drive.cause(), Some(FrameFault::Future.into()));
    assert_eq!(drive.robot.position(), MOCA_HOME);
    drive.run(3.0);
    assert_eq!(drive.state(), SafetyState::Normal);
    drive.person = Some(drive.controller.actual().translation.x + 1.8);
    drive.run(8.0);
    drive.assert_near_but_not_too_near();
}

#[test]
fn stamps_of_another_epoch_are_no_data() {
    let mut camera = Drive::new();
    camera.stamp = |time| time + 1.76e9;
    let mut ticks = Drive::new();
    ticks.clock = |time| time + 1.76e9;
    for drive in [&mut camera, &mut ticks] {
        drive.run(3.0);
        assert_eq!(drive.cause(), Some(FrameFault::ForeignEpoch.into()));
        assert_eq!(drive.state(), SafetyState::ProtectiveStop);
        assert_eq!(drive.robot.position(), MOCA_HOME);
    }
}

#[test]
fn clock_may_count_seconds_since_1970() {
    let mut drive = Drive::new();
    (drive.stamp, drive.clock) = (|time| time + 1.76e9, |time| time + 1.76e9);
    drive.run(2.5);
    assert_eq!(drive.state(), SafetyState::Normal);
    assert!(drive.fastest() > 0.2);
}

#[test]
fn invalid_time_stops_the_robot() {
    for broken in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let mut drive = Drive::towards_a_person();
        for _ in 0..2000 {
            let measured = drive.robot.position().to_vec();
            let command = drive.controller.step(broken, &measured).unwrap();
            assert_eq!(command.outcome, Outcome::Braking);
            assert_eq!(command.safety, SafetyState::ProtectiveStop);
            assert_eq!(command.fault, Some(ClockFault::NotFinite.into()));
            drive.obey(PERIOD);
        }
        drive.tick += 2000;
        drive.assert_waits(ClockFault::NotFinite.into());
    }
}

#[test]
fn a_clock_that_stands_still_stops_the_robot() {
    let mut drive = Drive::towards_a_person();
    drive.clock = |time| time.min(2.5);
    drive.run(8.0);
    drive.assert_waits(ClockFault::StandsStill.into());
    // The acknowledgement has no effect.
    drive.acknowledge();
    drive.run(1.0);
    drive.assert_waits(ClockFault::StandsStill.into());
}

#[test]
fn a_clock_that_hardly_moves_stops_the_robot() {
    let mut drive = Drive::towards_a_person();
    drive.clock = |time| 2.5 + 1e-5 * (time - 2.5);
    drive.run(5.0);
    assert_eq!(drive.state(), SafetyState::ProtectiveStop);
    assert_eq!(drive.fastest(), 0.0);
}

#[test]
fn a_clock_that_is_set_stops_the_robot() {
    let jumps: [(Clock, ClockFault); 4] = [
        (|time| if time > 3.0 { time + 3600.0 } else { time }, ClockFault::SetAhead),
        (|time| if time > 3.0 { time + 0.2 } else { time }, ClockFault::SetAhead),
        (|time| if time > 3.0 { time - 3600.0 } else { time }, ClockFault::SetBack),
        (|time| if time > 3.0 { time - 0.01 } else { time }, ClockFault::SetBack),
    ];
    for (jump, fault) in jumps {
        let mut drive = Drive::towards_a_person();
        (drive.clock, drive.stamp) = (jump, jump);
        drive.run(4.0);
        drive.assert_waits(fault.into());
        drive.assert_goes_on();
    }
}

/// The camera's clock continues. Its frames are then from the future, or old.
#[test]
fn setting_only_the_tick_clock_stops_robot() {
    let jumps: [Clock; 2] = [
        |time| if time > 3.0 { time - 20.0 } else { time },
        |time| if time > 3.0 { time + 20.0 } else { time },
    ];
    for jump in jumps {
        let mut drive = Drive::towards_a_person();
        drive.clock = jump;
        drive.run(4.0);
        drive.acknowledge();
        drive.run(4.0);
        assert_eq!(drive.state(), SafetyState::ProtectiveStop);
        assert_eq!(drive.fastest(), 0.0);
    }
}

/// Numbers so large that the stack cannot be written.
pub(crate) fn unusable() -> ErgonomicsQuadratic {
    ErgonomicsQuadratic::new(Matrix3::identity() * 1e100, Vector3::repeat(1e100), 1.0).unwrap()
}

pub(crate) fn usable() -> ErgonomicsQuadratic {
    ErgonomicsQuadratic::new(Matrix3::identity(), Vector3::zeros(), 1.0).unwrap()
}

/// Drives towards a person six metres ahead to work with them.
pub(crate) fn towards_work(drive: &mut Drive) {
    drive.person = Some(6.0);
    assert!(share_of_ergonomics(drive, 1500) > 0.5);
}

/// Makes ticks with the person at work, and returns the share of ergonomics.
fn share_of_ergonomics(drive: &mut Drive, ticks: u32) -> f64 {
    for _ in 0..ticks {
        if drive.tick.is_multiple_of(FRAME) {
            let work = doing(Action::Using(Tool::Drill), drive.time(), drive.person);
            drive.controller.observe(&work).unwrap();
        }
        drive.camera = false;
        drive.step();
    }
    drive.camera = true;
    drive.controller.command().activation
}

#[test]
fn ticks_without_a_solution_are_heard_of() {
    let mut drive = Drive::new();
    towards_work(&mut drive);
    drive.controller.set_ergonomics(unusable());
    drive.step();
    assert_eq!(drive.controller.command().outcome, Outcome::Braking);
    assert_eq!(drive.controller.command().fault, Some(Fault::NoSolution));
    assert_eq!(drive.controller.command().safety, SafetyState::ProtectiveStop);
    for _ in 0..2800 {
        drive.step();
    }
    drive.assert_waits(Fault::NoSolution);
}

#[test]
fn exhausted_budget_is_reported_and_limits_hold() {
    for iterations in [2, 4] {
        let budget = Budget::iterations(iterations);
        // The drive checks every command against the limits.
        let mut drive = Drive::with(ControllerSettings { budget, ..ControllerSettings::default() });
        let mut ran_out = 0;
        for _ in 0..1500 {
            drive.step();
            let command = drive.controller.command();
            ran_out += u32::from(command.fault == Some(Fault::IterationLimit));
            assert!(
                command.outcome != Outcome::Braking && command.fault != Some(Fault::NoSolution)
            );
            assert_eq!(command.outcome.is_optimal(), command.fault != Some(Fault::IterationLimit));
        }
        assert!(ran_out > 0, "{budget:?}");
        assert!(drive.state() != SafetyState::ProtectiveStop, "{budget:?}");
    }
}

#[test]
fn occasional_invalid_measurements_stop_the_robot() {
    let mut drive = Drive::towards_a_person();
    for tick in 0..3000 {
        let mut measured = drive.robot.position().to_vec();
        if tick % 10 == 0 {
            measured[5] = f64::NAN;
        }
        drive.step_with(&measured);
        assert_eq!(drive.controller.command().safety, SafetyState::ProtectiveStop);
    }
    drive.assert_waits(Fault::BadMeasurement);
    drive.assert_goes_on();
}

#[test]
fn error_brakes_and_informs_the_supervisor() {
    let mut drive = Drive::towards_a_person();
    let before = drive.fastest();
    for _ in 0..3000 {
        let now = drive.time();
        let error = drive.controller.step(now, &[0.0; 9]).unwrap_err();
        assert!(matches!(error, Error::Size { got: 9, wanted: 10, .. }), "{error}");
        assert!(drive.fastest() < before);
        drive.obey(PERIOD);
        drive.tick += 1;
    }
    drive.assert_waits(Fault::BadMeasurement);
}

/// The measured state stands still for some time, because the robot is held or not measured.
#[test]
fn command_never_runs_away_from_held_robot() {
    let following_error = FollowingErrorSettings::default();
    for (ticks, moves) in [(300, false), (2000, false), (300, true), (2000, true)] {
        let mut drive = Drive::new();
        drive.run(1.2);
        let held = drive.robot.position().to_vec();
        let joints = drive.model.limits().to_vec();
        let check = |drive: &Drive, measured: &[f64]| {
            let command = drive.controller.command();
            for (index, (commanded, measured)) in
                command.joint_position.iter().zip(measured).enumerate()
            {
                let length =
                    if index < 2 { following_error.prismatic } else { following_error.revolute };
                let apart = (commanded - measured).abs();
                // A tick adds this distance.
                assert!(apart <= length + joints[index].velocity * PERIOD, "{index}: {apart}");
            }
            let (desired, actual) = (&command.desired, drive.controller.actual());
            let apart = (desired.translation.vector - actual.translation.vector).norm();
            assert!(apart <= 0.1 + 2e-3, "{apart} m");
            let angle = desired.rotation.angle_to(&actual.rotation);
            assert!(angle <= 0.3 + 4e-3, "{angle} rad");
        };
        let before = drive.fastest();
        for _ in 0..ticks {
            if drive.tick.is_multiple_of(FRAME) {
                drive.see().unwrap();
            }
            drive.controller.step(drive.time(), &held).unwrap();
            check(&drive, &held);
            if moves {
                drive.obey(PERIOD);
            } else {
                drive.velocity.clone_from(&drive.controller.command().joint_velocity);
            }
            drive.tick += 1;
        }
        assert_eq!(
            drive.controller.safety().supervisor().unacknowledged(),
            Some(Fault::FollowingError)
        );
        // No error has grown meanwhile, and no missed motion is made up for: the released robot brakes.
        let (speed, released) = (drive.fastest(), drive.velocity.clone());
        assert!(speed < before, "{before} {speed}");
        let from = drive.robot.position().to_vec();
        for _ in 0..3000 {
            drive.step();
            check(&drive, drive.robot.position());
            assert!(drive.fastest() <= speed + 1e-9);
            for (index, (q, from)) in drive.robot.position().iter().zip(&from).enumerate() {
                let braking = released[index].powi(2) / (2.0 * joints[index].acceleration);
                assert!(
                    (q - from).abs() <= braking + 1e-7,
                    "joint {index} moved on by {} m or rad, not {braking}",
                    (q - from).abs()
                );
            }
        }
        drive.assert_waits(Fault::FollowingError);
        drive.assert_goes_on();
    }
}

#[test]
fn too_frequent_ticks_keep_limits_and_stop() {
    let mut drive =
        Drive::with(ControllerSettings { period: 0.01, ..ControllerSettings::default() });
    for tick in 0..300_u32 {
        if tick.is_multiple_of(5) {
            drive.see().unwrap();
        }
        let measured = drive.robot.position().to_vec();
        drive.controller.step(drive.time(), &measured).unwrap();
        drive.obey(0.01);
        drive.tick += 1;
    }
    assert!(drive.fastest() > 0.2, "it drives: {}", drive.fastest());
    let begin = drive.time();
    for tick in 0..3000_u32 {
        let now = begin + f64::from(tick) * PERIOD;
        if tick.is_multiple_of(FRAME) {
            let _ = drive.controller.observe(percept(now, None));
        }
        let measured = drive.robot.position().to_vec();
        drive.controller.step(now, &measured).unwrap();
        drive.obey(if tick == 0 { 0.01 } else { PERIOD });
    }
    assert_eq!(drive.state(), SafetyState::ProtectiveStop);
    assert_eq!(drive.cause(), Some(Fault::EarlyTick));
    assert_eq!(drive.fastest(), 0.0);
}

/// Ticks between half a period and one and a half periods apart count as in time. The limits hold for the elapsed time.
#[test]
fn jitter_within_tolerance_keeps_the_limits() {
    let mut drive = Drive::new();
    let mut now = 0.0;
    for tick in 0..4000_u32 {
        let elapsed = PERIOD * (1.0 + 0.45 * (f64::from(tick) * 1.7).sin());
        if tick.is_multiple_of(FRAME) {
            drive.controller.observe(percept(now, None)).unwrap();
        }
        let measured = drive.robot.position().to_vec();
        let command = drive.controller.step(now, &measured).unwrap();
        assert_eq!(command.fault, None);
        now += elapsed;
        // The velocity changed in the time of the last tick.
        let limits = drive.model.limits().to_vec();
        let command = drive.controller.command();
        let last = if tick == 0 { PERIOD } else { elapsed_before(tick) };
        // The clock counts a difference of a thousandth of the period as rounding.
        let last = if (last - PERIOD).abs() <= 1e-3 * PERIOD { PERIOD } else { last };
        for ((v, before), limits) in command.joint_velocity.iter().zip(&drive.velocity).zip(&limits)
        {
            let most = limits.acceleration * last.min(PERIOD) * (1.0 + 1e-6);
            assert!((v - before).abs() <= most, "tick {tick}: from {before} to {v}");
        }
        drive.velocity.clone_from(&command.joint_velocity);
        let velocity = command.joint_velocity.clone();
        for (commanded, measured) in command.joint_position.iter().zip(&measured) {
            assert!((commanded - measured).abs() < 5e-3, "{commanded} {measured}");
        }
        drive.robot.step(&velocity, elapsed).unwrap();
    }
    assert_eq!(drive.state(), SafetyState::Normal);
    assert!(drive.fastest() > 0.1);
}

fn elapsed_before(tick: u32) -> f64 {
    PERIOD * (1.0 + 0.45 * (f64::from(tick - 1) * 1.7).sin())
}

/// The best place of the tool is below the workspace, in front of the person. That of a slanted workspace is not below
/// it, but below the box around it.
#[test]
fn ergonomics_wait_at_limit_of_small_workspaces() {
    waits_at_limit(None);
    let (low, high) = (Vector3::new(0.35, -0.4, 0.85), Vector3::new(0.6, 0.1, 1.5));
    waits_at_limit(Some(Capsule::new(low, high, 0.1).unwrap()));
}

fn waits_at_limit(workspace: Option<Capsule>) {
    let mut drive = Drive::new();
    drive.person = Some(1.2);
    if let Some(workspace) = workspace {
        drive.controller.space_mut().reshape_position(&workspace.into(), 0.1).unwrap();
    }
    let (stiffness, best) = (10.0, Vector3::new(0.35, 0.0, -0.5));
    let below =
        ErgonomicsQuadratic::new(Matrix3::identity() * stiffness, -stiffness * best, 5.0).unwrap();
    drive.controller.set_ergonomics(below);
    assert!(share_of_ergonomics(&mut drive, 2000) > 0.99, "on the way");
    assert!(share_of_ergonomics(&mut drive, 6000) < 0.5, "at the limit");
    assert!(drive.controller.situation().is_shared);
}
