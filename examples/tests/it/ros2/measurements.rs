use std::f64::consts::{FRAC_PI_2, PI};

use moca_drivers::ros2::messages::{Odometry, Quaternion, Text, Time};
use moca_drivers::ros2::{Measurements, Refusal, RobotJoints};
use moca_model::whole_body::control_loop::{RobotMode, RobotStatus};
use proptest::prelude::*;

use super::{after, joint_state, measurements, odometry, refused};

#[test]
fn joints_are_found_by_name_among_others() {
    let (mut measurements, mut state) = (measurements(), joint_state());
    for (numbers, gripper) in
        [(&mut state.position, 9.0), (&mut state.velocity, f64::NAN), (&mut state.effort, 9.0)]
    {
        numbers.reverse();
        numbers.push(gripper);
    }
    state.name.reverse();
    state.name.push("panda_finger_joint1".to_owned());
    let age = measurements.take_joint_state(&state, after(2)).unwrap();
    assert!((age - 0.002).abs() < 1e-9, "{age}");
    let newest = measurements.newest();
    let expected = |scale: f64| (1..=7).map(|joint| scale * f64::from(joint)).collect::<Vec<_>>();
    assert_eq!(newest.position[3..], expected(0.1));
    assert_eq!(newest.velocity, [vec![1.0, 0.0, 0.0], expected(1.0)].concat());
    let torques: Vec<_> = expected(10.0).into_iter().map(Some).collect();
    assert_eq!(newest.torque, [vec![None; 3], torques].concat());
}

#[test]
fn joints_without_torques_have_none() {
    let (mut measurements, mut state) = (measurements(), joint_state());
    measurements.take_joint_state(&state, after(2)).unwrap();
    state.effort[2] = f64::NAN;
    state.header.stamp.nanosec += 1;
    measurements.take_joint_state(&state, after(2)).unwrap();
    let torque = &measurements.newest().torque;
    assert_eq!(torque[4..7], [Some(20.0), None, Some(40.0)], "a NaN is a joint without a torque");
    state.effort.clear();
    state.header.stamp.nanosec += 1;
    measurements.take_joint_state(&state, after(2)).unwrap();
    assert_eq!(measurements.newest().torque, [None; 10]);
}

#[test]
fn robot_status_holds_for_a_second() {
    let (mut measurements, mut state) = (measurements(), joint_state());
    let said = |mode: &str| Text { data: mode.to_owned() };
    measurements.take_joint_state(&state, after(2)).unwrap();
    assert_eq!(measurements.newest().robot, RobotStatus::default(), "it has said nothing");
    let modes = [
        ("running", RobotMode::Running),
        ("stopped", RobotMode::Stopped),
        ("reflex", RobotMode::Reflex),
        ("user_stop", RobotMode::UserStop),
    ];
    for (name, mode) in modes {
        measurements.take_mode(&said(name), after(2)).unwrap();
        state.header.stamp.nanosec += 1;
        measurements.take_joint_state(&state, after(3)).unwrap();
        assert_eq!(measurements.newest().robot.mode, Some(mode));
    }
    let unknown = measurements.take_mode(&said("Running"), after(3)).unwrap_err();
    assert!(unknown.to_string().contains("\"Running\", expected one of running"), "{unknown}");
    // Its joints continue, and its status is unknown again.
    measurements.take_odometry(&later(odometry(0.0)), after(1001)).unwrap();
    state.header.stamp.sec += 1;
    measurements.take_joint_state(&state, after(1003)).unwrap();
    assert_eq!(measurements.newest().robot, RobotStatus::default());
}

/// The same odometry a second later.
fn later(mut odometry: Odometry) -> Odometry {
    odometry.header.stamp.sec += 1;
    odometry
}

#[test]
fn joint_states_of_another_size_are_refused() {
    let size = |what, found, expected| Refusal::Size { what, found, expected };
    assert_eq!(refused(|state| state.position.truncate(3)), size("position", 3, 7));
    assert_eq!(refused(|state| state.velocity.clear()), size("velocity", 0, 7));
    assert_eq!(refused(|state| state.effort.truncate(1)), size("effort", 1, 7));
    assert_eq!(refused(|state| state.name.push("more".to_owned())), size("position", 7, 8));
}

