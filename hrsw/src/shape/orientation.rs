//! Shapes that bound an orientation.

use ahqp_core::{left_jacobian_inverse, rotation_log};
use nalgebra::{UnitQuaternion, Vector3};

use super::bounds::Bounds;
use super::cone::{Cone, check_angle};
use super::mesh::Mesh;
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

    /// Returns a surface around the possible positions of the tip of `axis` \[m\], for drawing.
    /// `axis` is in the axes of the tool.
    pub fn mesh(&self, axis: &Vector3<f64>) -> Mesh {
        match self {
            Self::Box(bounds) => tips_of_box(bounds, axis),
            Self::Cone(cone) => tips_of_cone(cone, axis.norm()),
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

/// Returns the images of a grid on each face of the box.
fn tips_of_box(bounds: &Bounds, axis: &Vector3<f64>) -> Mesh {
    const STEPS: usize = 6;
    let cube = Mesh::of_box(bounds.corners());
    let mut mesh = Mesh { vertices: Vec::new(), triangles: Vec::new() };
    let corner = |index: usize| cube.vertices.get(index).copied().unwrap_or_default();
    // Two triangles of a face share their first corner: [a, b, c] and [a, c, d].
    for pair in cube.triangles.chunks_exact(2) {
        let ([a, b, _], [_, _, d]) = (pair[0], pair[1]);
        let (a, b, d) = (corner(a), corner(b), corner(d));
        let begin = mesh.vertices.len();
        for i in 0..=STEPS {
            for j in 0..=STEPS {
                let (u, v) = (i as f64 / STEPS as f64, j as f64 / STEPS as f64);
                let vector = a + (b - a) * u + (d - a) * v;
                mesh.vertices.push(UnitQuaternion::from_scaled_axis(vector) * axis);
            }
        }
        for i in 0..STEPS {
            for j in 0..STEPS {
                let here = begin + i * (STEPS + 1) + j;
                let beyond = here + STEPS + 1;
                mesh.triangles.push([here, beyond, beyond + 1]);
                mesh.triangles.push([here, beyond + 1, here + 1]);
            }
        }
    }
    mesh
}

fn tips_of_cone(cone: &Cone, length: f64) -> Mesh {
    const AROUND: usize = 24;
    let direction = cone.direction().into_inner();
    let right = cone.turn(&UnitQuaternion::identity());
    let right = (right - direction * right.dot(&direction)).normalize();
    let up = direction.cross(&right);
    let (sine, cosine) = cone.half_angle().sin_cos();
    let ring = (0..AROUND).map(|i| {
        let (s, c) = (std::f64::consts::TAU * i as f64 / AROUND as f64).sin_cos();
        (direction * cosine + (right * c + up * s) * sine) * length
    });
    Mesh::of_rings(Vector3::zeros(), std::iter::once(ring.collect()), direction * length)
}
