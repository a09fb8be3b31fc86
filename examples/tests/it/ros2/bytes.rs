//! Messages as bytes, compared with those of Cyclone DDS (`examples/ros2/golden.py`).

use std::f64::consts::FRAC_PI_2;
use std::fmt::Debug;

use moca_drivers::ros2::messages::{
    CameraInfo, Float64MultiArray, Image, JointState, Odometry, PoseArray, Text, TfMessage,
    TwistStamped,
};
use moca_drivers::ros2::ros2_client::dds::rustdds::RepresentationIdentifier;
use moca_drivers::ros2::ros2_client::dds::rustdds::serialization::{
    deserialize_from_cdr_with_rep_id, to_writer_with_rep_id,
};
use moca_drivers::ros2::{Commands, Measurements, Perceived, RobotJoints, depth_of, intrinsics_of};
use moca_model::whole_body::control_loop::{JointCommand, JointMeasurement};
use proptest::prelude::*;
use serde::Serialize;
use serde::de::DeserializeOwned;

use super::{after, measurements};

const LITTLE_ENDIAN: RepresentationIdentifier = RepresentationIdentifier::CDR_LE;
const TYPES: [&str; 7] = [
    "JointState",
    "Odometry",
    "PoseArray",
    "TFMessage",
    "String",
    "TwistStamped",
    "Float64MultiArray",
];

/// The bytes of a message without the four that give its encoding.
fn golden(name: &str) -> Vec<u8> {
    let lines = include_str!("../../../ros2/golden.txt").lines();
    let mut messages = lines.filter_map(|line| line.split_once(' '));
    let (_, digits) = messages.find(|(found, _)| *found == name).unwrap();
    let byte = |place: usize| u8::from_str_radix(&digits[place..place + 2], 16).unwrap();
    let bytes: Vec<u8> = (0..digits.len()).step_by(2).map(byte).collect();
    assert_eq!(bytes[..4], [0, 1, 0, 0], "little-endian CDR");
    bytes[4..].to_vec()
}

fn decode<M: DeserializeOwned>(bytes: &[u8]) -> Option<M> {
    deserialize_from_cdr_with_rep_id(bytes, LITTLE_ENDIAN).ok().map(|(message, _)| message)
}

/// The message of Cyclone DDS, which is written back to the same bytes.
fn same<M: DeserializeOwned + Serialize + PartialEq + Debug>(name: &str) -> M {
    let bytes = golden(name);
    let message = decode(&bytes).unwrap();
    let mut again = Vec::new();
    to_writer_with_rep_id(&mut again, &message, LITTLE_ENDIAN).unwrap();
    // Cyclone DDS fills most messages up to four bytes.
    let filled = |mut bytes: Vec<u8>| {
        bytes.resize(bytes.len().next_multiple_of(4), 0);
        bytes
    };
    assert_eq!(filled(again), filled(bytes), "{name}");
    message
}

/// Takes bytes as a message of a type. Returns whether anything was taken.
fn take(name: &str, bytes: &[u8]) -> bool {
    let (mut perceived, mut commands) = (Perceived::default(), Commands::new(7));
    // Odometry with the same time as the one before would count as overtaken.
    let before = name == "JointState";
    let mut measurements =
        if before { measurements() } else { Measurements::new(RobotJoints::moca()) };
    let now = after(2);
    let taken = match name {
        "JointState" => decode::<JointState>(bytes)
            .is_some_and(|message| measurements.take_joint_state(&message, now).is_ok()),
        "Odometry" => decode::<Odometry>(bytes)
            .is_some_and(|message| measurements.take_odometry(&message, now).is_ok()),
        "PoseArray" => decode::<PoseArray>(bytes)
            .is_some_and(|message| perceived.take_body(&message, now).is_ok()),
        "TFMessage" => decode::<TfMessage>(bytes)
            .is_some_and(|message| perceived.take_transforms(&message, now).is_ok()),
        "String" => decode::<Text>(bytes)
            .is_some_and(|message| perceived.take_action(&message, now).is_ok()),
        "TwistStamped" => decode::<TwistStamped>(bytes)
            .is_some_and(|message| commands.take_twist(&message, now).is_ok()),
        _ => decode::<Float64MultiArray>(bytes)
            .is_some_and(|message| commands.take_effort(&message).is_ok()),
    };
    let newest = measurements.newest();
    let mut command = JointCommand::at_rest(newest);
    commands.write(0.0, &mut command);
    let JointMeasurement { position, velocity, torque, .. } = newest;
    let torque: Vec<_> = torque.iter().copied().flatten().collect();
    for numbers in [position, velocity, &torque, &command.velocity, &command.torque] {
        assert!(numbers.iter().all(|number| number.is_finite()), "{numbers:?}");
    }
    taken
}

