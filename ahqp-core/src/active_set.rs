//! The active-set search of one level.
//!
//! Minimise the violation of the level's rows, ½‖w‖² with lower ≤ A x − w ≤ upper, plus a
//! linear term, subject to the hard rows in play and inside the directions that higher levels
//! left free. A primal method: the working set holds hard rows at their bounds, violated rows
//! of the objective are pulled towards theirs, and each iteration either moves to the minimum
//! of the resulting equality problem, stops at the first row in the way, or lets go of a row
//! whose multiplier has the wrong sign (Nocedal & Wright, Numerical Optimization, algorithm
//! 16.3, with w as variables that are never formed).

use std::ops::Range;

use crate::basis::Basis;
use crate::least_squares::{LeastSquares, Minimum};
use crate::settings::Settings;
use crate::table::RowTable;
use crate::vector::{add_scaled, norm};

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
    fn is_active(self) -> bool {
        matches!(self, Self::Lower | Self::Upper | Self::Equal)
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
    fn has_row(&self, id: usize) -> bool {
        matches!(self, Self::Rows { rows, .. } if rows.contains(&id))
    }
}

/// How a search ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum End {
    Optimal,
    Unbounded,
    OutOfIterations,
}

/// A row of the working set, or of the objective, that should be let go.
#[derive(Debug, Clone, Copy)]
enum Release {
    Hard(usize),
    Soft(usize),
}

#[derive(Debug, Clone)]
pub(crate) struct ActiveSet {
    pub(crate) table: RowTable,
    pub(crate) basis: Basis,
    pub(crate) least_squares: LeastSquares,
    pub(crate) x: Vec<f64>,
    pub(crate) state: Vec<RowState>,
    /// Hard rows in play that are not fixed.
    pub(crate) hard: Vec<usize>,
    /// aᵢx for the rows in play.
    pub(crate) value: Vec<f64>,
    /// w of rows of the objective that are inside, on its way to zero.
    residual: Vec<f64>,
    pub(crate) multipliers: Vec<f64>,
    pub(crate) iterations: usize,
    slope: Vec<f64>,
    direction: Vec<f64>,
    gradient: Vec<f64>,
    saved: Vec<f64>,
    kept: Vec<(usize, RowState)>,
    settings: Settings,
}

impl ActiveSet {
    pub(crate) fn new(table: RowTable, settings: Settings) -> Self {
        let (n, count) = (table.n, table.len());
        let most =
            table.levels.iter().map(|l| (l.objective.len() + 1).max(l.constraints.len())).max();
        Self {
            basis: Basis::new(n),
            least_squares: LeastSquares::new(most.unwrap_or(0), n),
            x: vec![0.0; n],
            state: vec![RowState::Absent; count],
            hard: Vec::with_capacity(count),
            value: vec![0.0; count],
            residual: vec![0.0; count],
            multipliers: vec![0.0; n],
            iterations: 0,
            slope: vec![0.0; count],
            direction: vec![0.0; n],
            gradient: vec![0.0; n],
            saved: vec![0.0; n],
            kept: Vec::with_capacity(n),
            table,
            settings,
        }
    }

    /// Starts a solve: x within its bounds, only those in play.
    pub(crate) fn reset(&mut self) {
        self.basis.reset();
        self.hard.clear();
        self.state.fill(RowState::Absent);
        self.iterations = 0;
        for i in 0..self.table.n {
            let (lower, upper) = (self.table.lower[i], self.table.upper[i]);
            self.x[i] = 0.0_f64.clamp(lower, upper);
            if lower.is_finite() || upper.is_finite() {
                self.hard.push(i);
                self.state[i] = RowState::Inside;
                self.value[i] = self.x[i];
            }
        }
    }

    /// By how much row `id` may be violated and still hold.
    pub(crate) fn tolerance(&self, id: usize, x_norm: f64) -> f64 {
        self.settings.feasibility_tolerance * self.table.magnitude(id, x_norm)
    }

