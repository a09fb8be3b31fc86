//! What stands on the stage: solids, each fixed to a frame that moves.

use nalgebra::Isometry3;
use serde::Serialize;

/// A shape about the origin of its own axes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
pub enum Shape {
    /// A box with these edges \[m\].
    Box {
        /// Along x, y and z.
        size: [f64; 3],
    },
    /// A cylinder along z with half balls at its ends \[m\].
    Capsule {
        /// Between the centres of the balls.
        length: f64,
        /// Of balls and cylinder.
        radius: f64,
    },
    /// A cylinder along z \[m\].
    Cylinder {
        /// From end to end.
        length: f64,
        /// Of the ends.
        radius: f64,
    },
    /// A ball \[m\].
    Sphere {
        /// Of the ball.
        radius: f64,
    },
}

/// What a solid is of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Role {
    /// The robot.
    Robot,
    /// What person and robot work on.
    Object,
    /// What the person works with.
    Tool,
    /// What stands around.
    Surroundings,
}

/// A named shape, fixed to a frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Solid {
    /// Shown to the reader.
    pub name: String,
    /// What it is of.
    pub role: Role,
    /// Index of its frame in [`Stage::frames`].
    pub frame: usize,
    /// Of the shape's axes in the frame.
    pub frame_from_shape: Isometry3<f64>,
    /// What it looks like.
    pub shape: Shape,
    /// Red, green and blue, each from 0 to 1.
    pub colour: [f64; 3],
}

/// All solids, and the frames that carry them.
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
    /// The frames, in the order in which their poses are recorded.
    pub fn frames(&self) -> &[String] {
        &self.frames
    }

    /// The solids.
    pub fn solids(&self) -> &[Solid] {
        &self.solids
    }

    /// The frame of this name, which is added if there is none.
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
