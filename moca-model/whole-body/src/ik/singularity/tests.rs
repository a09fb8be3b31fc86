//! Damping against singular value decompositions.

use nalgebra::{DMatrix, DVector};
use proptest::prelude::*;

use super::*;

/// Damps levels over `columns` variables, highest priority first. Returns for each whether it was changed, and its rows
/// before.
fn damp(levels: &mut [Rows], columns: usize) -> Vec<(bool, Rows)> {
    let counts: Vec<usize> = levels.iter().map(Rows::len).collect();
    let mut damping = SingularityDamping::new(0.1, &counts, columns, columns).clone();
    damping.begin();
    let spans: Vec<_> = levels.iter().map(|rows| damping.load(rows, rows.len())).collect();
    damping.factorise();
    let levels = levels.iter_mut().zip(spans);
    let damped = levels.map(|(rows, span)| {
        let (asked, is_singular) = (rows.clone(), damping.examine(&span, rows));
        if is_singular {
            damping.damp(&span);
            damping.give_up(&span, rows);
        }
        damping.take(&span);
        (is_singular, asked)
    });
    damped.collect()
}

/// The rows after damping, and whether it changed them.
fn damped(a: &DMatrix<f64>, b: &[f64]) -> (Rows, bool) {
    let mut rows = Rows::equalities(a, b).unwrap();
    let damped = damp(std::slice::from_mut(&mut rows), a.ncols());
    (rows, damped[0].0)
}

/// Aᵀ W A and Aᵀ W b of rows, b being the middle of their ranges.
fn normal_equations(rows: &Rows) -> (DMatrix<f64>, DVector<f64>) {
    let n = rows.columns();
    let (mut matrix, mut right) = (DMatrix::zeros(n, n), DVector::zeros(n));
    for (index, (row, lower, upper)) in rows.iter().enumerate() {
        let row = DVector::from_column_slice(row);
        matrix += rows.weight(index) * &row * row.transpose();
        right += rows.weight(index) * 0.5 * (lower + upper) * row;
    }
    (matrix, right)
}

/// Half the width of the widest range.
fn widest(rows: &Rows) -> f64 {
    rows.iter().map(|(_, lower, upper)| 0.5 * (upper - lower)).fold(0.0, f64::max)
}

