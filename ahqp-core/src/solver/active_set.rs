//! The problem of one level and the set of rows that are active in it.
//!
//! Minimise the violation of the level's rows, ½‖w‖² with lower ≤ A x − w ≤ upper, plus a
//! linear term, subject to the hard rows in play and inside the directions that higher levels
//! left free. The working set holds hard rows at their bounds; rows of the objective that are
//! violated are pulled towards theirs.

use std::ops::Range;

use crate::linalg::list::List;
use crate::linalg::vector::{add_scaled, norm};
use crate::solver::basis::Basis;
use crate::solver::budget::{Allowance, Budget};
use crate::solver::data::RowTable;
use crate::solver::least_squares::{LeastSquares, Minimum};
use crate::solver::pulled::Pulled;
use crate::solver::search::Candidate;
use crate::solver::settings::Settings;
use crate::solver::tolerances::ROUNDING;

/// Of ‖a‖‖x‖, what a search may leave of a violation that it cannot tell from rounding.
const DOUBTFUL: f64 = 1e-11;

/// What a row of the table does at the moment.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum RowState {
    /// Not in play yet, or not used.
    Absent,
    /// A hard row that may become active, or a row of the objective within its range.
    Inside,
    /// Held at, or pulled towards, its lower bound.
    Lower,
    /// Held at, or pulled towards, its upper bound.
    Upper,
    /// An equality, held or pulled.
    Equal,
    /// Decided by a higher level; its direction is fixed.
    Fixed,
}

impl RowState {
    pub(crate) fn is_active(self) -> bool {
        matches!(self, Self::Lower | Self::Upper | Self::Equal)
    }

    /// Returns true if a row in this state should be let go, given its multiplier and the rounding in
    /// it.
    pub(crate) fn is_wrong(self, multiplier: f64, rounding: f64) -> bool {
        match self {
            Self::Upper => -multiplier > rounding,
            Self::Lower => multiplier > rounding,
            _ => false,
        }
    }
}

/// What a search minimises.
#[derive(Debug, Clone)]
pub(crate) enum Goal {
    /// The violation of these rows, and the linear term of this level if one is named.
    Rows { rows: Range<usize>, linear_of: Option<usize> },
    /// ‖x‖.
    Norm,
}

impl Goal {
    /// Whether row `id` of the table is one whose violation is minimised.
    pub(crate) fn has_row(&self, id: usize) -> bool {
        matches!(self, Self::Rows { rows, .. } if rows.contains(&id))
    }
}

/// How a search ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum End {
    Optimal,
    Unbounded,
    OutOfBudget,
}

#[derive(Debug, Clone)]
pub(crate) struct ActiveSet {
    pub(crate) table: RowTable,
    pub(crate) basis: Basis,
    /// The rows that are pulled, between the begin and the end of a search.
    pub(crate) pulled: Pulled,
    pub(crate) least_squares: LeastSquares,
    pub(crate) x: Vec<f64>,
    pub(crate) state: Vec<RowState>,
    /// Runs of rows among which hard ones are in play: inside, or in the working set.
    pub(crate) in_play: List<Range<usize>>,
    /// aᵢx for the rows in play.
    pub(crate) value: Vec<f64>,
    /// w of rows of the objective that are inside, on its way to zero.
    pub(crate) residual: Vec<f64>,
    /// Multipliers of the working set for the goal, and the rounding in them.
    pub(crate) multipliers: Vec<f64>,
    pub(crate) multiplier_rounding: Vec<f64>,
    /// Residuals of the rows of the goal that are active, and the rounding in them.
    pub(crate) pull: Vec<f64>,
    pub(crate) pull_rounding: Vec<f64>,
    pub(crate) iterations: usize,
    pub(crate) allowance: Allowance,
    /// Rows that may be active at the optimum, and where.
    pub(crate) hint: Vec<RowState>,
    /// The largest ‖x‖ of this solve.
    pub(crate) farthest: f64,
    /// Rows of the working set that the level at hand leaves to the next.
    pub(crate) left: List<(usize, RowState)>,
    /// Of each row of the working set, whether the level at hand does not need it.
    pub(crate) weak: Vec<bool>,
    pub(crate) slope: Vec<f64>,
    pub(crate) candidates: List<Candidate>,
    /// Rows that came back at once when they were let go, since x moved last.
    pub(crate) kept: List<usize>,
    /// Whether any residual of the goal was more than rounding when they were computed last.
    pub(crate) is_pulled: bool,
    /// The size of the forces that balance each other.
    pub(crate) size: f64,
    pub(crate) direction: Vec<f64>,
    pub(crate) gradient: Vec<f64>,
    gradient_rounding: Vec<f64>,
    pub(crate) settings: Settings,
}

