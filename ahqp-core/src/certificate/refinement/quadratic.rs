//! A quadratic objective as rows and a linear term.

use nalgebra::{DMatrix, DVector};

use super::double_double::DoubleDouble;
use super::row::Row;
use super::span::{add_scaled, length};
use crate::certificate::tolerances::{NO_PIVOT, OUTSIDE};

/// Writes the quadratic as ½‖R x − b‖² + dᵀx plus a constant, by a pivoted Cholesky factorisation.
/// d lies outside the range of the Hessian.
pub(super) fn objective(
    hessian: &DMatrix<f64>,
    gradient: &DVector<f64>,
    from: (&[DoubleDouble], f64),
) -> (Vec<Row>, Vec<DoubleDouble>) {
    let n = from.0.len();
    let mut left: Vec<Vec<DoubleDouble>> =
        hessian.row_iter().map(|row| row.iter().map(|&entry| entry.into()).collect()).collect();
    let mut slope: Vec<DoubleDouble> = gradient.iter().map(|&entry| entry.into()).collect();
    let mut rows = Vec::new();
    let part = |left: &[Vec<DoubleDouble>], i: usize| {
        let own = hessian[(i, i)];
        if own > 0.0 { left[i][i].rounded() / own } else { 0.0 }
    };
    for _ in 0..n {
        let best = (0..n).max_by(|&i, &j| part(&left, i).total_cmp(&part(&left, j)));
        let Some(best) = best.filter(|&best| part(&left, best) > NO_PIVOT) else { break };
        let root = left[best][best].sqrt();
        let row: Vec<DoubleDouble> = left[best].iter().map(|&entry| entry / root).collect();
        for (i, entries) in left.iter_mut().enumerate() {
            add_scaled(entries, -row[i], &row);
        }
        let target = -slope[best] / root;
        add_scaled(&mut slope, target, &row);
        rows.push(Row::new(row, [target; 2], 1.0, from));
    }
    if length(&slope) <= OUTSIDE * gradient.norm() {
        slope.fill(DoubleDouble::ZERO);
    }
    (rows, slope)
}
