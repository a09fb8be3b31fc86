//! The sides of a box.

use nalgebra::Vector3;

/// A side of a box, by the axis of the object that points out of it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum BoxSide {
    /// +x.
    Front,
    /// −x.
    Back,
    /// +y.
    Left,
    /// −y.
    Right,
    /// +z.
    Top,
    /// −z.
    Bottom,
}

impl BoxSide {
    /// The unit vector out of the box, in the object's axes.
    pub fn normal(self) -> Vector3<f64> {
        match self {
            Self::Front => Vector3::x(),
            Self::Back => -Vector3::x(),
            Self::Left => Vector3::y(),
            Self::Right => -Vector3::y(),
            Self::Top => Vector3::z(),
            Self::Bottom => -Vector3::z(),
        }
    }
}
