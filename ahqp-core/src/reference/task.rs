//! Objective of a level of the cascade, in one form for every kind of level.

use nalgebra::{DMatrix, DVector};

use super::singular::RightSingular;
use crate::problem::hierarchy::Hierarchy;
use crate::problem::rows::Rows;

/// Singular values below this fraction of the largest count as zero \[-\].
const SINGULAR: f64 = 1e-12;
/// Largest part of a gradient in the nullspace of its Hessian that is rounding \[-\].
const TILTED: f64 = 1e-9;

/// The objective ½ Σ (distance of a row of A x to its range)² + linearᵀx.
pub(super) struct Task {
    /// The matrix A.
    pub(super) matrix: DMatrix<f64>,
    pub(super) lower: DVector<f64>,
    pub(super) upper: DVector<f64>,
    pub(super) linear: DVector<f64>,
}

impl Task {
    /// Creates the violation of `rows` over n variables.
    pub(super) fn of_rows(rows: &Rows, n: usize) -> Self {
        let coefficients: Vec<_> = rows.iter().map(|(a, ..)| a).collect();
        Self {
            matrix: DMatrix::from_fn(rows.len(), n, |i, j| coefficients[i][j]),
            lower: DVector::from_column_slice(rows.lower()),
            upper: DVector::from_column_slice(rows.upper()),
            linear: DVector::zeros(n),
        }
    }

    /// Creates the violation of rows that are multiplied, with their bounds, by the roots of their
    /// weights. Rows of weight zero are left out.
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

    /// Creates the violation of the bounds of the variables.
    pub(super) fn of_bounds(hierarchy: &Hierarchy) -> Self {
        let n = hierarchy.variables();
        Self {
            matrix: DMatrix::identity(n, n),
            lower: DVector::from_column_slice(hierarchy.lower()),
            upper: DVector::from_column_slice(hierarchy.upper()),
            linear: DVector::zeros(n),
        }
    }

    /// Creates ½‖x‖².
    pub(super) fn least_norm(n: usize) -> Self {
        let zero = DVector::zeros(n);
        let matrix = DMatrix::identity(n, n);
        Self { matrix, lower: zero.clone(), upper: zero.clone(), linear: zero }
    }

    /// Writes ½xᵀHx + gᵀx as ½‖Rx − b‖² + linearᵀx + constant.
    ///
    /// H is VΣVᵀ, R is Σ^½ Vᵀ and b is −Σ^−½ Vᵀg, over the nonzero singular values. None if they do
    /// not converge.
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
