//! Multipliers for a certificate: from the factorisation where they are unique, otherwise by least
//! squares with sign constraints.

use nalgebra::{DMatrix, DVector};

use super::tolerances::{AT_BOUND, DEPENDENT_ROWS, IMBALANCE, LARGE, NO_MULTIPLIER, TELLING};
use crate::error::Error;
use crate::linalg::vector::{add_scaled, norm};
use crate::problem::hierarchy::Hierarchy;
use crate::problem::level::Level;
use crate::problem::rows::Rows;
use crate::solver::Solver;
use crate::solver::active_set::ActiveSet;
use crate::solver::activity::Activity;
use crate::solver::settings::Settings;

/// Multipliers of a level: pairs of a row of the table and its multiplier.
type Multipliers = Vec<(usize, f64)>;

/// Sizes of the terms of a level's gradient, of these together with the multipliers, and of the
/// part of the gradient that the multipliers leave.
struct Balance {
    gradient: f64,
    size: f64,
    rest: f64,
}

/// Computes multipliers level by level, and remembers which inequalities may have either sign from
/// there on.
pub(crate) struct Proof<'a> {
    set: &'a mut ActiveSet,
    x: &'a [f64],
    settled: Vec<bool>,
}

impl<'a> Proof<'a> {
    /// Starts at `x`, with the verifier's factorisation of the active set there.
    pub(crate) fn new(set: &'a mut ActiveSet, x: &'a [f64]) -> Self {
        let settled = (0..set.data.len()).map(|id| set.data.is_equality(id)).collect();
        Self { set, x, settled }
    }

    /// Returns the multipliers of every level, and of the least norm after the last level.
    pub(crate) fn levels(mut self) -> Result<Vec<Multipliers>, Error> {
        let count = self.set.data.levels.len();
        (0..count).map(Some).chain([None]).map(|level| self.level(level)).collect()
    }

    fn level(&mut self, level: Option<usize>) -> Result<Multipliers, Error> {
        if let Some(level) = level {
            for id in self.set.data.levels[level].used_objective() {
                self.settled[id] |= !self.is_closed(id, self.violation(id).0);
            }
        }
        // If active rows depend on each other, another choice than the factorisation's may have the
        // right signs or be smaller. If they nearly depend on each other, the right choice may be
        // missing.
        let mut multipliers = self.set.multipliers_of(level, self.x);
        let mut size = self.balance(level, &multipliers).size;
        if !self.is_sound(level, &multipliers, LARGE) {
            for tolerance in DEPENDENT_ROWS {
                let other = self.signed(level, tolerance)?;
                let other_size = self.balance(level, &other).size;
                let [is_sound, other_is_sound] =
                    [&multipliers, &other].map(|m| self.is_sound(level, m, f64::INFINITY));
                if !is_sound || (other_is_sound && other_size < size) {
                    (multipliers, size) = (other, other_size);
                }
                if is_sound || other_is_sound {
                    break;
                }
            }
        }
        for &(id, multiplier) in &multipliers {
            let counts = (multiplier * self.set.data.norm(id)).abs() > TELLING * size;
            self.settled[id] |= counts && self.may_push(id, multiplier);
        }
        Ok(multipliers)
    }

    /// Returns true if an inequality without an earlier nonzero multiplier may have a multiplier of
    /// this sign.
    fn may_push(&self, id: usize, multiplier: f64) -> bool {
        let state = self.set.activity[id];
        self.settled[id] || !state.has_wrong_sign(multiplier, 0.0)
    }

    /// Returns true if the multipliers have the right signs, balance their level, and are no larger
    /// than `largest` times its gradient.
    fn is_sound(&self, level: Option<usize>, multipliers: &Multipliers, largest: f64) -> bool {
        let Balance { gradient, size, rest } = self.balance(level, multipliers);
        multipliers.iter().all(|&(id, multiplier)| self.may_push(id, multiplier))
            && rest <= IMBALANCE * size
            && size <= largest * gradient
    }