#[test]
fn joints_of_another_robot_are_named() {
    let missing = refused(|state| state.name[6] = "fr3_joint7".to_owned());
    let text = missing.to_string();
    assert!(text.contains("no joint \"panda_joint7\"") && text.contains("fr3_joint7"), "{text}");
    let repeated = refused(|state| state.name[6] = "panda_joint1".to_owned());
    // The fault of the joint that comes first is reported.
    assert_eq!(repeated, Refusal::RepeatedJoint { joint: "panda_joint1".to_owned() });
}

#[test]
fn joint_states_that_are_no_numbers_are_refused() {
    for wrong in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let refusal = |what| Refusal::NotFinite { what };
        if wrong.is_infinite() {
            assert_eq!(refused(|state| state.effort[3] = wrong), refusal("effort"));
        }
        assert_eq!(refused(|state| state.position[0] = wrong), refusal("position"));
        assert_eq!(refused(|state| state.velocity[6] = wrong), refusal("velocity"));
    }
}

#[test]
fn stamps_of_another_clock_are_refused() {
    assert_eq!(refused(|state| state.header.stamp = Time::default()), Refusal::NoStamp);
    // A simulation's clock begins at zero.
    let simulated = refused(|state| state.header.stamp = Time { sec: 12, nanosec: 0 });
    assert!(matches!(simulated, Refusal::Old { age, .. } if age > 1e9), "{simulated}");
    let ahead = refused(|state| state.header.stamp.sec += 3);
    assert!(ahead.to_string().starts_with("stamped 2.998 s in the future"), "{ahead}");
    let late = refused(|state| state.header.stamp.nanosec -= 99_000_000);
    assert!(late.to_string().starts_with("stamped 0.101 s ago"), "{late}");
    let wrong = refused(|state| state.header.stamp.nanosec = 1_000_000_000);
    assert_eq!(wrong, Refusal::Stamp { nanosec: 1_000_000_000 });
}

#[test]
fn a_message_that_was_overtaken_is_refused() {
    let (mut measurements, mut state) = (measurements(), joint_state());
    measurements.take_joint_state(&state, after(2)).unwrap();
    state.position[0] = 0.7;
    assert_eq!(measurements.take_joint_state(&state, after(2)), Err(Refusal::Overtaken));
    assert_eq!(measurements.newest().position[3], 0.1);
}

#[test]
fn an_arm_without_a_base_is_no_measurement() {
    let (mut alone, mut state) = (Measurements::new(RobotJoints::moca()), joint_state());
    let none = Err(Refusal::NoOdometry { oldest: 0.1 });
    assert_eq!(alone.take_joint_state(&state, after(2)), none);
    // The odometry has stopped.
    let mut stopped = measurements();
    state.header.stamp.nanosec += 100_000_000;
    assert!(stopped.take_joint_state(&state, after(101)).is_ok());
    state.header.stamp.nanosec += 1_000_000;
    assert_eq!(stopped.take_joint_state(&state, after(102)), none);
}

#[test]
fn an_arm_that_stands_needs_no_odometry() {
    let arm = RobotJoints::moca().arm().to_vec();
    let mut measurements = Measurements::new(RobotJoints::of_arm(arm));
    let state = joint_state();
    measurements.take_joint_state(&state, after(2)).unwrap();
    let measured = measurements.newest().clone();
    assert_eq!(measured.position, state.position);
    assert_eq!(measured.velocity, state.velocity);
    // Odometry of others moves none of its joints.
    measurements.take_odometry(&odometry(1.0), after(3)).unwrap();
    assert_eq!(measurements.newest(), &measured);
}