    /// aᵢx − bound: positive above the upper bound, negative below the lower, else zero.
    pub(crate) fn violation(&self, id: usize) -> f64 {
        let value = self.value[id];
        (value - self.table.upper[id]).max(0.0) + (value - self.table.lower[id]).min(0.0)
    }

    /// Puts rows of an objective in play as x finds them.
    pub(crate) fn place_soft(&mut self, rows: Range<usize>) {
        for id in rows {
            self.value[id] = self.table.row(id).dot(&self.x);
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
        for id in rows {
            self.value[id] = self.table.row(id).dot(&self.x);
            self.state[id] = RowState::Inside;
            self.hard.push(id);
            if self.table.is_equality(id) {
                self.activate(id, RowState::Equal);
            }
        }
    }

    /// Adds a hard row to the working set; false if it depends on the rows there.
    pub(crate) fn activate(&mut self, id: usize, state: RowState) -> bool {
        let added = self.basis.push_active(id, self.table.row(id), self.dependence_tolerance());
        if added {
            self.state[id] = state;
        }
        added
    }

    /// The working set accepts rows that a rank decision would already refuse, since a row that
    /// stands in the way must be taken; far below, rounding is all there is.
    fn dependence_tolerance(&self) -> f64 {
        self.settings.rank_tolerance * 1e-2
    }

    fn bound(&self, id: usize) -> f64 {
        match self.state[id] {
            RowState::Lower => self.table.lower[id],
            _ => self.table.upper[id],
        }
    }

    /// Searches from x, or from the minimum of the present equality problem if x is there.
    pub(crate) fn search(&mut self, goal: &Goal, mut at_minimum: bool) -> End {
        let mut stalled = 0;
        loop {
            if self.iterations >= self.settings.max_iterations {
                return End::OutOfIterations;
            }
            self.iterations += 1;
            // Least index first cannot cycle (Bland), but is slow: only after a stall.
            let careful = stalled > self.table.n;
            if !at_minimum {
                let minimum = self.equality_step(goal);
                let (length, blocking) = self.first_in_the_way(goal, minimum, careful);
                self.advance(goal, length);
                stalled = if length * norm(&self.direction) > 1e-14 * (1.0 + norm(&self.x)) {
                    0
                } else {
                    stalled + 1
                };
                if let Some((id, state)) = blocking {
                    if goal.has_row(id) {
                        self.state[id] = state;
                    } else {
                        self.activate(id, state);
                    }
                    continue;
                }
                if minimum == Minimum::Ray {
                    return End::Unbounded;
                }
            }
            at_minimum = false;
            match self.wrong_sign(goal, careful) {
                None => return End::Optimal,
                Some(Release::Hard(position)) => {
                    let id = self.basis.active()[position];
                    self.basis.remove_active(position);
                    self.state[id] = RowState::Inside;
                }
                Some(Release::Soft(id)) => {
                    self.residual[id] = self.value[id] - self.bound(id);
                    self.state[id] = RowState::Inside;
                }
            }
        }
    }

    /// The step to the minimum with the working set held, into `direction`.
    fn equality_step(&mut self, goal: &Goal) -> Minimum {
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
                self.least_squares
                    .push(target, row.norm(), |out| self.basis.free_coordinates(row, out));
            }
        }
        if let Some(level) = linear_of {
            let linear = &self.table.levels[level].linear;
            self.least_squares.set_linear(|out| self.basis.free_coordinates_of(linear, out));
        }
    }

    /// How far along `direction` x may go, and the row that stops it.
    fn first_in_the_way(
        &mut self,
        goal: &Goal,
        minimum: Minimum,
        careful: bool,
    ) -> (f64, Option<(usize, RowState)>) {
        let size = norm(&self.direction);
        let x_norm = norm(&self.x);
        let full = if minimum == Minimum::Ray { f64::INFINITY } else { 1.0 };
        for index in 0..self.hard.len() {
            let id = self.hard[index];
            let inside = self.state[id] == RowState::Inside;
            self.slope[id] = if inside { self.table.row(id).dot(&self.direction) } else { 0.0 };
        }
        if let Goal::Rows { rows, .. } = goal {
            for id in rows.clone() {
                self.slope[id] = self.table.row(id).dot(&self.direction);
            }
        }
        // Two passes: the bound relaxed by the tolerance finds how far x may go, and among the
        // rows met by then the one most across the direction is taken.
        let mut reach = full;
        self.for_each_in_the_way(goal, size, |room, slope, id| {
            let slack = if careful { 0.0 } else { self.tolerance(id, x_norm) };
            reach = reach.min((room + slack) / slope);
        });
        if reach >= full {
            return (full, None);
        }
        let mut best: Option<(f64, f64, usize, RowState)> = None;
        self.for_each_in_the_way_with_state(goal, size, |room, slope, id, state| {
            let ratio = room / slope;
            let pivot = slope / self.table.row(id).norm().max(f64::MIN_POSITIVE);
            let better = best.is_none_or(
                |(_, largest, least, _)| {
                    if careful { id < least } else { pivot > largest }
                },
            );
            if ratio <= reach && better {
                best = Some((ratio, pivot, id, state));
            }
        });
        match best {
            Some((ratio, _, id, state)) => (ratio.min(full), Some((id, state))),
            None => (reach, None),
        }
    }

    fn for_each_in_the_way(&self, goal: &Goal, size: f64, mut visit: impl FnMut(f64, f64, usize)) {
        self.for_each_in_the_way_with_state(goal, size, |room, slope, id, _| {
            visit(room, slope, id);
        });
    }

    /// Visits rows that the direction approaches: the room left (not negative), the speed of
    /// approach (positive), the row, and the side.
    fn for_each_in_the_way_with_state(
        &self,
        goal: &Goal,
        size: f64,
        mut visit: impl FnMut(f64, f64, usize, RowState),
    ) {
        let mut consider = |id: usize, value: f64, slope: f64| {
            let least = self.dependence_tolerance() * self.table.row(id).norm() * size;
            if slope > least && self.table.upper[id].is_finite() {
                visit((self.table.upper[id] - value).max(0.0), slope, id, RowState::Upper);
            } else if slope < -least && self.table.lower[id].is_finite() {
                visit((value - self.table.lower[id]).max(0.0), -slope, id, RowState::Lower);
            }
        };
        for &id in &self.hard {
            if self.state[id] == RowState::Inside {
                consider(id, self.value[id], self.slope[id]);
            }
        }
        if let Goal::Rows { rows, .. } = goal {
            for id in rows.clone() {
                if self.state[id] == RowState::Inside {
                    let residual = self.residual[id];
                    consider(id, self.value[id] - residual, self.slope[id] + residual);
                }
            }
        }
    }

    /// x ← x + length · direction.
    fn advance(&mut self, goal: &Goal, length: f64) {
        if !length.is_finite() {
            return;
        }
        add_scaled(&mut self.x, length, &self.direction);
        for &id in &self.hard {
            self.value[id] += length * self.slope[id];
        }
        if let Goal::Rows { rows, .. } = goal {
            for id in rows.clone() {
                self.value[id] += length * self.slope[id];
                self.residual[id] *= 1.0 - length.min(1.0);
            }
        }
    }

    /// Gradient of the goal at x, and below which size a multiplier (times its row's norm) is
    /// rounding.
    fn set_gradient(&mut self, goal: &Goal) -> f64 {
        let x_norm = norm(&self.x);
        let (size, noise) = match goal {
            Goal::Norm => {
                self.gradient.copy_from_slice(&self.x);
                (x_norm, 0.0)
            }
            Goal::Rows { rows, linear_of } => {
                self.gradient.fill(0.0);
                let (mut size, mut noise) = (0.0, 0.0);
                for id in rows.clone().filter(|&id| self.state[id].is_active()) {
                    let row = self.table.row(id);
                    let violation = self.value[id] - self.bound(id);
                    row.add_to(&mut self.gradient, violation);
                    size += row.norm() * violation.abs();
                    noise += row.norm() * self.table.magnitude(id, x_norm);
                }
                if let Some(level) = *linear_of {
                    let linear = &self.table.levels[level].linear;
                    add_scaled(&mut self.gradient, 1.0, linear);
                    size += norm(linear);
                }
                (size, noise)
            }
        };
        self.settings.optimality_tolerance * size + 1e-13 * noise
    }

    /// The row to let go: the one that is most wrong, or the first of the wrong ones.
    fn wrong_sign(&mut self, goal: &Goal, careful: bool) -> Option<Release> {
        let threshold = self.set_gradient(goal);
        self.basis.multipliers(&self.gradient, &mut self.multipliers);
        let mut worst: Option<(f64, usize, Release)> = None;
        let mut consider = |wrongness: f64, id: usize, release: Release| {
            let better = worst
                .is_none_or(|(most, least, _)| if careful { id < least } else { wrongness > most });
            if wrongness > threshold && better {
                worst = Some((wrongness, id, release));
            }
        };
        for (position, &id) in self.basis.active().iter().enumerate() {
            let force = self.multipliers[position] * self.table.row(id).norm();
            match self.state[id] {
                RowState::Upper => consider(-force, id, Release::Hard(position)),
                RowState::Lower => consider(force, id, Release::Hard(position)),
                _ => {}
            }
        }
        if let Goal::Rows { rows, .. } = goal {
            for id in rows.clone() {
                let force = (self.value[id] - self.bound(id)) * self.table.row(id).norm();
                match self.state[id] {
                    RowState::Upper => consider(-force, id, Release::Soft(id)),
                    RowState::Lower => consider(force, id, Release::Soft(id)),
                    _ => {}
                }
            }
        }
        worst.map(|(_, _, release)| release)
    }

    /// Whether row `position` of the working set is needed to hold the optimum: its multiplier
    /// is well away from zero, so that the row is active at every optimum of the level.
    pub(crate) fn is_strongly_active(&self, position: usize, threshold: f64) -> bool {
        let id = self.basis.active()[position];
        self.state[id] == RowState::Equal
            || self.multipliers[position].abs() * self.table.row(id).norm() > threshold
    }

    /// Multipliers of the working set for the goal at x; returns the size above which one counts.
    pub(crate) fn refresh_multipliers(&mut self, goal: &Goal) -> f64 {
        let threshold = self.set_gradient(goal);
        self.basis.multipliers(&self.gradient, &mut self.multipliers);
        threshold
    }

    /// Fixes the values that the rows of a minimised objective have at x; rows within their
    /// ranges become hard rows instead. The working set must be empty.
    pub(crate) fn fix_objective(&mut self, rows: Range<usize>, linear_of: Option<usize>) {
        let x_norm = norm(&self.x);
        self.least_squares.start(self.basis.free_count());
        for id in rows {
            let row = self.table.row(id);
            let pulled = self.state[id].is_active()
                && (self.table.is_equality(id)
                    || self.violation(id).abs() > self.tolerance(id, x_norm));
            if pulled {
                self.state[id] = RowState::Fixed;
                if row.norm() > 0.0 {
                    self.least_squares
                        .push(0.0, row.norm(), |out| self.basis.free_coordinates(row, out));
                }
            } else {
                self.state[id] = RowState::Inside;
                self.hard.push(id);
            }
        }
        if let Some(level) = linear_of {
            let linear = &self.table.levels[level].linear;
            let size = norm(linear);
            self.least_squares.push(0.0, size, |out| self.basis.free_coordinates_of(linear, out));
        }
        self.least_squares.factorise(self.settings.rank_tolerance);
        let (reflectors, stride, tau) = self.least_squares.reflectors();
        self.basis.fix_reflected(reflectors, stride, tau);
    }

    /// Jumps to the minimum of the equality problem of a guessed working set, and keeps it if
    /// every row in play holds there.
    pub(crate) fn try_guess(
        &mut self,
        guess: &[(usize, RowState)],
        goal: Option<&Goal>,
        fresh: Range<usize>,
    ) -> bool {
        self.saved.copy_from_slice(&self.x);
        self.kept.clear();
        for &id in self.basis.active() {
            self.kept.push((id, self.state[id]));
            self.state[id] = RowState::Inside;
        }
        self.basis.clear_active();
        for id in fresh.clone() {
            self.state[id] = RowState::Inside;
            self.hard.push(id);
            if self.table.is_equality(id) {
                self.activate(id, RowState::Equal);
            }
        }
        self.take_guess(guess, goal);
        self.jump(goal);
        if self.all_hold(goal) {
            return true;
        }
        self.x.copy_from_slice(&self.saved);
        for position in 0..self.basis.active().len() {
            self.state[self.basis.active()[position]] = RowState::Inside;
        }
        self.basis.clear_active();
        self.hard.truncate(self.hard.len() - fresh.len());
        for id in fresh {
            self.state[id] = RowState::Absent;
        }
        self.refresh_values();
        for index in 0..self.kept.len() {
            let (id, state) = self.kept[index];
            self.activate(id, state);
        }
        false
    }

    fn take_guess(&mut self, guess: &[(usize, RowState)], goal: Option<&Goal>) {
        if let Some(Goal::Rows { rows, .. }) = goal {
            for id in rows.clone() {
                self.residual[id] = 0.0;
                self.state[id] =
                    if self.table.is_equality(id) { RowState::Equal } else { RowState::Inside };
            }
        }
        for &(id, state) in guess {
            let bounded = match state {
                RowState::Lower => self.table.lower[id].is_finite(),
                RowState::Upper => self.table.upper[id].is_finite(),
                _ => false,
            };
            if !bounded || self.state[id] != RowState::Inside {
                continue;
            }
            if goal.is_some_and(|goal| goal.has_row(id)) {
                self.state[id] = state;
            } else {
                self.activate(id, state);
            }
        }
    }

    /// To the minimum of the equality problem, rows of the working set brought to their bounds.
    fn jump(&mut self, goal: Option<&Goal>) {
        for position in 0..self.basis.active().len() {
            let id = self.basis.active()[position];
            self.gradient[position] = self.bound(id) - self.table.row(id).dot(&self.x);
        }
        let count = self.basis.active().len();
        self.basis.reach_targets(&self.gradient[..count], &mut self.x);
        let Some(goal) = goal else { return };
        if let Goal::Rows { rows, .. } = goal {
            for id in rows.clone() {
                self.value[id] = self.table.row(id).dot(&self.x);
            }
        }
        if self.equality_step(goal) == Minimum::Point {
            add_scaled(&mut self.x, 1.0, &self.direction);
        }
        if let Goal::Rows { rows, .. } = goal {
            for id in rows.clone() {
                self.value[id] = self.table.row(id).dot(&self.x);
            }
        }
    }

    fn refresh_values(&mut self) {
        for &id in &self.hard {
            self.value[id] = self.table.row(id).dot(&self.x);
        }
    }

    /// Whether hard rows, and rows of the objective that count as inside, hold at x.
    fn all_hold(&mut self, goal: Option<&Goal>) -> bool {
        self.refresh_values();
        let x_norm = norm(&self.x);
        let holds = |id: usize| self.violation(id).abs() <= self.tolerance(id, x_norm);
        self.hard.iter().all(|&id| holds(id))
            && match goal {
                Some(Goal::Rows { rows, .. }) => {
                    rows.clone().all(|id| self.state[id] != RowState::Inside || holds(id))
                }
                _ => true,
            }
    }
}
