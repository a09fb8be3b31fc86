//! Repair of a predicted active set.
//!
//! The gradient Aᵀr of a level's Lagrangian comes from its residuals r. The multipliers of all rows
//! above balance it: hard rows, rows of higher objectives (held, of either sign) and bounds.
//!
//! x is optimal under two conditions. Every inactive row holds. Every active inequality has the
//! right sign at the first level at which its multiplier is not zero (Dimitrov, Sherikov, Wieber;
//! Escande, Mansard, Wieber, IJRR 33, 2014).
//!
//! A repair computes x of the active set. It makes violated rows active and rows with a wrong sign
//! inactive, until none is left or progress ends.

use super::{ActiveSet, Residuals};
use crate::linalg::vector::norm;
use crate::solver::activity::Activity;
use crate::solver::data::active_bound;
use crate::solver::factorisation::Purpose;
use crate::solver::tolerances::{FAR, UPDATED};

impl ActiveSet {
    /// Repairs the current active set, which fits the data, in up to `rounds` rounds. Returns true
    /// if x is then the optimum, and false if the repair does not converge.
    pub(crate) fn repair(&mut self, rounds: usize) -> bool {
        let mut last = None;
        for round in 0..rounds {
            self.iterations += 1;
            let first = round == 0;
            if !self.set_point(first) {
                return false;
            }
            match self.correct(first) {
                Some(0) if self.is_rank_in_doubt() => return false,
                Some(0) => {
                    self.x.copy_from_slice(&self.factorisation.x);
                    return true;
                }
                Some(changes) if !first || changes <= self.data.n / FAR + 1 => {
                    let only = self.signs.changed.first().copied().filter(|_| changes == 1);
                    // A single row that changes back and forth by rounding is a cycle.
                    if only.is_some() && only == last {
                        return false;
                    }
                    last = only;
                }
                _ => return false,
            }
        }
        false
    }

    /// Computes the point of the current active set. Returns false if there is none.
    fn set_point(&mut self, anew: bool) -> bool {
        let few = !anew && self.signs.changed.len() <= self.data.n / UPDATED;
        let Self { factorisation, data, activity, signs, .. } = self;
        let has_point = if few && factorisation.update(data, activity, &signs.changed) {
            factorisation.set_point(data)
        } else {
            factorisation.factorise(data, activity)
        };
        factorisation.set_bounds(data, activity);
        has_point
    }

    /// Checks the point of the active set, and corrects the set where it is wrong. Returns the
    /// number of changed rows. None if changes cannot help.
    ///
    /// As in a primal active-set method, the way from point to point ends at the first inactive row
    /// that it meets. A row is dropped only if nothing blocked the way. The first point is taken as
    /// it is. Rows that it violates become active, and are approached from there.
    fn correct(&mut self, first: bool) -> Option<usize> {
        let x_norm = norm(&self.factorisation.x);
        if !x_norm.is_finite() {
            return None;
        }
        self.signs.begin(&self.activity);
        self.multipliers.has_multipliers_near_threshold = false;
        self.find_violated(x_norm)?;
        let blocked = !first && self.stop_at_first();
        for &(id, bound) in &self.violated {
            self.activity[id] = bound;
            self.signs.changed.push(id);
        }
        if !blocked {
            self.check_signs();
            if !self.signs.changed.is_empty() {
                self.reached.copy_from_slice(&self.value);
            }
        }
        Some(self.signs.changed.len())
    }

    /// Makes the row inactive whose multiplier is most wrong, at the first level that has a wrong
    /// one. Below a level that is not optimal, signs mean nothing.
    fn check_signs(&mut self) {
        for group in 0..self.factorisation.groups.len() {
            if self.signs.unsettled == 0 {
                return;
            }
            if self.factorisation.groups[group].purpose == Purpose::Minimised {
                let Self { data, factorisation, multipliers, value, activity, .. } = self;
                let of = (group, Residuals::Balanced);
                if multipliers.balance_level(data, factorisation, value, activity, of) {
                    self.check_signs_of_level();
                }
                if self.signs.release(&mut self.activity) {
                    return;
                }
            }
        }
        if self.signs.unsettled == 0 {
            return;
        }
        let Self { data, factorisation, multipliers, .. } = self;
        let x = std::mem::take(&mut factorisation.x);
        multipliers.balance_norm(data, factorisation, &x);
        factorisation.x = x;
        self.check_signs_of_level();
        self.signs.release(&mut self.activity);
    }

