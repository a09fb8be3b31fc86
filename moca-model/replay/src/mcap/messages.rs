//! Messages that a run adds to a recording in MCAP.

use std::collections::BTreeMap;

use nalgebra::{IsometryMatrix3, UnitQuaternion};
use percept_recording::mcap::{Message, Rotation, Time, Xyz};
use schemars::JsonSchema;
use serde::Serialize;

/// Poses of frames.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub(super) struct FrameTransforms {
    pub(super) transforms: Vec<FrameTransform>,
}

#[derive(Clone, Debug, Serialize, JsonSchema)]
pub(super) struct FrameTransform {
    pub(super) timestamp: Time,
    pub(super) parent_frame_id: String,
    pub(super) child_frame_id: String,
    pub(super) translation: Xyz,
    pub(super) rotation: Rotation,
}

/// Joints of the robot as numbers, by their names.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub(super) struct JointStates {
    /// Positions \[m or rad\].
    pub(super) position: BTreeMap<String, f64>,
    /// Velocities \[m/s or rad/s\].
    pub(super) velocity: BTreeMap<String, f64>,
}

/// Scores of the posture and quality of the control.
#[derive(Clone, Copy, Debug, Serialize, JsonSchema)]
pub(super) struct Scores {
    /// Score e_s of the predicted posture, 0 to 4.25.
    pub(super) ergonomics: f64,
    /// REBA of the predicted posture, 1 to 15.
    pub(super) reba: u8,
    /// REBA of the measured posture.
    pub(super) reba_measured: Option<u8>,
    /// True if person and robot work together.
    pub(super) together: bool,
    /// Distance of the tool from x_d \[m\].
    pub(super) tracking_error: f64,
    /// Violation of the workspace's bounds \[m\].
    pub(super) slack: f64,
    /// Time of a step of the controller \[µs\].
    pub(super) step_us: f64,
}

impl Message for FrameTransforms {
    const SCHEMA: &'static str = "foxglove.FrameTransforms";
}

/// State of a loop from this time on.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub(super) struct ControlState {
    /// Kind of state, such as `phase` or `safety`.
    pub(super) of: String,
    /// Name of the state, with its cause.
    pub(super) state: String,
}

impl Message for ControlState {
    const SCHEMA: &'static str = "moca.ControlState";
}

impl Message for JointStates {
    const SCHEMA: &'static str = "moca.JointStates";
}

impl Message for Scores {
    const SCHEMA: &'static str = "moca.Scores";
}

impl FrameTransform {
    /// Creates the pose of a frame in the world.
    pub(super) fn new(time: Time, name: &str, pose: &IsometryMatrix3<f64>) -> Self {
        Self {
            timestamp: time,
            parent_frame_id: "world".to_owned(),
            child_frame_id: name.to_owned(),
            translation: pose.translation.vector.into(),
            rotation: UnitQuaternion::from_rotation_matrix(&pose.rotation).into(),
        }
    }
}
