//! Whether a point is the lexicographic optimum, seen from its active set alone.
//!
//! A level's Lagrangian has the gradient Aᵀr of its residuals r, balanced by multipliers of all
//! rows above it: hard rows, rows of higher objectives (held, of either sign) and bounds. x is
//! optimal when every row that is not active holds and, for every active inequality, the first
//! level at which its multiplier differs from zero gives it the right sign (Dimitrov, Sherikov,
//! Wieber; Escande, Mansard, Wieber, IJRR 33, 2014).

mod multipliers;
mod signs;

use crate::linalg::list::List;
use crate::linalg::vector::norm;
use crate::solver::active_set::{RowState, bound};
use crate::solver::data::RowTable;
use crate::solver::factorisation::{Factorisation, Purpose};
use crate::solver::settings::Settings;
use signs::Signs;

/// Up to one change in so many variables, a factorisation is updated and not made anew.
const UPDATED: usize = 8;

/// An active set that needs more changes at once than this part of the variables is far away.
const FAR: usize = 6;

/// An active set of the whole hierarchy, its factorisation, and the check; sized once.
#[derive(Debug, Clone)]
pub(crate) struct Verifier {
    pub(crate) factorisation: Factorisation,
    /// Of every row of the table: inside, or active at a bound.
    pub(crate) activity: Vec<RowState>,
    /// aᵢx.
    value: Vec<f64>,
    signs: Signs,
    /// aᵢx at the point reached, which violates no row that is not active.
    reached: Vec<f64>,
    /// Rows that are violated, and how.
    violated: List<(usize, RowState)>,
    /// Whether the active set was asked and turned out far from the right one.
    pub(crate) far: bool,
    /// How many rounds the last solve took.
    pub(crate) rounds: usize,
    multipliers: Vec<f64>,
    multiplier_rounding: Vec<f64>,
    /// Weights of the rows of the table in a sum.
    weights: Vec<f64>,
    /// Residuals of the rows of a level, in the order of the stack, and the rounding in them.
    residual: Vec<f64>,
    residual_rounding: Vec<f64>,
    /// The size of the forces of the level at hand, and the rounding in each of its sums.
    size: f64,
    rounding: f64,
    /// Entries of a level's gradient: those of the variables at a bound, the rest is not needed.
    gradient: Vec<f64>,
    pub(crate) settings: Settings,
}

impl Verifier {
    pub(crate) fn new(table: &RowTable, settings: Settings) -> Self {
        Self {
            factorisation: Factorisation::new(table),
            activity: vec![RowState::Inside; table.len()],
            value: vec![0.0; table.len()],
            signs: Signs::new(table.len()),
            reached: vec![0.0; table.len()],
            violated: List::with_capacity(table.len()),
            far: false,
            rounds: 0,
            multipliers: vec![0.0; table.n],
            multiplier_rounding: vec![0.0; table.n],
            weights: vec![0.0; table.len()],
            residual: vec![0.0; table.len()],
            residual_rounding: vec![0.0; table.len()],
            size: 0.0,
            rounding: 0.0,
            gradient: vec![0.0; table.n],
            settings,
        }
    }

    /// Solves from the present active set, which fits the data, mending it for up to `rounds`
    /// rounds; whether it came to an end.
    pub(crate) fn solve(&mut self, table: &RowTable, rounds: usize) -> bool {
        self.far = true;
        self.rounds = 0;
        while self.rounds < rounds {
            self.rounds += 1;
            let first = self.rounds == 1;
            if !self.follow(table, first) {
                return false;
            }
            let Some(changes) = self.repair(table, first) else { return false };
            if changes == 0 {
                return true;
            }
            if first {
                self.far = changes > table.n / FAR + 1;
            }
            if self.far {
                return false;
            }
        }
        false
    }

    /// Brings the factorisation to the present active set; false if that gives no point.
    fn follow(&mut self, table: &RowTable, anew: bool) -> bool {
        let tolerance = self.settings.rank_tolerance;
        let few = !anew && self.signs.changed.len() <= table.n / UPDATED;
        let (factorisation, activity) = (&mut self.factorisation, &self.activity);
        let updated = few && factorisation.update(table, activity, &self.signs.changed, tolerance);
        updated || factorisation.factorise(table, activity, tolerance)
    }

