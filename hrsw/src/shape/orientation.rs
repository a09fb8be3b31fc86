//! Shapes that bound an orientation.

use ahqp_core::{left_jacobian_inverse, rotation_log};
use nalgebra::{UnitQuaternion, Vector3};

use super::bounds::Bounds;
use super::cone::{Cone, check_angle};
use crate::error::Error;

/// A set of orientations about a reference.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum OrientationShape {
    /// Bounds of the rotation vector \[rad\].
    Box(Bounds),
    /// An axis near a direction, with free roll.
    Cone(Cone),
}

impl From<Bounds> for OrientationShape {
    fn from(bounds: Bounds) -> Self {
        Self::Box(bounds)
    }
}

impl From<Cone> for OrientationShape {
    fn from(cone: Cone) -> Self {
        Self::Cone(cone)
    }
}

/// The row `value` ≤ `bound`, with the gradient of the value.
#[derive(Debug, Clone, Copy)]
pub(crate) struct OrientationRow {
    /// Gradient with respect to the angular velocity in the axes of the reference.
    pub(crate) gradient: Vector3<f64>,
    /// Direction along which the slack acts: the coordinate of a box, or the turn of a cone.
    pub(crate) axes: Vector3<f64>,
    pub(crate) value: f64,
    pub(crate) bound: f64,
}

impl OrientationShape {
    /// Checks that bounds stay away from half a turn.
    ///
    /// # Errors
    /// [`Error::Value`] if the corners of bounds come near half a turn.
    pub fn validate(&self) -> Result<(), Error> {
        let Self::Box(bounds) = self else { return Ok(()) };
        let angle = bounds.min().abs().sup(&bounds.max().abs()).norm();
        check_angle(angle)
    }

    /// Number of rows that bound the shape.
    pub fn row_count(&self) -> usize {
        match self {
            Self::Box(_) => 6,
            Self::Cone(_) => 1,
        }
    }

    /// Returns true if the orientation, in the axes of the reference, is inside.
    pub fn contains(&self, rotation: &UnitQuaternion<f64>) -> bool {
        match self {
            Self::Box(bounds) => bounds.contains(&rotation_log(rotation)),
            Self::Cone(cone) => cone.contains(rotation),
        }
    }

    /// Returns the angle by which the orientation is outside the shape \[rad\], negative inside. A
    /// box uses the distance of rotation vectors.
    pub fn signed_distance(&self, rotation: &UnitQuaternion<f64>) -> f64 {
        match self {
            Self::Box(bounds) => bounds.signed_distance(&rotation_log(rotation)),
            Self::Cone(cone) => cone.signed_distance(rotation),
        }
    }

    /// Returns the nearest orientation inside. A box uses rotation vectors.
    pub fn nearest(&self, rotation: &UnitQuaternion<f64>) -> UnitQuaternion<f64> {
        match self {
            Self::Box(bounds) => {
                let vector = rotation_log(rotation);
                if bounds.contains(&vector) {
                    return *rotation;
                }
                UnitQuaternion::from_scaled_axis(bounds.nearest(&vector))
            }
            Self::Cone(cone) => cone.nearest(rotation),
        }
    }

    /// Returns the turn from the nearest orientation inside, as `signed_distance` measures it.
    pub(crate) fn violation(&self, at: &RotationPoint) -> Vector3<f64> {
        match self {
            Self::Box(bounds) => at.vector - bounds.nearest(&at.vector),
            Self::Cone(cone) => {
                cone.turn(&at.rotation) * cone.signed_distance(&at.rotation).max(0.0)
            }
        }
    }

    pub(crate) fn row(&self, index: usize, at: &RotationPoint) -> OrientationRow {
        match self {
            Self::Box(bounds) => {
                let face = bounds.face(index);
                OrientationRow {
                    gradient: at.coordinate_gradient(&face.normal),
                    axes: face.normal,
                    value: face.normal.dot(&at.vector),
                    bound: face.offset,
                }
            }
            Self::Cone(cone) => {
                let gradient = cone.turn(&at.rotation);
                let value = cone.angle(&at.rotation);
                OrientationRow { gradient, axes: gradient, value, bound: cone.half_angle() }
            }
        }
    }
}

/// A rotation with its rotation vector and the derivative of that, computed once for all rows.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RotationPoint {
    rotation: UnitQuaternion<f64>,
    vector: Vector3<f64>,
    vector_rate: nalgebra::Matrix3<f64>,
}

impl RotationPoint {
    pub(crate) fn new(rotation: UnitQuaternion<f64>) -> Self {
        let vector = rotation_log(&rotation);
        Self { rotation, vector, vector_rate: left_jacobian_inverse(&vector) }
    }

    /// Returns log R \[rad\].
    pub(crate) fn vector(&self) -> &Vector3<f64> {
        &self.vector
    }

    /// Returns the gradient of direction · log R with respect to the angular velocity.
    fn coordinate_gradient(&self, direction: &Vector3<f64>) -> Vector3<f64> {
        self.vector_rate.tr_mul(direction)
    }
}
