//! The inertia of bodies whose joints are free to move.

use nalgebra::{Matrix3, Matrix6, Vector3};

use super::symmetric::Symmetric3;
use super::world::WorldInertia;
use crate::spatial::{Motion, Spatial};

/// The inertia of a body whose subtree is free to move. It gives the force and moment [F; N] = [M C; Cᵀ I] [v; ω] at
/// the body's origin.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ArticulatedInertia {
    mass: Symmetric3,
    coupling: Matrix3<f64>,
    inertia: Symmetric3,
}

/// One joint's part of the factorisation.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ArticulatedJoint {
    /// U = Iᴬ s: the force for a unit acceleration of the joint.
    pub(crate) force: Spatial,
    /// 1/D, D = sᵀ Iᴬ s.
    pub(crate) inverse: f64,
}

impl ArticulatedInertia {
    pub(crate) const ZERO: Self = Self {
        mass: Symmetric3::ZERO,
        coupling: Matrix3::new(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
        inertia: Symmetric3::ZERO,
    };

    #[inline]
    pub(crate) fn rigid(body: &WorldInertia) -> Self {
        let (x, y, z) = (body.moment.x, body.moment.y, body.moment.z);
        Self {
            mass: Symmetric3::scalar(body.mass),
            coupling: Matrix3::new(0.0, z, -y, -z, 0.0, x, y, -x, 0.0),
            inertia: body.inertia,
        }
    }

    /// The force for a unit acceleration along or about an axis through the origin, and its component along or about
    /// that axis.
    #[inline]
    pub(crate) fn along(&self, motion: Motion, axis: &Vector3<f64>) -> (Spatial, f64) {
        match motion {
            Motion::Turns => {
                let angular = self.inertia.times(axis);
                (Spatial { linear: self.coupling * axis, angular }, angular.dot(axis))
            }
            Motion::Slides => {
                let linear = self.mass.times(axis);
                (Spatial { linear, angular: self.coupling.tr_mul(axis) }, linear.dot(axis))
            }
        }
    }

    /// The largest possible value of the component along an axis.
    #[inline]
    pub(crate) fn size(&self, motion: Motion) -> f64 {
        match motion {
            Motion::Turns => self.inertia.trace(),
            Motion::Slides => self.mass.trace(),
        }
    }

    /// The inertia that remains beyond a free joint, which was computed by `along`.
    #[inline]
    pub(crate) fn without(&self, joint: &ArticulatedJoint) -> Self {
        let (linear, angular) = (&joint.force.linear, &joint.force.angular);
        Self {
            mass: self.mass.plus(&Symmetric3::outer(-joint.inverse, linear)),
            coupling: minus_outer(&self.coupling, &(joint.inverse * linear), angular),
            inertia: self.inertia.plus(&Symmetric3::outer(-joint.inverse, angular)),
        }
    }

    /// Adds the inertia of a body whose origin is `apart` from this one's.
    #[inline]
    pub(crate) fn add(&mut self, other: &Self, apart: &Vector3<f64>) {
        // v' = v − [d]ω and N = N' + [d]F give C = C' − M'[d], I = I' + [d]C − C'ᵀ[d].
        let coupling = other.coupling - other.mass.times_cross(apart);
        let (left, right) = (cross_times(apart, &coupling), cross_times(apart, &other.coupling));
        let moved = Symmetric3 {
            xx: left[(0, 0)] + right[(0, 0)],
            yy: left[(1, 1)] + right[(1, 1)],
            zz: left[(2, 2)] + right[(2, 2)],
            xy: left[(0, 1)] + right[(1, 0)],
            xz: left[(0, 2)] + right[(2, 0)],
            yz: left[(1, 2)] + right[(2, 1)],
        };
        self.mass = self.mass.plus(&other.mass);
        self.coupling += coupling;
        self.inertia = self.inertia.plus(&other.inertia).plus(&moved);
    }

    pub(crate) fn to_matrix(self) -> Matrix6<f64> {
        let mut matrix = Matrix6::zeros();
        matrix.fixed_view_mut::<3, 3>(0, 0).copy_from(&self.mass.to_matrix());
        matrix.fixed_view_mut::<3, 3>(0, 3).copy_from(&self.coupling);
        matrix.fixed_view_mut::<3, 3>(3, 0).copy_from(&self.coupling.transpose());
        matrix.fixed_view_mut::<3, 3>(3, 3).copy_from(&self.inertia.to_matrix());
        matrix
    }
}

impl ArticulatedJoint {
    pub(crate) const ZERO: Self = Self { force: Spatial::ZERO, inverse: 0.0 };
}

/// A − a bᵀ.
#[inline]
fn minus_outer(m: &Matrix3<f64>, a: &Vector3<f64>, b: &Vector3<f64>) -> Matrix3<f64> {
    Matrix3::new(
        m[(0, 0)] - a.x * b.x,
        m[(0, 1)] - a.x * b.y,
        m[(0, 2)] - a.x * b.z,
        m[(1, 0)] - a.y * b.x,
        m[(1, 1)] - a.y * b.y,
        m[(1, 2)] - a.y * b.z,
        m[(2, 0)] - a.z * b.x,
        m[(2, 1)] - a.z * b.y,
        m[(2, 2)] - a.z * b.z,
    )
}

/// [d] A.
#[inline]
fn cross_times(d: &Vector3<f64>, a: &Matrix3<f64>) -> Matrix3<f64> {
    let columns = [0, 1, 2].map(|index| d.cross(&a.column(index)));
    Matrix3::from_columns(&columns)
}