impl ActiveSet {
    pub(crate) fn new(table: RowTable, settings: Settings) -> Self {
        let (n, count) = (table.n, table.len());
        let most =
            table.levels.iter().map(|l| (l.objective.len() + 1).max(l.constraints.len())).max();
        Self {
            basis: Basis::new(n),
            pulled: Pulled::new(most.unwrap_or(0), n),
            least_squares: LeastSquares::new(most.unwrap_or(0), n),
            x: vec![0.0; n],
            state: vec![RowState::Absent; count],
            in_play: List::with_capacity(2 * table.levels.len() + 1),
            value: vec![0.0; count],
            residual: vec![0.0; count],
            multipliers: vec![0.0; n],
            multiplier_rounding: vec![0.0; n],
            pull: vec![0.0; count],
            pull_rounding: vec![0.0; count],
            iterations: 0,
            hint: vec![RowState::Inside; count],
            farthest: 0.0,
            left: List::with_capacity(n),
            weak: vec![false; n],
            slope: vec![0.0; count],
            candidates: List::with_capacity(count),
            kept: List::with_capacity(count),
            is_pulled: false,
            size: 0.0,
            direction: vec![0.0; n],
            gradient: vec![0.0; n],
            gradient_rounding: vec![0.0; n],
            table,
            allowance: Allowance::new(Budget::default(), settings.max_iterations),
            settings,
        }
    }

    /// Starts a solve near `start`: x within its bounds, only those in play. Bounds that are
    /// active in the hint are active from the start.
    pub(crate) fn reset(&mut self, start: &[f64]) {
        self.pulled.clear(false);
        self.in_play.clear();
        self.in_play.push(0..self.table.n);
        self.state.fill(RowState::Absent);
        for (i, near) in start.iter().enumerate() {
            let (lower, upper) = (self.table.lower[i], self.table.upper[i]);
            self.x[i] = match self.hint[i] {
                RowState::Lower => lower,
                RowState::Upper => upper,
                _ => near.clamp(lower, upper),
            };
            if lower.is_finite() || upper.is_finite() {
                self.state[i] = RowState::Inside;
                self.value[i] = self.x[i];
            }
        }
        self.farthest = norm(&self.x);
        let is_active = |i: usize| matches!(self.hint[i], RowState::Lower | RowState::Upper);
        self.basis.reset(is_active);
        for &i in self.basis.active() {
            self.state[i] = self.hint[i];
        }
    }

    /// By how much row `id` may be violated and still hold.
    pub(crate) fn tolerance(&self, id: usize) -> f64 {
        // Steps through larger x leave rounding of their size behind.
        let rounding = ROUNDING * self.table.norm(id) * self.farthest;
        self.settings.feasibility_tolerance * self.table.size(id, &self.x) + rounding
    }

    /// Whether row `id` holds.
    pub(crate) fn holds(&self, id: usize) -> bool {
        let tolerance = self.settings.feasibility_tolerance;
        self.table.is_closed(id, self.violation(id), &self.x, self.farthest, tolerance)
    }

    /// By how much row `id` must be violated for a search to have left it so on purpose.
    pub(crate) fn doubt(&self, id: usize) -> f64 {
        self.tolerance(id).max(DOUBTFUL * self.table.norm(id) * self.farthest)
    }

    /// aᵢx − bound: positive above the upper bound, negative below the lower, else zero.
    pub(crate) fn violation(&self, id: usize) -> f64 {
        let value = self.value[id];
        (value - self.table.upper[id]).max(0.0) + (value - self.table.lower[id]).min(0.0)
    }

    /// Puts rows of an objective in play as x finds them.
    pub(crate) fn place_soft(&mut self, rows: Range<usize>) {
        self.table.multiply(rows.clone(), &self.x, &mut self.value);
        for id in rows {
            self.residual[id] = 0.0;
            let violation = self.violation(id);
            self.state[id] = if self.table.is_equality(id) {
                RowState::Equal
            } else if violation > 0.0 {
                RowState::Upper
            } else if violation < 0.0 {
                RowState::Lower
            } else {
                RowState::Inside
            };
        }
    }

