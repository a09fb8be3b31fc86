//! The optimum of a hierarchy in double-double arithmetic (106 bits), or nothing where a doubt is left.
//!
//! Shares nothing with the solver, and stands in for exact arithmetic where that would take too long: a
//! guess at the optimum says which active sets to try first, and a level's optimum is accepted when the
//! conditions of Karush, Kuhn and Tucker hold, every sign in them far above rounding or far below it.

mod factors;
mod level;
mod row;

use ahqp_core::{Hierarchy, Objective, Rows};
use qd::Quad;

use factors::Basis;
use row::{Kind, Row};

/// The optimum of least norm, of n entries; none where rounding could decide, where `guess` is far from
/// the optimum, where the hard rows contradict each other, for quadratic objectives and for rows with
/// weights of their own.
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

/// A point that is optimal for the levels so far, and what the next ones must keep.
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
