//! The optimum of a hierarchy in double-double arithmetic (106 bits), or none in case of doubt.
//!
//! It shares nothing with the solver, and replaces exact arithmetic where that would take too long.
//! A guess at the optimum decides which active sets are tried first. A level's optimum is accepted
//! if the conditions of Karush, Kuhn and Tucker hold. Every sign in them must be far above or far
//! below rounding.

mod factors;
mod level;
mod row;

use ahqp_core::{Hierarchy, Objective, Rows};
use qd::Quad;

use factors::Basis;
use row::{Kind, Row};

/// Returns the optimum of least norm, of n entries.
///
/// None if rounding could decide, if `guess` is far from the optimum, or if the hard rows
/// contradict each other. Quadratic objectives and weighted rows are not supported, and give none.
pub(crate) fn solve_extended(hierarchy: &Hierarchy, guess: &[f64]) -> Option<Vec<f64>> {
    let n = hierarchy.variables();
    let mut identity = Rows::zeros(n, n);
    for i in 0..n {
        identity.row_mut(i).ok()?[i] = 1.0;
    }
    let norm = one_sided(&identity)?;
    identity.lower_mut().copy_from_slice(hierarchy.lower());
    identity.upper_mut().copy_from_slice(hierarchy.upper());
    let mut state = State {
        x: guess.iter().map(|&x| Quad::from(x)).collect(),
        fixed: Basis::default(),
        hard: one_sided(&identity)?,
    };
    for level in hierarchy.levels() {
        state.hard.extend(one_sided(level.constraints())?);
        let soft = match level.objective() {
            Objective::LeastSquares(rows) if rows.weights().is_none() => one_sided(rows)?,
            Objective::LeastSquares(_) | Objective::Quadratic { .. } => return None,
            _ => Vec::new(),
        };
        state.minimise(soft)?;
    }
    state.minimise(norm)?;
    Some(state.x.iter().map(|x| x.0).collect())
}

/// A point that is optimal for the levels so far, and the conditions that later levels must keep.
struct State {
    x: Vec<Quad>,
    /// Directions in which x is determined.
    fixed: Basis,
    hard: Vec<Row>,
}

fn one_sided(rows: &Rows) -> Option<Vec<Row>> {
    let mut all = Vec::new();
    for (row, lower, upper) in rows.iter() {
        if lower == upper {
            all.push(Row::new(row, upper, 1.0, Kind::Equality)?);
            continue;
        }
        if upper.is_finite() {
            all.push(Row::new(row, upper, 1.0, Kind::Inequality)?);
        }
        if lower.is_finite() {
            all.push(Row::new(row, lower, -1.0, Kind::Inequality)?);
        }
    }
    Some(all)
}
