//! Solids of a scene, each fixed to a frame that moves.

use nalgebra::Isometry3;
use serde::Serialize;

/// Shape about the origin of its own axes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
pub enum Shape {
    /// Box with these edges \[m\].
    Box {
        /// Edges along x, y and z.
        size: [f64; 3],
    },
    /// Cylinder along z with half balls at its ends \[m\].
    Capsule {
        /// Distance of the balls' centres.
        length: f64,
        /// Radius of balls and cylinder.
        radius: f64,
    },
    /// Cylinder along z \[m\].
    Cylinder {
        /// Distance of the ends.
        length: f64,
        /// Radius of the ends.
        radius: f64,
    },
    /// Ball \[m\].
    Sphere {
        /// Radius of the ball.
        radius: f64,
    },
}

/// Role of a solid.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Role {
    /// The robot.
    Robot,
    /// Object that person and robot work on.
    Object,
    /// Tool of the person.
    Tool,
    /// Surroundings.
    Surroundings,
}

/// Named shape, fixed to a frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Solid {
    /// Name that readers see.
    pub name: String,
    /// Role.
    pub role: Role,
    /// Index of its frame in [`Stage::frames`].
    pub frame: usize,
    /// Pose of the shape's axes in the frame.
    pub frame_from_shape: Isometry3<f64>,
    /// Shape.
    pub shape: Shape,
    /// Red, green and blue, each from 0 to 1.
    pub colour: [f64; 3],
}

/// Solids and the frames that carry them.
///
/// ```
/// use moca_replay::recorded::{Role, Shape, Stage};
/// use moca_model::{MOCA_URDF, moca};
///
/// let mut stage = Stage::of_robot(&moca()?, MOCA_URDF)?;
/// let object = Shape::Box { size: [0.4, 0.05, 0.3] };
/// let frame = stage.add_frame("object");
/// stage.add("object", Role::Object, frame, object, [0.6, 0.5, 0.3]);
/// assert_eq!(stage.frames().last().map(String::as_str), Some("object"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Stage {
    frames: Vec<String>,
    solids: Vec<Solid>,
}

impl Stage {
    /// Returns the frames, in the order in which their poses are recorded.
    pub fn frames(&self) -> &[String] {
        &self.frames
    }

    /// Returns the solids.
    pub fn solids(&self) -> &[Solid] {
        &self.solids
    }

    /// Returns the frame with this name. Adds it if there is none.
    pub fn add_frame(&mut self, name: &str) -> usize {
        let known = self.frames.iter().position(|frame| frame == name);
        known.unwrap_or_else(|| {
            self.frames.push(name.to_owned());
            self.frames.len() - 1
        })
    }

    /// Adds a solid in the axes of a frame.
    pub fn add(&mut self, name: &str, role: Role, frame: usize, shape: Shape, colour: [f64; 3]) {
        let frame_from_shape = Isometry3::identity();
        self.push(Solid { name: name.to_owned(), role, frame, frame_from_shape, shape, colour });
    }

    /// Adds a solid.
    pub fn push(&mut self, solid: Solid) {
        self.solids.push(solid);
    }
}
