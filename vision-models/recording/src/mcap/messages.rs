//! Messages, with the schemas that Foxglove knows by their names.

use nalgebra::{UnitQuaternion, Vector3};
use schemars::JsonSchema;
use serde::Serialize;

/// A message of a schema.
pub trait Message: Serialize + JsonSchema {
    /// The schema's name; those of Foxglove begin with `foxglove.`.
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

/// What is drawn.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct SceneUpdate {
    /// Bodies that go.
    pub deletions: Vec<Deletion>,
    /// Bodies that come, or take the place of those of the same name.
    pub entities: Vec<Entity>,
}

/// What is drawn no longer.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Deletion {
    timestamp: Time,
    /// 0: the body of this name.
    #[serde(rename = "type")]
    kind: u8,
    id: String,
}

/// A body of the scene, which stands until one of the same name comes, or its time is over.
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
    /// Of a time that is not negative \[s\].
    pub fn new(seconds: f64) -> Self {
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

impl Colour {
    /// The joints of a person.
    pub const PERSON: Self = Self { r: 0.9, g: 0.5, b: 0.1, a: 1.0 };
    /// The shared workspace.
    pub const WORKSPACE: Self = Self { r: 0.2, g: 0.6, b: 0.9, a: 0.25 };
    /// x_d.
    pub const DESIRED: Self = Self { r: 0.1, g: 0.7, b: 0.3, a: 1.0 };
}

impl Shape {
    /// Along the world's axes about a centre \[m\].
    pub fn new(centre: Vector3<f64>, size: Vector3<f64>, color: Colour) -> Self {
        let pose = Pose { position: centre.into(), orientation: UnitQuaternion::identity().into() };
        Self { pose, size: size.into(), color }
    }
}

impl Entity {
    /// In the world, for so long \[s\]; zero is for ever.
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
    /// Of the body of this name.
    pub fn new(id: &str, time: Time) -> Self {
        Self { timestamp: time, kind: 0, id: id.to_owned() }
    }
}

impl From<Vec<Entity>> for SceneUpdate {
    fn from(entities: Vec<Entity>) -> Self {
        Self { deletions: Vec::new(), entities }
    }
}
