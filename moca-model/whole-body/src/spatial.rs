//! Poses, and pairs of a linear and an angular vector.

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

    /// The pose of C in A, where `self` is that of B in A and `next` that of C in B.
    #[inline]
    pub(crate) fn then(&self, next: &Self) -> Self {
        Self {
            rotation: self.rotation * next.rotation,
            position: self.position + self.rotation * next.position,
        }
    }

    /// The direction of the z axis, which is the axis of the joint.
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

/// The kind of motion of a joint relative to its axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Motion {
    /// Rotation about the axis \[rad\].
    Turns,
    /// Translation along the axis \[m\].
    Slides,
}

/// A linear and an angular vector in world axes: a twist, an acceleration, or a wrench.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Spatial {
    pub(crate) linear: Vector3<f64>,
    pub(crate) angular: Vector3<f64>,
}

impl Motion {
    /// The component of a wrench at the axis that a motor must exert.
    #[inline]
    pub(crate) fn part(self, axis: &Vector3<f64>, force: &Spatial) -> f64 {
        match self {
            Self::Turns => axis.dot(&force.angular),
            Self::Slides => axis.dot(&force.linear),
        }
    }
}

impl Spatial {
    pub(crate) const ZERO: Self =
        Self { linear: Vector3::new(0.0, 0.0, 0.0), angular: Vector3::new(0.0, 0.0, 0.0) };

    /// The vector of six numbers, linear, then angular.
    pub(crate) fn to_vector(self) -> Vector6<f64> {
        let Self { linear, angular } = self;
        Vector6::new(linear.x, linear.y, linear.z, angular.x, angular.y, angular.z)
    }

    pub(crate) fn from_vector(vector: &Vector6<f64>) -> Self {
        Self {
            linear: Vector3::new(vector[0], vector[1], vector[2]),
            angular: Vector3::new(vector[3], vector[4], vector[5]),
        }
    }

    /// The product of a motion and a force at one point: power, or a torque along an axis.
    #[inline]
    pub(crate) fn dot(&self, other: &Self) -> f64 {
        self.linear.dot(&other.linear) + self.angular.dot(&other.angular)
    }

    /// Both vectors in the axes of a frame with this `rotation` in the present axes.
    pub(crate) fn in_axes_of(&self, rotation: &Matrix3<f64>) -> Self {
        Self { linear: rotation.tr_mul(&self.linear), angular: rotation.tr_mul(&self.angular) }
    }
}