proptest! {
    #[test]
    fn targets_are_given_up_along_singular_directions(
        entries in prop::collection::vec(-1.0..1.0_f64, 3 * 6),
        b in prop::collection::vec(-1.0..1.0_f64, 3), closeness in 1e-6..1.0_f64,
    ) {
        let mut a = DMatrix::from_row_slice(3, 6, &entries);
        let near = a.row(0) + a.row(2) * closeness;
        a.set_row(2, &near);
        prop_assume!(a.row_iter().all(|row| row.norm() > 0.1));
        let (rows, _) = damped(&a, &b);
        // The reference is the singular value decomposition of the weighted rows. Rows count as at least 0.3 as long
        // as the longest.
        let norms = DVector::from_iterator(3, a.row_iter().map(|row| row.norm()));
        let scale = norms.map(|norm| norm.max(0.3 * norms.max()));
        let unit = DMatrix::from_fn(3, 6, |i, j| a[(i, j)] / scale[i]);
        let inverses = unit.singular_values().map(|sigma| 1.0 / (sigma * sigma));
        let closeness = 1.0 / (inverses.sum() * 0.01);
        let right = DVector::from_iterator(3, b.iter().zip(&scale).map(|(b, scale)| b / scale));
        let speed = (unit.clone().pseudo_inverse(1e-12).unwrap() * &right).norm_squared();
        let mu = (0.1_f64 / 12.0).powi(2)
            + (0.25 * right.norm_squared() + right.norm() / 5.0) * (1.0 - 1.0 / speed.max(1.0));
        let svd = (&a / scale.max()).svd(true, false);
        let u = svd.u.unwrap();
        let mut parts = u.transpose() * DVector::from_column_slice(&b);
        for (part, sigma) in parts.iter_mut().zip(&svd.singular_values) {
            let square = mu * (1.0 - closeness).max(0.0);
            *part *= 1.0 - (square / (square + sigma * sigma)).powi(3);
        }
        let (matrix, found) = normal_equations(&rows);
        prop_assert!((matrix - a.transpose() * &a).norm() < 1e-7);
        prop_assert!((found - a.transpose() * u * parts).norm() < 1e-7);
        // Only directions that are nearly lost become ranges.
        let least = svd.singular_values.min();
        let share = ((9.0 - closeness / 0.01) / 8.0).clamp(0.0, 1.0);
        let room = 0.05 * share * least * (1.0 - least / 0.01).max(0.0);
        prop_assert!((widest(&rows) - scale.max() * room).abs() < 1e-7);
    }

    #[test]
    fn a_well_conditioned_level_keeps_its_targets(
        b in prop::collection::vec(-1.0..1.0_f64, 2), angle in 0.3..2.8_f64,
    ) {
        let a = DMatrix::from_row_slice(2, 3, &[1.0, 0.0, 0.0, angle.cos(), angle.sin(), 0.0]);
        let (rows, changed) = damped(&a, &b);
        prop_assert_eq!(rows, Rows::equalities(&a, &b).unwrap());
        prop_assert!(!changed);
    }

    #[test]
    fn what_a_level_above_determines_is_damped_below(
        gap in 1e-9..0.01_f64, b in -1.0..1.0_f64,
    ) {
        let row = |entries, target| {
            Rows::equalities(&DMatrix::from_row_slice(1, 2, entries), &[target]).unwrap()
        };
        let mut levels = [row(&[1.0, 0.0], 0.5), row(&[1.0, gap], b)];
        let damped = damp(&mut levels, 2);
        let [above, below] = &levels;
        prop_assert!(!damped[0].0 && damped[1].0);
        prop_assert_eq!(above.lower()[0], 0.5);
        prop_assert_eq!(damped[1].1.lower()[0], b);
        // x₀ = 0.5. The rest is left to x₁, is damped, and may exceed the target or miss it.
        let row = below.row(0).unwrap();
        for bound in [below.lower()[0], below.upper()[0]] {
            prop_assert!(((bound - 0.5 * row[0]) / row[1]).abs() <= 3.1);
        }
    }

    /// Whatever other levels there are, and however many rows they have.
    #[test]
    fn damping_of_a_level_ignores_other_levels(
        above in 1_usize..8, own in 1_usize..6, closeness in 1e-6..0.1_f64,
        entries in prop::collection::vec(-1.0..1.0_f64, 6 * 6),
        b in prop::collection::vec(-1.0..1.0_f64, 6),
    ) {
        let columns = 8 + 6;
        let mut a = DMatrix::zeros(own + 1, columns);
        a.columns_mut(8, 6).copy_from(&DMatrix::from_row_slice(6, 6, &entries).rows(0, own + 1));
        let near = a.row(0) + a.row(own) * closeness;
        a.set_row(own, &near);
        prop_assume!(a.row_iter().all(|row| row.norm() > 0.1));
        let own = Rows::equalities(&a, &b[..=own]).unwrap();
        let mut alone = [own.clone()];
        let damped_alone = damp(&mut alone, columns);
        let other = Rows::equalities(&DMatrix::identity(above, columns), &vec![0.3; above]).unwrap();
        let mut both = [other, own];
        let damped = damp(&mut both, columns);
        prop_assert!(!damped[0].0);
        prop_assert_eq!(damped[1].0, damped_alone[0].0);
        for (one, other) in both[1].iter().zip(alone[0].iter()) {
            prop_assert!((one.1 - other.1).abs() < 1e-6 && (one.2 - other.2).abs() < 1e-6);
        }
    }

    #[test]
    fn rows_that_contradict_each_other_keep_their_compromise(
        weight in 0.01..100.0_f64, one in -1.0..1.0_f64, other in -1.0..1.0_f64,
    ) {
        let a = DMatrix::from_row_slice(2, 2, &[1.0, 0.0, 2.0, 0.0]);
        let mut rows = Rows::equalities(&a, &[one, 2.0 * other]).unwrap();
        rows.set_weights(&[weight, 0.25]).unwrap();
        damp(std::slice::from_mut(&mut rows), 2);
        // The second row weighs 0.25 · 4 after scaling to norm one.
        let (matrix, right) = normal_equations(&rows);
        let found = right[0] / matrix[(0, 0)];
        let expected = (weight * one + other) / (weight + 1.0);
        prop_assert!((found - expected).abs() < 1e-6, "{found} for {expected}");
    }

    #[test]
    fn eigenvectors_take_a_matrix_apart(entries in prop::collection::vec(-1.0..1.0_f64, 5 * 5)) {
        let half = DMatrix::from_row_slice(5, 5, &entries);
        let matrix = &half * half.transpose();
        let (mut values, mut vectors) = (matrix.as_slice().to_vec(), vec![0.0; 25]);
        eigenvectors(&mut values, 5, &mut vectors);
        let vectors = DMatrix::from_row_slice(5, 5, &vectors);
        let values = DMatrix::from_diagonal(&DMatrix::from_row_slice(5, 5, &values).diagonal());
        prop_assert!((vectors.transpose() * values * &vectors - matrix).norm() < 1e-12);
        prop_assert!((&vectors * vectors.transpose() - DMatrix::identity(5, 5)).norm() < 1e-12);
    }
}
