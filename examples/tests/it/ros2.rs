//! Robots on ROS 2.

mod bytes;
mod commands;
mod graph;
mod gripper;
mod images;
mod measurements;
mod perceived;
mod perception;

use std::time::{Duration, SystemTime, UNIX_EPOCH};

use moca_drivers::ros2::messages::{
    Header, JointState, Odometry, Pose, PoseArray, Quaternion, Time, TwistStamped, Vector3,
};
use moca_drivers::ros2::{BASE_FRAME, Measurements, Refusal, RobotJoints, WORLD_FRAME};
use moca_model::{MOCA_BASE_JOINTS, MOCA_JOINTS};

/// Time stamp of the messages of these tests.
const STAMP: Time = Time { sec: 1_700_000_000, nanosec: 250_000_000 };

/// The time this long after the stamp \[ms\].
fn after(milliseconds: u64) -> SystemTime {
    UNIX_EPOCH + Duration::from_millis(1_700_000_000_250 + milliseconds)
}

fn header(frame: &str) -> Header {
    Header { stamp: STAMP, frame_id: frame.to_owned() }
}

/// Joints of MOCA's arm at 0.1, 0.2, …
fn joint_state() -> JointState {
    let numbers = |scale: f64| (1..=7).map(|joint| scale * f64::from(joint)).collect();
    JointState {
        header: header(""),
        name: MOCA_JOINTS.iter().skip(MOCA_BASE_JOINTS).map(ToString::to_string).collect(),
        position: numbers(0.1),
        velocity: numbers(1.0),
        effort: numbers(10.0),
    }
}

/// A base with this yaw \[rad\] that drives forwards at 1 m/s.
fn odometry(yaw: f64) -> Odometry {
    let mut odometry = Odometry {
        header: header(WORLD_FRAME),
        child_frame_id: BASE_FRAME.to_owned(),
        ..Odometry::default()
    };
    odometry.pose.pose.orientation =
        Quaternion { z: (yaw / 2.0).sin(), w: (yaw / 2.0).cos(), ..Quaternion::default() };
    odometry.twist.twist.linear.x = 1.0;
    odometry
}

/// Body with all joints on a vertical line.
fn body() -> PoseArray {
    let pose = |joint: u32| Pose {
        position: Vector3 { x: 2.0, y: 0.0, z: 0.1 * f64::from(joint) },
        ..Pose::default()
    };
    PoseArray { header: header(WORLD_FRAME), poses: (0..25).map(pose).collect() }
}

fn twist(x: f64, y: f64, turn: f64) -> TwistStamped {
    TwistStamped { header: header(BASE_FRAME), twist: [x, y, turn].into() }
}

/// Measurements after odometry at the origin.
fn measurements() -> Measurements {
    let mut measurements = Measurements::new(RobotJoints::moca());
    measurements.take_odometry(&odometry(0.0), after(1)).unwrap();
    measurements
}

/// The refusal of a changed joint state.
fn refused(change: impl FnOnce(&mut JointState)) -> Refusal {
    let (mut measurements, mut state) = (measurements(), joint_state());
    change(&mut state);
    let before = measurements.newest().clone();
    let refusal = measurements.take_joint_state(&state, after(2)).unwrap_err();
    assert_eq!(measurements.newest(), &before, "{refusal}");
    refusal
}