    /// Makes the active set fit the data: equalities are active, sides without a bound are not.
    #[expect(clippy::needless_bitwise_bool, reason = "no branches")]
    pub(crate) fn fit(&mut self, table: &RowTable) {
        let bounds = table.lower.iter().zip(&table.upper);
        for (state, (&lower, &upper)) in self.activity.iter_mut().zip(bounds) {
            let fits = (*state == RowState::Lower) & (lower > f64::NEG_INFINITY)
                | (*state == RowState::Upper) & (upper < f64::INFINITY);
            let otherwise = if fits { *state } else { RowState::Inside };
            *state = if lower == upper { RowState::Equal } else { otherwise };
        }
    }

    /// Checks the point that the active set gives, and mends the set where it is wrong: how many
    /// rows came or went, or none where that cannot help.
    ///
    /// As in a primal active-set method, the way from point to point ends where it meets a row
    /// that is not active, and a row goes only where nothing was in the way. The first point is
    /// taken as it is: what it violates becomes active, and is approached from there.
    fn repair(&mut self, table: &RowTable, first: bool) -> Option<usize> {
        let x_norm = norm(&self.factorisation.x);
        if !x_norm.is_finite() {
            return None;
        }
        self.signs.begin(&self.activity);
        self.find_violated(table, x_norm)?;
        let blocked = !first && self.stop_at_first(table);
        for &(id, state) in &self.violated {
            self.activity[id] = state;
            self.signs.changed.push(id);
        }
        if !blocked {
            self.reached.copy_from_slice(&self.value);
            self.check_signs(table, x_norm);
        }
        Some(self.signs.changed.len())
    }

    /// Lets go of rows with a multiplier of the wrong sign, at the first level that has any: signs
    /// below a level that is not at its optimum mean nothing.
    fn check_signs(&mut self, table: &RowTable, x_norm: f64) {
        for group in 0..self.factorisation.groups.len() {
            if self.signs.unsettled == 0 {
                return;
            }
            if self.factorisation.groups[group].purpose == Purpose::Minimised {
                self.check_level(table, group, x_norm);
                if self.signs.release(&mut self.activity) > 0 {
                    return;
                }
            }
        }
        self.check_least_norm(table);
        self.signs.release(&mut self.activity);
    }

    /// Whether a gap between a row and its bound is none.
    fn is_closed(&self, table: &RowTable, id: usize, gap: f64, x_norm: f64) -> bool {
        let tolerance = self.settings.feasibility_tolerance;
        table.is_closed(id, gap, &self.factorisation.x, x_norm, tolerance)
    }

    /// Finds the rows that are violated; none if a row that should hold does not.
    fn find_violated(&mut self, table: &RowTable, x_norm: f64) -> Option<()> {
        let n = table.n;
        self.violated.clear();
        self.value[..n].copy_from_slice(&self.factorisation.x);
        table.multiply(n..table.len(), &self.factorisation.x, &mut self.value);
        if self.factorisation.bounds_in_stack().any(|id| self.is_missed(table, id, x_norm)) {
            return None;
        }
        for level in &table.levels {
            let mut constraints = level.constraints.clone();
            if constraints.any(|id| self.is_missed(table, id, x_norm)) {
                return None;
            }
        }
        let bounds = table.lower.iter().zip(&table.upper);
        for (id, (&value, (&lower, &upper))) in self.value.iter().zip(bounds).enumerate() {
            let outside = value > upper || value < lower;
            if outside && self.activity[id] == RowState::Inside {
                let (gap, state) = if value > upper {
                    (value - upper, RowState::Upper)
                } else {
                    (lower - value, RowState::Lower)
                };
                if !self.is_closed(table, id, gap, x_norm) {
                    self.violated.push((id, state));
                }
            }
        }
        Some(())
    }

    /// Goes from the point reached last towards the present one, up to the first of the violated
    /// rows, which is the only one kept. False if there is none: the present point is reached.
    fn stop_at_first(&mut self, table: &RowTable) -> bool {
        let length = |&(id, state): &(usize, RowState)| {
            let (from, to) = (self.reached[id], self.value[id]);
            let bound = if state == RowState::Upper { table.upper[id] } else { table.lower[id] };
            ((bound - from) / (to - from)).max(0.0)
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

    /// Whether a row is active, but x is not at its bound.
    fn is_missed(&self, table: &RowTable, id: usize, x_norm: f64) -> bool {
        let gap = || self.value[id] - bound(table, &self.activity, id);
        self.activity[id].is_active() && !self.is_closed(table, id, gap(), x_norm)
    }
}
