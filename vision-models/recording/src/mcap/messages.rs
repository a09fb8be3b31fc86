//! Messages with the schemas that Foxglove knows by name.

use nalgebra::{UnitQuaternion, Vector3};
use schemars::JsonSchema;
use serde::Serialize;

/// A message with a schema.
pub trait Message: Serialize + JsonSchema {
    /// Name of the schema. Those of Foxglove begin with `foxglove.`.
    const SCHEMA: &'static str;
}

/// Seconds and nanoseconds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, JsonSchema)]
pub struct Time {
    sec: u64,
    nsec: u32,
}

/// Coordinates, or sizes along three axes \[m\].
#[derive(Clone, Copy, Debug, Serialize, JsonSchema)]
pub struct Xyz {
    x: f64,
    y: f64,
    z: f64,
}

/// A unit quaternion.
#[derive(Clone, Copy, Debug, Serialize, JsonSchema)]
pub struct Rotation {
    x: f64,
    y: f64,
    z: f64,
    w: f64,
}

#[derive(Clone, Copy, Debug, Serialize, JsonSchema)]
struct Pose {
    position: Xyz,
    orientation: Rotation,
}

/// A colour and its opacity, each from 0 to 1.
#[derive(Clone, Copy, Debug, Serialize, JsonSchema)]
pub struct Colour {
    r: f64,
    g: f64,
    b: f64,
    a: f64,
}

/// An update of the scene.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct SceneUpdate {
    /// Bodies that are removed.
    pub deletions: Vec<Deletion>,
    /// Bodies that are added, or replace those of the same name.
    pub entities: Vec<Entity>,
}

/// The removal of a body.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Deletion {
    timestamp: Time,
    /// 0 removes the body of this name.
    #[serde(rename = "type")]
    kind: u8,
    id: String,
}

/// A body of the scene. It is displayed until another one of the same name replaces it, or its
/// lifetime ends.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Entity {
    timestamp: Time,
    frame_id: String,
    id: String,
    lifetime: Time,
    frame_locked: bool,
    /// Boxes.
    pub cubes: Vec<Shape>,
    /// Ellipsoids.
    pub spheres: Vec<Shape>,
}

/// A cube or an ellipsoid.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Shape {
    pose: Pose,
    size: Xyz,
    color: Colour,
}

impl Message for SceneUpdate {
    const SCHEMA: &'static str = "foxglove.SceneUpdate";
}

impl Time {
    /// Creates a time from seconds that are not negative \[s\].
    pub fn new(seconds: f64) -> Self {
        let nanoseconds = nanoseconds(seconds);
        // The remainder is below 10⁹.
        let nsec = (nanoseconds % 1_000_000_000) as u32;
        Self { sec: nanoseconds / 1_000_000_000, nsec }
    }
}

/// Returns a time in nanoseconds, or zero if it is negative.
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

impl Colour {
    /// Colour of a person's joints.
    pub const PERSON: Self = Self { r: 0.9, g: 0.5, b: 0.1, a: 1.0 };
    /// Colour of the shared workspace.
    pub const WORKSPACE: Self = Self { r: 0.2, g: 0.6, b: 0.9, a: 0.25 };
    /// Colour of x_d.
    pub const DESIRED: Self = Self { r: 0.1, g: 0.7, b: 0.3, a: 1.0 };
}

impl Shape {
    /// Creates a shape along the world's axes around a centre \[m\].
    pub fn new(centre: Vector3<f64>, size: Vector3<f64>, color: Colour) -> Self {
        let pose = Pose { position: centre.into(), orientation: UnitQuaternion::identity().into() };
        Self { pose, size: size.into(), color }
    }
}

impl Entity {
    /// Creates a body in the world with this lifetime \[s\]. Zero has no limit.
    pub fn new(id: &str, time: Time, lifetime: f64) -> Self {
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
    /// Creates the removal of the body of this name.
    pub fn new(id: &str, time: Time) -> Self {
        Self { timestamp: time, kind: 0, id: id.to_owned() }
    }
}

impl From<Vec<Entity>> for SceneUpdate {
    fn from(entities: Vec<Entity>) -> Self {
        Self { deletions: Vec::new(), entities }
    }
}
