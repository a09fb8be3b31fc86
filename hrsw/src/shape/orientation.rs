//! The shapes that an orientation may be held in.

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
    /// An axis near a direction, its roll free.
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

/// `value` ≤ `bound`, with the gradient of the value.
#[derive(Debug, Clone, Copy)]
pub(crate) struct OrientationRow {
    /// With respect to the angular velocity in the axes of the reference.
    pub(crate) gradient: Vector3<f64>,
    /// What the slack acts along: the coordinate of a box, the turn of a cone.
    pub(crate) axes: Vector3<f64>,
    pub(crate) value: f64,
    pub(crate) bound: f64,
}

impl OrientationShape {
    /// # Errors
    /// [`Error::Value`] for bounds whose corners come near half a turn.
    pub fn validate(&self) -> Result<(), Error> {
        let Self::Box(bounds) = self else { return Ok(()) };
        let angle = bounds.min().abs().sup(&bounds.max().abs()).norm();
        check_angle(angle)
    }

    /// How many rows bound it.
    pub fn row_count(&self) -> usize {
        match self {
            Self::Box(_) => 6,
            Self::Cone(_) => 1,
        }
    }

    /// Returns true if the orientation, in the axes of the reference, lies within.
    pub fn contains(&self, rotation: &UnitQuaternion<f64>) -> bool {
        match self {
            Self::Box(bounds) => bounds.contains(&rotation_log(rotation)),
            Self::Cone(cone) => cone.contains(rotation),
        }
    }

    /// By how much the orientation leaves the shape \[rad\]; negative within. For a box the
    /// distance of rotation vectors.
    pub fn signed_distance(&self, rotation: &UnitQuaternion<f64>) -> f64 {
        match self {
            Self::Box(bounds) => bounds.signed_distance(&rotation_log(rotation)),
            Self::Cone(cone) => cone.signed_distance(rotation),
        }
    }

    /// The nearest orientation within, for a box by rotation vectors.
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

    /// Where the tip of `axis` \[m\], in the axes of the tool, may lie: a surface around it,
    /// for drawing.
    pub fn mesh(&self, axis: &Vector3<f64>) -> Mesh {
        match self {
            Self::Box(bounds) => tips_of_box(bounds, axis),
            Self::Cone(cone) => tips_of_cone(cone, axis.norm()),
        }
    }

    /// The turn from the nearest orientation within, as `signed_distance` measures it.
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

/// A rotation with its rotation vector and how that changes, computed once for all rows.
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

    /// log R \[rad\].
    pub(crate) fn vector(&self) -> &Vector3<f64> {
        &self.vector
    }

    /// The gradient of direction · log R with respect to the angular velocity.
    fn coordinate_gradient(&self, direction: &Vector3<f64>) -> Vector3<f64> {
        self.vector_rate.tr_mul(direction)
    }
}

/// The images of a grid on each face of the box.
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