    /// Puts hard rows in play that hold at x.
    pub(crate) fn place_hard(&mut self, rows: Range<usize>) {
        self.table.multiply(rows.clone(), &self.x, &mut self.value);
        if !rows.is_empty() {
            self.in_play.push(rows.clone());
        }
        for id in rows {
            self.state[id] = RowState::Inside;
            self.residual[id] = 0.0;
            if self.table.is_equality(id) {
                self.hold(id, RowState::Equal);
            } else if self.is_at_hint(id) {
                self.hold(id, self.hint[id]);
            }
        }
    }

    /// Whether a row stands at the bound at which the hint has it.
    fn is_at_hint(&self, id: usize) -> bool {
        let bound = match self.hint[id] {
            RowState::Lower => self.table.lower[id],
            RowState::Upper => self.table.upper[id],
            _ => return false,
        };
        let (gap, tolerance) = (self.value[id] - bound, self.settings.feasibility_tolerance);
        self.table.is_closed(id, gap, &self.x, self.farthest, tolerance)
    }

    /// Begins to keep the rows of `goal` that are pulled in a factor of their own.
    pub(crate) fn begin_pulling(&mut self, goal: &Goal) {
        match goal {
            Goal::Rows { rows, linear_of: None } => {
                let pulled = rows.clone().filter(|&id| self.state[id].is_active());
                self.pulled.begin(&mut self.basis, &self.table, pulled);
            }
            _ => self.pulled.clear(false),
        }
    }

    /// Pulls a row of the objective that has come to a bound.
    pub(crate) fn pull(&mut self, id: usize, state: RowState) {
        self.state[id] = state;
        self.pulled.pull(&mut self.basis, &self.table, id);
    }

    /// No longer pulls a row of the objective.
    pub(crate) fn let_go(&mut self, id: usize) {
        self.state[id] = RowState::Inside;
        self.pulled.let_go(&mut self.basis, &self.table, id);
    }

    /// Lets go of a row of the working set; its direction is free again.
    pub(crate) fn release(&mut self, position: usize) {
        let id = self.basis.active()[position];
        self.pulled.release(&mut self.basis, &self.table, position);
        self.state[id] = RowState::Inside;
    }

    /// Adds a hard row that is in the way to the working set; false if it depends on the rows
    /// there.
    pub(crate) fn activate(&mut self, id: usize, state: RowState) -> bool {
        self.add(id, state, self.dependence_tolerance())
    }

    /// Adds a hard row that is at its bound to the working set, unless it depends on the rows there.
    pub(crate) fn hold(&mut self, id: usize, state: RowState) {
        self.add(id, state, self.settings.rank_tolerance);
    }

    fn add(&mut self, id: usize, state: RowState, tolerance: f64) -> bool {
        let added = self.pulled.activate(&mut self.basis, &self.table, id, tolerance);
        if added {
            self.state[id] = state;
        }
        added
    }

    /// The working set accepts rows that a rank decision would already refuse, since a row that
    /// stands in the way must be taken; far below, rounding is all there is.
    pub(crate) fn dependence_tolerance(&self) -> f64 {
        self.settings.rank_tolerance * 1e-2
    }

    pub(crate) fn bound(&self, id: usize) -> f64 {
        bound(&self.table, &self.state, id)
    }

    /// The step to the minimum with the working set held, into `direction`.
    pub(crate) fn equality_step(&mut self, goal: &Goal) -> Minimum {
        self.direction.fill(0.0);
        let k = self.basis.free_count();
        let minimum = match goal {
            Goal::Norm => {
                let z = &mut self.gradient[..k];
                self.basis.free_coordinates_of(&self.x, z);
                for value in z.iter_mut() {
                    *value = -*value;
                }
                self.basis.add_free(z, &mut self.direction);
                return Minimum::Point;
            }
            Goal::Rows { rows, linear_of } => {
                let Self { pulled, basis, table, state, value, .. } = self;
                if let Some(step) =
                    pulled.solve(basis, table, |id| bound(table, state, id) - value[id])
                {
                    self.basis.add_free(step, &mut self.direction);
                    return Minimum::Point;
                }
                self.fill_least_squares(rows, *linear_of, k);
                self.least_squares.factorise(self.settings.rank_tolerance);
                self.least_squares.solve(self.settings.rank_tolerance)
            }
        };
        self.basis.add_free(self.least_squares.solution(), &mut self.direction);
        minimum
    }