    fn balance(&self, level: Option<usize>, multipliers: &Multipliers) -> Balance {
        let mut rest = self.gradient(level);
        let mut gradient = norm(&rest);
        let objective = level.map_or(0..0, |level| self.set.data.levels[level].used_objective());
        for id in objective {
            let (violation, magnitude) = self.violation(id);
            gradient += self.set.data.norm(id) * (violation.abs() + magnitude);
        }
        let mut size = gradient;
        for &(id, multiplier) in multipliers {
            let row = self.set.data.row(id);
            row.add_to(&mut rest, multiplier);
            size += (multiplier * row.norm()).abs();
        }
        Balance { gradient, size, rest: norm(&rest) }
    }

    fn violation(&self, id: usize) -> (f64, f64) {
        let value = self.set.data.row(id).dot(self.x);
        let violation =
            (value - self.set.data.upper[id]).max(0.0) + (value - self.set.data.lower[id]).min(0.0);
        (violation, self.set.data.magnitude(id, norm(self.x)))
    }

    fn is_closed(&self, id: usize, gap: f64) -> bool {
        gap.abs() <= self.set.data.tolerance(id, self.x, norm(self.x), AT_BOUND)
    }

    /// Solves min ‖gradient + Σ λᵢ aᵢ‖ over the rows at their bounds, as a hierarchy of one level.
    /// Each λᵢ has the sign that its row may have.
    fn signed(&self, level: Option<usize>, rank_tolerance: f64) -> Result<Multipliers, Error> {
        let mut gradient = self.gradient(level);
        let scale = norm(&gradient).max(f64::MIN_POSITIVE);
        for entry in &mut gradient {
            *entry /= -scale;
        }
        let candidates = self.candidates(level);
        if candidates.is_empty() {
            return Ok(Vec::new());
        }
        let mut columns = DMatrix::zeros(self.set.data.n, candidates.len());
        let mut problem = Hierarchy::new(candidates.len())?;
        let (lower, upper) = problem.bounds_mut();
        for (index, &(id, state)) in candidates.iter().enumerate() {
            let row = self.set.data.row(id);
            let mut column = vec![0.0; self.set.data.n];
            row.add_to(&mut column, 1.0 / row.norm());
            columns.column_mut(index).copy_from_slice(&column);
            match state {
                Activity::Upper => lower[index] = 0.0,
                Activity::Lower => upper[index] = 0.0,
                _ => {}
            }
        }
        let target = DVector::from_vec(gradient);
        problem.push(Level::least_squares(Rows::equalities(&columns, &target)?))?;
        let settings = Settings { rank_tolerance, ..Settings::default() };
        let mut solver = Solver::new(&problem, settings)?;
        let found = solver.solve(&problem)?.best();
        let multipliers =
            candidates.iter().zip(found).filter(|(_, value)| value.abs() > NO_MULTIPLIER);
        Ok(multipliers
            .map(|(&(id, _), value)| (id, value * scale / self.set.data.norm(id)))
            .collect())
    }

    fn gradient(&self, level: Option<usize>) -> Vec<f64> {
        let Some(level) = level else { return self.x.to_vec() };
        let mut gradient = vec![0.0; self.set.data.n];
        let rows = &self.set.data.levels[level];
        for id in rows.used_objective() {
            self.set.data.row(id).add_to(&mut gradient, self.violation(id).0);
        }
        if rows.has_linear {
            add_scaled(&mut gradient, 1.0, &rows.linear);
        }
        gradient
    }

    /// Returns the rows that may have multipliers at a level, with the bound at which they may.
    fn candidates(&self, level: Option<usize>) -> Vec<(usize, Activity)> {
        let last = level.unwrap_or(self.set.data.levels.len().saturating_sub(1));
        let mut ids: Vec<usize> = (0..self.set.data.n).collect();
        for (index, rows) in self.set.data.levels.iter().enumerate().take(last + 1) {
            ids.extend(rows.constraints.clone());
            if level.is_none_or(|level| index < level) {
                ids.extend(rows.used_objective());
            }
        }
        let side = |id: usize| {
            let value = self.set.data.row(id).dot(self.x);
            if self.settled[id] {
                Some(Activity::Equal)
            } else if self.is_closed(id, value - self.set.data.upper[id]) {
                Some(Activity::Upper)
            } else if self.is_closed(id, value - self.set.data.lower[id]) {
                Some(Activity::Lower)
            } else {
                None
            }
        };
        ids.into_iter()
            .filter(|&id| self.set.data.norm(id) > 0.0)
            .filter_map(|id| side(id).map(|state| (id, state)))
            .collect()
    }
}