    /// Checks the signs of the multipliers that were just computed.
    fn check_signs_of_level(&mut self) {
        let Self { data, factorisation, multipliers, signs, activity, .. } = self;
        for (id, residual, rounding) in multipliers.residuals(factorisation) {
            signs.check(id, activity[id], residual, rounding, data.norm(id));
        }
        // The rounding of multipliers is computed only if some of them are small.
        let clear = multipliers.clear_force(data, factorisation);
        let is_clear = |(id, multiplier): (usize, f64)| {
            !signs.is_open(id) || multiplier.abs() * data.norm(id) > clear
        };
        if multipliers.pairs(factorisation).all(is_clear) {
            for (id, multiplier) in multipliers.pairs(factorisation) {
                signs.check(id, activity[id], multiplier, 0.0, data.norm(id));
            }
            return;
        }
        multipliers.set_rounding(data, factorisation);
        for (id, multiplier, rounding) in multipliers.with_rounding(factorisation) {
            signs.check(id, activity[id], multiplier, rounding, data.norm(id));
        }
    }

    /// Finds the violated rows. None if an active row is not at its bound.
    fn find_violated(&mut self, x_norm: f64) -> Option<()> {
        let n = self.data.n;
        self.violated.clear();
        self.value[..n].copy_from_slice(&self.factorisation.x);
        self.data.multiply_all(&self.factorisation.x, &mut self.value);
        let bounds = self.factorisation.bounds_in_stack();
        let constraints = self.data.levels.iter().flat_map(|level| level.constraints.clone());
        if bounds.chain(constraints).any(|id| self.is_missed(id, x_norm)) {
            return None;
        }
        let bounds = self.data.lower.iter().zip(&self.data.upper);
        for (id, (&value, (&lower, &upper))) in self.value.iter().zip(bounds).enumerate() {
            let outside = value > upper || value < lower;
            if outside && self.activity[id] == Activity::Inactive {
                let (gap, bound) = if value > upper {
                    (value - upper, Activity::Upper)
                } else {
                    (lower - value, Activity::Lower)
                };
                if !self.is_closed_at_point(id, gap, x_norm) {
                    self.violated.push((id, bound));
                }
            }
        }
        Some(())
    }

    /// Goes from the last point towards the current one, up to the first violated row, which alone
    /// is kept. Returns false if no row is violated, so that the current point is reached.
    fn stop_at_first(&mut self) -> bool {
        let length = |&(id, bound): &(usize, Activity)| {
            let (from, to) = (self.reached[id], self.value[id]);
            let bounds = if bound == Activity::Upper { &self.data.upper } else { &self.data.lower };
            ((bounds[id] - from) / (to - from)).max(0.0)
        };
        let lengths = self.violated.iter().map(|row| (length(row), *row));
        let Some((length, row)) = lengths.min_by(|a, b| a.0.total_cmp(&b.0)) else { return false };
        for (from, to) in self.reached.iter_mut().zip(&self.value) {
            *from += length * (to - *from);
        }
        self.violated.clear();
        self.violated.push(row);
        true
    }

    /// Returns true if row `id` is active, but x is not at its bound.
    fn is_missed(&self, id: usize, x_norm: f64) -> bool {
        let gap = || self.value[id] - active_bound(&self.data, &self.activity, id);
        self.activity[id].is_active() && !self.is_closed_at_point(id, gap(), x_norm)
    }

    /// Returns true if a gap between a row and its bound counts as zero at the factorisation's
    /// point.
    fn is_closed_at_point(&self, id: usize, gap: f64, x_norm: f64) -> bool {
        let (x, part) = (&self.factorisation.x, self.settings.feasibility_tolerance);
        gap == 0.0 || gap.abs() <= self.data.tolerance(id, x, x_norm, part)
    }
}
