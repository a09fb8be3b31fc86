//! Messages, with the schemas that Foxglove knows by their names.

use nalgebra::{IsometryMatrix3, UnitQuaternion, Vector3};
use schemars::JsonSchema;
use serde::Serialize;

/// A message of a schema.
pub(super) trait Message: Serialize + JsonSchema {
    /// The schema's name; those of Foxglove begin with `foxglove.`.
    const SCHEMA: &'static str;
}

/// Seconds and nanoseconds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, JsonSchema)]
pub(super) struct Time {
    sec: u64,
    nsec: u32,
}

#[derive(Clone, Copy, Debug, Serialize, JsonSchema)]
pub(super) struct Xyz {
    x: f64,
    y: f64,
    z: f64,
}

#[derive(Clone, Copy, Debug, Serialize, JsonSchema)]
pub(super) struct Rotation {
    x: f64,
    y: f64,
    z: f64,
    w: f64,
}

#[derive(Clone, Copy, Debug, Serialize, JsonSchema)]
pub(super) struct Pose {
    position: Xyz,
    orientation: Rotation,
}

#[derive(Clone, Copy, Debug, Serialize, JsonSchema)]
pub(super) struct Colour {
    r: f64,
    g: f64,
    b: f64,
    a: f64,
}

/// Where frames are.
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

/// What is drawn.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub(super) struct SceneUpdate {
    pub(super) deletions: Vec<Deletion>,
    pub(super) entities: Vec<Entity>,
}

/// What is drawn no longer.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub(super) struct Deletion {
    timestamp: Time,
    /// 0: the body of this name.
    #[serde(rename = "type")]
    kind: u8,
    id: String,
}

/// A body of the scene, which stands until one of the same name comes, or its time is over.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub(super) struct Entity {
    pub(super) timestamp: Time,
    pub(super) frame_id: String,
    pub(super) id: String,
    pub(super) lifetime: Time,
    pub(super) frame_locked: bool,
    pub(super) cubes: Vec<Shape>,
    pub(super) spheres: Vec<Shape>,
}

/// A cube or an ellipsoid.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub(super) struct Shape {
    pose: Pose,
    size: Xyz,
    color: Colour,
}

/// The joints of the robot as numbers, by their names.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub(super) struct JointStates {
    /// \[m or rad\]
    pub(super) position: std::collections::BTreeMap<String, f64>,
    /// \[m/s or rad/s\]
    pub(super) velocity: std::collections::BTreeMap<String, f64>,
}

/// How good the posture is, and how the controller fares.
#[derive(Clone, Copy, Debug, Serialize, JsonSchema)]
pub(super) struct Scores {
    /// e_s of the predicted posture, 0 to 4.25.
    pub(super) ergonomics: f64,
    /// REBA of the predicted posture, 1 to 15.
    pub(super) reba: u8,
    /// REBA of the measured one.
    pub(super) reba_measured: Option<u8>,
    /// Whether person and robot work together.
    pub(super) together: bool,
    /// How far the tool is from x_d \[m\].
    pub(super) tracking_error: f64,
    /// How far the workspace gives way \[m\].
    pub(super) slack: f64,
    /// A step of the controller \[µs\].
    pub(super) step_us: f64,
}

impl Message for FrameTransforms {
    const SCHEMA: &'static str = "foxglove.FrameTransforms";
}

impl Message for SceneUpdate {
    const SCHEMA: &'static str = "foxglove.SceneUpdate";
}

impl Message for JointStates {
    const SCHEMA: &'static str = "moca.JointStates";
}

impl Message for Scores {
    const SCHEMA: &'static str = "moca.Scores";
}

impl Time {
    /// Of a time that is not negative \[s\].
    pub(super) fn new(seconds: f64) -> Self {
        let nanoseconds = nanoseconds(seconds);
        // The rest is below 10⁹.
        let nsec = (nanoseconds % 1_000_000_000) as u32;
        Self { sec: nanoseconds / 1_000_000_000, nsec }
    }
}

/// A time in nanoseconds; zero if it is negative.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "`as` saturates")]
pub(super) fn nanoseconds(seconds: f64) -> u64 {
    (seconds * 1e9).round() as u64
}

impl From<Vector3<f64>> for Xyz {
    fn from(vector: Vector3<f64>) -> Self {
        Self { x: vector.x, y: vector.y, z: vector.z }
    }
}

impl From<UnitQuaternion<f64>> for Rotation {
    fn from(rotation: UnitQuaternion<f64>) -> Self {
        let coordinates = rotation.coords;
        Self { x: coordinates.x, y: coordinates.y, z: coordinates.z, w: coordinates.w }
    }
}

impl FrameTransform {
    /// A frame in the world.
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

impl Colour {
    /// The joints of a person.
    pub(super) const PERSON: Self = Self { r: 0.9, g: 0.5, b: 0.1, a: 1.0 };
    /// The shared workspace.
    pub(super) const WORKSPACE: Self = Self { r: 0.2, g: 0.6, b: 0.9, a: 0.25 };
    /// x_d.
    pub(super) const DESIRED: Self = Self { r: 0.1, g: 0.7, b: 0.3, a: 1.0 };
}

impl Shape {
    /// Along the world's axes about a centre \[m\].
    pub(super) fn new(centre: Vector3<f64>, size: Vector3<f64>, color: Colour) -> Self {
        let pose = Pose { position: centre.into(), orientation: UnitQuaternion::identity().into() };
        Self { pose, size: size.into(), color }
    }
}

impl Entity {
    /// In the world, for so long \[s\]; zero is for ever.
    pub(super) fn new(id: &str, time: Time, lifetime: f64) -> Self {
        Self {
            timestamp: time,
            frame_id: "world".to_owned(),
            id: id.to_owned(),
            lifetime: Time::new(lifetime),
            frame_locked: false,
            cubes: Vec::new(),
            spheres: Vec::new(),
        }
    }
}

impl Deletion {
    /// Of the body of this name.
    pub(super) fn new(id: &str, time: Time) -> Self {
        Self { timestamp: time, kind: 0, id: id.to_owned() }
    }
}

impl From<Vec<Entity>> for SceneUpdate {
    fn from(entities: Vec<Entity>) -> Self {
        Self { deletions: Vec::new(), entities }
    }
}
