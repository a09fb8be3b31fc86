//! Normal equations of a sum of squares, accumulated row by row.

use nalgebra::{SMatrix, SVector, Vector3};

use crate::joints::DOF;

/// Derivatives of a residual with respect to the joints.
pub(super) type Row = [f64; DOF];

/// The cost ½ Σ r² with its gradient Σ r ∂r and its Gauss–Newton matrix Σ ∂r ∂rᵀ. `curvature` is
/// the term Σ r ∂²r that Gauss–Newton leaves out, as far as it is known.
#[derive(Debug, Clone)]
pub(super) struct Normal {
    pub(super) cost: f64,
    pub(super) gradient: SVector<f64, DOF>,
    /// Only the lower triangle is filled.
    pub(super) matrix: SMatrix<f64, DOF, DOF>,
    /// Only the lower triangle is filled.
    pub(super) curvature: SMatrix<f64, DOF, DOF>,
}

impl Normal {
    pub(super) fn new() -> Self {
        Self {
            cost: 0.0,
            gradient: SVector::zeros(),
            matrix: SMatrix::zeros(),
            curvature: SMatrix::zeros(),
        }
    }

    /// Adds a residual with its derivatives.
    pub(super) fn add(&mut self, residual: f64, row: &Row) {
        self.cost += 0.5 * residual * residual;
        for (j, &derivative) in row.iter().enumerate() {
            self.gradient[j] += residual * derivative;
            for (i, other) in row.iter().enumerate().skip(j) {
                self.matrix[(i, j)] += other * derivative;
            }
        }
    }

    /// Adds a residual of a single joint.
    pub(super) fn add_joint(&mut self, joint: usize, residual: f64, derivative: f64) {
        self.cost += 0.5 * residual * residual;
        self.gradient[joint] += residual * derivative;
        self.matrix[(joint, joint)] += derivative * derivative;
    }

    /// Adds the chosen axes of a vector residual, all scaled.
    pub(super) fn add_axes(
        &mut self,
        axes: &[usize],
        residual: &Vector3<f64>,
        columns: &[Vector3<f64>; DOF],
        scale: f64,
    ) {
        for &axis in axes {
            self.add(scale * residual[axis], &columns.map(|column| scale * column[axis]));
        }
    }
}
