//! Rounding of rows: of their terms, of their coefficients at free variables, and of their bounds.

use std::borrow::Borrow;

use super::{Coefficients, ProblemData};
use crate::solver::activity::Activity;
use crate::solver::tolerances::{NO_TERMS, ROUNDING, SCALE_DISPARITY};

impl ProblemData {
    /// Returns true if forces of these rows, of one objective, differ so much that the rounding of
    /// one may hide another.
    pub(crate) fn have_scale_disparity<Id: Borrow<usize>>(
        &self,
        rows: impl IntoIterator<Item = Id>,
        x_norm: f64,
    ) -> bool {
        let (mut least, mut most) = (f64::INFINITY, 0.0_f64);
        for id in rows {
            let (id, norm) = (*id.borrow(), self.norms[*id.borrow()]);
            if norm > 0.0 {
                least = least.min(norm * norm * x_norm);
                most = most.max(norm * self.magnitude(id, x_norm));
            }
        }
        most > SCALE_DISPARITY * least
    }

    /// Returns the largest size of numbers in row `id` at x, which rounding is relative to.
    pub(crate) fn magnitude(&self, id: usize, x_norm: f64) -> f64 {
        let norm = self.norms[id];
        self.nearer_bound(id) + if norm > 0.0 { norm * x_norm } else { NO_TERMS }
    }

    /// Returns the rounding in a x − bound of row `id`, given ‖x‖.
    pub(crate) fn rounding(&self, id: usize, x_norm: f64) -> f64 {
        self.relative_rounding[id] * self.magnitude(id, x_norm) + self.bound_rounding[id]
    }

    /// Returns that rounding if aᵢx was summed up from `x`, and variables at their bounds are
    /// exact.
    pub(crate) fn rounding_beside_bounds(
        &self,
        id: usize,
        x: &[f64],
        x_norm: f64,
        activity: &[Activity],
    ) -> f64 {
        let magnitude = self.nearer_bound(id) + self.norm_beside_bounds(id, activity) * x_norm;
        let of_sum = f64::EPSILON * self.size(id, x);
        self.relative_rounding[id] * magnitude + of_sum + self.bound_rounding[id]
    }

    /// Returns the norm of a row's coefficients at variables that are not at a bound.
    pub(crate) fn norm_beside_bounds(&self, id: usize, activity: &[Activity]) -> f64 {
        match self.row(id).coefficients() {
            Coefficients::Unit(variable) => f64::from(u8::from(!activity[variable].is_active())),
            Coefficients::Dense(row) => {
                let free = row.iter().zip(activity).filter(|(_, state)| !state.is_active());
                free.map(|(a, _)| a * a).sum::<f64>().sqrt()
            }
        }
    }

    /// Returns the rounding in row `id`, relative to the row.
    pub(crate) fn relative_rounding(&self, id: usize) -> f64 {
        self.relative_rounding[id]
    }

    /// Returns the size of the terms of row `id` at x, Σ|aᵢⱼxⱼ| + |bᵢ|. Entries of x with a zero
    /// coefficient do not count, however large.
    pub(crate) fn size(&self, id: usize, x: &[f64]) -> f64 {
        let terms = match self.row(id).coefficients() {
            Coefficients::Unit(variable) => x[variable].abs(),
            Coefficients::Dense(_) if self.norms[id] == 0.0 => NO_TERMS,
            Coefficients::Dense(row) => row.iter().zip(x).map(|(a, x)| (a * x).abs()).sum(),
        };
        self.nearer_bound(id) + terms
    }

    /// Returns the size of the bound nearer to zero. A distant bound counts through x if x is near
    /// it.
    fn nearer_bound(&self, id: usize) -> f64 {
        let nearer = self.lower[id].abs().min(self.upper[id].abs());
        if nearer.is_finite() { nearer } else { 0.0 }
    }

    /// Returns the largest gap between row `id` and its bound that counts as zero: this part of the
    /// row's terms at x, and the rounding of vectors of length `max_norm`, which is ‖x‖ or more.
    pub(crate) fn tolerance(&self, id: usize, x: &[f64], max_norm: f64, part: f64) -> f64 {
        part * self.size(id, x) + ROUNDING * self.norms[id] * max_norm
    }
}
