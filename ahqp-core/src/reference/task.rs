//! What a level of the cascade minimises, whatever kind of level it was.

use nalgebra::{DMatrix, DVector};

use super::singular::RightSingular;
use crate::problem::hierarchy::Hierarchy;
use crate::problem::rows::Rows;

/// Singular values below this fraction of the largest count as zero \[-\].
const SINGULAR: f64 = 1e-12;
/// The part of a gradient in the nullspace of its Hessian is rounding below this fraction \[-\].
const TILTED: f64 = 1e-9;

/// ½ Σ (distance of a row of A x to its range)² + linearᵀx.
pub(super) struct Task {
    /// A.
    pub(super) matrix: DMatrix<f64>,
    pub(super) lower: DVector<f64>,
    pub(super) upper: DVector<f64>,
    pub(super) linear: DVector<f64>,
}

impl Task {
    /// The violation of `rows` over n variables.
    pub(super) fn of_rows(rows: &Rows, n: usize) -> Self {
        let coefficients: Vec<_> = rows.iter().map(|(a, ..)| a).collect();
        Self {
            matrix: DMatrix::from_fn(rows.len(), n, |i, j| coefficients[i][j]),
            lower: DVector::from_column_slice(rows.lower()),
            upper: DVector::from_column_slice(rows.upper()),
            linear: DVector::zeros(n),
        }
    }

    /// The violation of rows, with their bounds multiplied by the roots of their weights; rows that weigh
    /// nothing are left out.
    pub(super) fn of_weighted(rows: &Rows, n: usize) -> Self {
        let kept: Vec<_> = rows
            .iter()
            .enumerate()
            .map(|(index, row)| (rows.weight(index).sqrt(), row))
            .filter(|(root, _)| *root > 0.0)
            .collect();
        Self {
            matrix: DMatrix::from_fn(kept.len(), n, |i, j| kept[i].0 * kept[i].1.0[j]),
            lower: DVector::from_fn(kept.len(), |i, _| kept[i].0 * kept[i].1.1),
            upper: DVector::from_fn(kept.len(), |i, _| kept[i].0 * kept[i].1.2),
            linear: DVector::zeros(n),
        }
    }

    /// The violation of the bounds of the variables.
    pub(super) fn of_bounds(hierarchy: &Hierarchy) -> Self {
        let n = hierarchy.variables();
        Self {
            matrix: DMatrix::identity(n, n),
            lower: DVector::from_column_slice(hierarchy.lower()),
            upper: DVector::from_column_slice(hierarchy.upper()),
            linear: DVector::zeros(n),
        }
    }

    /// ½‖x‖².
    pub(super) fn least_norm(n: usize) -> Self {
        let zero = DVector::zeros(n);
        let matrix = DMatrix::identity(n, n);
        Self { matrix, lower: zero.clone(), upper: zero.clone(), linear: zero }
    }

    /// ½xᵀHx + gᵀx = ½‖Rx − b‖² + linearᵀx + constant with H = VΣVᵀ, R = Σ^½ Vᵀ and
    /// b = −Σ^−½ Vᵀg, over the singular values that are not zero. None, if they do not converge.
    pub(super) fn of_quadratic(hessian: &DMatrix<f64>, gradient: &DVector<f64>) -> Option<Self> {
        let n = gradient.len();
        let RightSingular { values, vectors } = RightSingular::new(hessian.clone())?;
        let rank = values.iter().take_while(|&&value| value > SINGULAR * values[0]).count();
        let vectors = vectors.columns(0, rank);
        let along = vectors.transpose() * gradient;
        let across = gradient - vectors * &along;
        let tilted = across.norm() > TILTED * gradient.norm();
        let target = DVector::from_fn(rank, |i, _| -along[i] / values[i].sqrt());
        Some(Self {
            matrix: DMatrix::from_fn(rank, n, |i, j| values[i].sqrt() * vectors[(j, i)]),
            lower: target.clone(),
            upper: target,
            linear: if tilted { across } else { DVector::zeros(n) },
        })
    }
}