#[test]
fn odometry_comes_into_the_axes_of_the_world() {
    let mut measurements = Measurements::new(RobotJoints::moca());
    let mut odometry = odometry(FRAC_PI_2);
    odometry.pose.pose.position.y = -2.0;
    odometry.twist.twist.angular.z = 0.5;
    measurements.take_odometry(&odometry, after(1)).unwrap();
    let ([x, y, yaw], [along_x, along_y, turn]) = (
        *measurements.newest().position.first_chunk().unwrap(),
        *measurements.newest().velocity.first_chunk().unwrap(),
    );
    assert_eq!((x, y, turn), (0.0, -2.0, 0.5));
    assert!(
        (yaw - FRAC_PI_2).abs() < 1e-12 && along_x.abs() < 1e-12 && (along_y - 1.0).abs() < 1e-12
    );
}

#[test]
fn odometry_of_other_frames_is_refused() {
    let refused = |change: fn(&mut moca_drivers::ros2::messages::Odometry)| {
        let mut odometry = odometry(0.0);
        change(&mut odometry);
        Measurements::new(RobotJoints::moca()).take_odometry(&odometry, after(1))
    };
    let found = |found: &str, expected| Err(Refusal::Frame { found: found.to_owned(), expected });
    assert_eq!(
        refused(|odometry| odometry.header.frame_id = "map".to_owned()),
        found("map", "odom")
    );
    let wheel = refused(|odometry| odometry.child_frame_id = "wheel".to_owned());
    assert_eq!(wheel, found("wheel", "base_footprint"));
    assert!(refused(|odometry| odometry.child_frame_id = "base_link".to_owned()).is_ok());
}

#[test]
fn odometry_that_is_no_pose_is_refused() {
    let refused = |change: fn(&mut moca_drivers::ros2::messages::Odometry)| {
        let mut odometry = odometry(0.0);
        change(&mut odometry);
        let mut measurements = measurements();
        let refusal = measurements.take_odometry(&odometry, after(1)).unwrap_err();
        assert_eq!(measurements.newest(), super::measurements().newest(), "{refusal}");
        refusal
    };
    let position = refused(|odometry| odometry.pose.pose.position.y = f64::NAN);
    assert_eq!(position, Refusal::NotFinite { what: "position" });
    let twist = refused(|odometry| odometry.twist.twist.angular.z = f64::INFINITY);
    assert_eq!(twist, Refusal::NotFinite { what: "twist" });
    // A publisher that never sets it sends zeros in some languages.
    let zero = Quaternion { w: 0.0, ..Quaternion::default() };
    let mut unset = odometry(0.0);
    unset.pose.pose.orientation = zero;
    let refusal = measurements().take_odometry(&unset, after(1));
    assert_eq!(refusal, Err(Refusal::Orientation { norm: 0.0 }));
    let turned = refused(|odometry| odometry.pose.pose.orientation.x = f64::NAN);
    assert!(matches!(turned, Refusal::Orientation { norm } if norm.is_nan()));
}

proptest! {
    #[test]
    fn yaw_goes_on_from_turn_to_turn(turns in prop::collection::vec(-3.1..3.1_f64, 1..50)) {
        let mut measurements = Measurements::new(RobotJoints::moca());
        let (mut yaw, mut stamp) = (0.0, super::STAMP);
        for turn in turns {
            yaw += turn;
            stamp.nanosec += 1;
            let mut odometry = odometry(yaw);
            odometry.header.stamp = stamp;
            measurements.take_odometry(&odometry, after(1)).unwrap();
            prop_assert!((measurements.newest().position[2] - yaw).abs() < 1e-9);
        }
    }

    #[test]
    fn a_quaternion_and_its_negative_are_one_yaw(yaw in -PI..PI) {
        let mut negative = odometry(yaw);
        let turned = &mut negative.pose.pose.orientation;
        (turned.z, turned.w) = (-turned.z, -turned.w);
        let mut measurements = Measurements::new(RobotJoints::moca());
        measurements.take_odometry(&negative, after(1)).unwrap();
        prop_assert!((measurements.newest().position[2] - yaw).abs() < 1e-9);
    }
}