#[test]
fn cyclone_dds_messages_are_understood() {
    let mut measurements = Measurements::new(RobotJoints::moca());
    measurements.take_odometry(&same("Odometry"), after(1)).unwrap();
    measurements.take_joint_state(&same("JointState"), after(1)).unwrap();
    let newest = measurements.newest();
    let [x, y, yaw, arm @ ..] = newest.position.as_slice() else { panic!("three of the base") };
    assert_eq!((*x, *y, arm), (1.5, -2.5, [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7].as_slice()));
    assert!((yaw - FRAC_PI_2).abs() < 1e-12, "{yaw}");
    // The twist is (0.5, -0.25) of a base that looks along y.
    assert!((newest.velocity[0] - 0.25).abs() < 1e-12 && (newest.velocity[1] - 0.5).abs() < 1e-12);
    assert_eq!(newest.velocity[2..], [0.125, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]);
    assert_eq!(newest.torque[3..], [10.0, 20.0, 30.0, 40.0, 50.0, 60.0, 70.0].map(Some));
    let odometry: Odometry = same("Odometry");
    assert_eq!((odometry.pose.covariance[5][5], odometry.twist.covariance[0][1]), (35.0, -1.0));

    let mut perceived = Perceived::default();
    perceived.take_action(&same("String"), after(1)).unwrap();
    let poses: PoseArray = same("PoseArray");
    let places: TfMessage = same("TFMessage");
    perceived.take_transforms(&places, after(1)).unwrap();
    assert_eq!(places.transforms[0].transform.translation.y, 2.0);
    let mut data = vec![f64::from(poses.header.stamp.sec), f64::from(poses.header.stamp.nanosec)];
    data.resize(27, 1.0);
    let confidences = Float64MultiArray { data, ..Float64MultiArray::default() };
    perceived.take_confidences(&confidences).unwrap();
    let seen = perceived.take_body(&poses, after(1)).unwrap();
    assert_eq!(seen.body.unwrap().keypoints()[24].unwrap().position.y, 0.24);
    assert!(seen.action.is_some());

    let mut commands = Commands::new(7);
    commands.take_twist(&same("TwistStamped"), after(1)).unwrap();
    commands.take_effort(&same("Float64MultiArray")).unwrap();
    let mut command = JointCommand::at_rest(newest);
    commands.write(0.0, &mut command);
    assert_eq!(command.velocity[..3], [0.5, -0.25, 0.125]);
    assert_eq!(command.torque[3..], [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]);
}

#[test]
fn cyclone_dds_images_are_understood() {
    let depth = depth_of(&same::<Image>("Image")).unwrap();
    let depths = [0, 1, 2].map(|column| depth.depth(column, 1));
    assert_eq!(depths.map(|depth| depth.is_some()), [true, false, true]);
    assert!((depths[0].unwrap() - 1.5).abs() < 1e-6 && (depths[2].unwrap() - 1.0).abs() < 1e-6);
    let info: CameraInfo = same("CameraInfo");
    assert!(info.roi.do_rectify && (info.roi.x_offset, info.roi.width) == (1, 4));
    let intrinsics = intrinsics_of(&info).unwrap();
    let read = (intrinsics.size(), intrinsics.focal(), intrinsics.centre());
    assert_eq!(read, ([640, 480], [615.0, 616.0], [319.5, 239.5]));
}

#[test]
fn bytes_of_another_message_are_refused() {
    for name in TYPES {
        assert!(take(name, &golden(name)), "{name}");
        for other in TYPES.into_iter().filter(|other| *other != name) {
            assert!(!take(name, &golden(other)), "{other} as {name}");
        }
    }
}

#[test]
fn messages_that_are_cut_off_are_refused() {
    for name in TYPES {
        let bytes = golden(name);
        // The messages lack the fill bytes of Cyclone DDS and one byte of content.
        for length in 0..bytes.len().saturating_sub(4) {
            assert!(!take(name, &bytes[..length]), "{length} bytes of {name}");
        }
    }
}

proptest! {
    #[test]
    fn no_bytes_break_anything(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        for name in TYPES {
            take(name, &bytes);
        }
    }

    #[test]
    fn no_wrong_byte_breaks_anything(place in any::<prop::sample::Index>(), byte in any::<u8>()) {
        for name in TYPES {
            let mut bytes = golden(name);
            let place = place.index(bytes.len());
            bytes[place] = byte;
            take(name, &bytes);
        }
    }
}
