//! Poses, pairs of a linear and an angular vector, and the inertia of rigid bodies.

use nalgebra::{Isometry3, IsometryMatrix3, Matrix3, Rotation3, Translation3, UnitQuaternion};
use nalgebra::{Vector3, Vector6};

/// A rotation and a position: the pose of one frame in another.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Pose {
    pub(crate) rotation: Matrix3<f64>,
    pub(crate) position: Vector3<f64>,
}

impl Pose {
    pub(crate) fn identity() -> Self {
        Self { rotation: Matrix3::identity(), position: Vector3::zeros() }
    }

    pub(crate) fn from_isometry(pose: &Isometry3<f64>) -> Self {
        Self {
            rotation: *pose.rotation.to_rotation_matrix().matrix(),
            position: pose.translation.vector,
        }
    }

    pub(crate) fn to_isometry(self) -> Isometry3<f64> {
        let rotation = Rotation3::from_matrix_unchecked(self.rotation);
        Isometry3::from_parts(
            Translation3::from(self.position),
            UnitQuaternion::from_rotation_matrix(&rotation),
        )
    }

    pub(crate) fn to_isometry_matrix(self) -> IsometryMatrix3<f64> {
        let rotation = Rotation3::from_matrix_unchecked(self.rotation);
        IsometryMatrix3::from_parts(Translation3::from(self.position), rotation)
    }

    /// The pose of C in A, if `self` is that of B in A and `next` that of C in B.
    #[inline]
    pub(crate) fn then(&self, next: &Self) -> Self {
        Self {
            rotation: self.rotation * next.rotation,
            position: self.position + self.rotation * next.position,
        }
    }

    /// The direction of the z axis, along or about which a joint moves.
    #[inline]
    pub(crate) fn axis(&self) -> Vector3<f64> {
        self.rotation.column(2).into_owned()
    }

    /// R ← R · Rz(angle).
    #[inline]
    pub(crate) fn turn_about_z(&mut self, angle: f64) {
        let (sin, cos) = angle.sin_cos();
        let x = self.rotation.column(0).into_owned();
        let y = self.rotation.column(1).into_owned();
        self.rotation.set_column(0, &(cos * x + sin * y));
        self.rotation.set_column(1, &(cos * y - sin * x));
    }
}

/// A linear and an angular vector in world axes: a twist, an acceleration, or a force with its
/// moment.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Spatial {
    pub(crate) linear: Vector3<f64>,
    pub(crate) angular: Vector3<f64>,
}

impl Spatial {
    pub(crate) const ZERO: Self =
        Self { linear: Vector3::new(0.0, 0.0, 0.0), angular: Vector3::new(0.0, 0.0, 0.0) };

    /// Linear, then angular.
    pub(crate) fn to_vector(self) -> Vector6<f64> {
        let Self { linear, angular } = self;
        Vector6::new(linear.x, linear.y, linear.z, angular.x, angular.y, angular.z)
    }

    /// Both parts in the axes of a frame that stands at `rotation` in the present ones.
    pub(crate) fn in_axes_of(&self, rotation: &Matrix3<f64>) -> Self {
        Self { linear: rotation.tr_mul(&self.linear), angular: rotation.tr_mul(&self.angular) }
    }
}

/// Mass, centre of mass and inertia of a rigid body in the body's frame.
#[derive(Debug, Clone, Copy)]
pub(crate) struct BodyInertia {
    /// \[kg\]
    pub(crate) mass: f64,
    /// \[m\]
    pub(crate) centre: Vector3<f64>,
    /// About the centre of mass \[kg m²\].
    pub(crate) inertia: Matrix3<f64>,
}

impl BodyInertia {
    pub(crate) fn zero() -> Self {
        Self { mass: 0.0, centre: Vector3::zeros(), inertia: Matrix3::zeros() }
    }

    /// The same in the frame where the body's own stands at `pose`.
    pub(crate) fn placed(&self, pose: &Pose) -> Self {
        Self {
            mass: self.mass,
            centre: pose.position + pose.rotation * self.centre,
            inertia: pose.rotation * self.inertia * pose.rotation.transpose(),
        }
    }

    /// Both bodies as one.
    pub(crate) fn joined(&self, other: &Self) -> Self {
        let mass = self.mass + other.mass;
        let inertia = self.inertia + other.inertia;
        if mass <= 0.0 {
            return Self { mass, centre: self.centre, inertia };
        }
        let centre = self.centre * (self.mass / mass) + other.centre * (other.mass / mass);
        // The parallel axis theorem for two points of the reduced mass.
        let reduced = self.mass * (other.mass / mass);
        let apart = other.centre - self.centre;
        Self { mass, centre, inertia: inertia + about_distance(reduced, &apart) }
    }
}

/// m (|r|² 1 − r rᵀ): the inertia of a point mass at r.
#[inline]
pub(crate) fn about_distance(mass: f64, r: &Vector3<f64>) -> Matrix3<f64> {
    let scaled = mass * r;
    let (xx, yy, zz) = (scaled.x * r.x, scaled.y * r.y, scaled.z * r.z);
    let (xy, xz, yz) = (scaled.x * r.y, scaled.x * r.z, scaled.y * r.z);
    Matrix3::new(yy + zz, -xy, -xz, -xy, xx + zz, -yz, -xz, -yz, xx + yy)
}