    fn fill_least_squares(&mut self, rows: &Range<usize>, linear_of: Option<usize>, k: usize) {
        self.least_squares.start(k);
        for id in rows.clone() {
            let row = self.table.row(id);
            if self.state[id].is_active() && row.norm() > 0.0 {
                let target = self.bound(id) - self.value[id];
                let reduce = |out: &mut [f64]| self.basis.free_coordinates(row, out);
                self.least_squares.push(target, row.norm(), reduce);
            }
        }
        if let Some(level) = linear_of {
            let linear = &self.table.levels[level].linear;
            self.least_squares.set_linear(|out| self.basis.free_coordinates_of(linear, out));
        }
    }

    /// Multipliers of the working set for the goal at x, at the minimum with the working set held.
    /// Returns false if there is no gradient but rounding.
    pub(crate) fn refresh_multipliers(&mut self, goal: &Goal) -> bool {
        self.is_pulled = match goal {
            Goal::Norm => {
                self.gradient.copy_from_slice(&self.x);
                self.size = norm(&self.x);
                true
            }
            Goal::Rows { rows, linear_of } => self.set_gradient(rows.clone(), *linear_of),
        };
        if self.is_pulled {
            self.basis.multipliers(&self.gradient, &mut self.multipliers);
            let forces = self.multipliers.iter().zip(self.basis.active());
            self.size += forces.map(|(m, &id)| m.abs() * self.table.norm(id)).sum::<f64>();
        }
        self.is_pulled
    }

    /// The rounding in the multipliers just computed.
    pub(crate) fn set_multiplier_rounding(&mut self, goal: &Goal) {
        match goal {
            Goal::Norm => {
                let rounding = self.settings.optimality_tolerance * norm(&self.x);
                self.gradient_rounding.fill(rounding);
            }
            Goal::Rows { rows, linear_of } => {
                self.set_gradient_rounding(rows.clone(), *linear_of);
            }
        }
        let Self { basis, table, gradient, gradient_rounding, multipliers, .. } = self;
        let (norm, rounding) = (|id| table.norm(id), &mut self.multiplier_rounding);
        basis.multiplier_rounding(gradient, gradient_rounding, multipliers, norm, rounding);
        // Where rows nearly depend on each other, these bounds grow far beyond the real rounding.
        let most = self.settings.optimality_tolerance * self.size;
        for (rounding, &id) in rounding.iter_mut().zip(basis.active()) {
            *rounding = rounding.min(most / table.norm(id));
        }
    }

    /// The gradient of the rows of the goal. Returns false if all residuals are rounding.
    fn set_gradient(&mut self, rows: Range<usize>, linear_of: Option<usize>) -> bool {
        let x_norm = norm(&self.x);
        for id in rows.clone() {
            (self.pull[id], self.pull_rounding[id]) = (0.0, 0.0);
            if self.state[id].is_active() {
                self.pull[id] = self.value[id] - self.bound(id);
                self.pull_rounding[id] = self.table.rounding(id, x_norm);
            }
        }
        if linear_of.is_none() && self.pulled.is_sound() {
            self.pulled.balance(&self.table, &mut self.pull, &mut self.pull_rounding);
        }
        let is_there = |id: usize| self.pull[id].abs() > self.pull_rounding[id];
        if linear_of.is_none() && !rows.clone().any(is_there) {
            return false;
        }
        self.size = rows.clone().map(|id| self.pull[id].abs() * self.table.norm(id)).sum();
        self.gradient.fill(0.0);
        self.table.add_rows(rows.clone(), &self.pull[rows], &mut self.gradient);
        if let Some(level) = linear_of {
            let linear = &self.table.levels[level].linear;
            add_scaled(&mut self.gradient, 1.0, linear);
            self.size += norm(linear);
        }
        true
    }

    /// The rounding in each entry of the gradient: that of its own sum.
    fn set_gradient_rounding(&mut self, rows: Range<usize>, linear_of: Option<usize>) {
        self.gradient_rounding.fill(0.0);
        for id in rows {
            let weight = self.pull_rounding[id] + ROUNDING * self.pull[id].abs();
            if weight > 0.0 {
                let row = self.table.coefficients(id);
                for (rounding, entry) in self.gradient_rounding.iter_mut().zip(row) {
                    *rounding += weight * entry.abs();
                }
            }
        }
        if let Some(level) = linear_of {
            let linear = &self.table.levels[level].linear;
            for (rounding, entry) in self.gradient_rounding.iter_mut().zip(linear) {
                *rounding += ROUNDING * entry.abs();
            }
        }
    }
}

/// The bound that an active row is at, or is pulled towards.
pub(crate) fn bound(table: &RowTable, state: &[RowState], id: usize) -> f64 {
    match state[id] {
        RowState::Lower => table.lower[id],
        _ => table.upper[id],
    }
}
