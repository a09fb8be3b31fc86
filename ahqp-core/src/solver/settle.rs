//! What a level decided, fixed for the levels below.

use std::ops::Range;

use crate::linalg::vector::norm;
use crate::solver::active_set::{ActiveSet, Goal, RowState};
use crate::solver::tolerances::CERTAIN;

impl ActiveSet {
    /// Fixes what the level decided at the end of its search: rows of its objective keep their values (those within
    /// their ranges stay within), and hard rows with a multiplier stay at their bounds.
    /// `activity` takes down what the rows do.
    pub(crate) fn settle(&mut self, goal: Option<&Goal>, activity: &mut [RowState]) {
        let counts = goal.is_some() && self.is_pulled;
        self.left.clear();
        for position in 0..self.basis.active().len() {
            let id = self.basis.active()[position];
            self.left.push((id, self.state[id]));
            if self.is_strongly_active(position, counts) {
                activity[id] = self.state[id];
                self.state[id] = RowState::Fixed;
            }
        }
        if goal.is_none() {
            if self.left.iter().all(|&(id, _)| self.state[id] != RowState::Fixed) {
                return;
            }
            self.pulled.clear(true);
        }
        let mut linear = None;
        if let Some(Goal::Rows { rows, linear_of }) = goal {
            linear = *linear_of;
            self.settle_objective(rows.clone(), activity);
        }
        for ((id, _), weak) in self.left.iter().zip(&mut self.weak) {
            *weak = self.state[*id] != RowState::Fixed;
        }
        let kept = self.pulled.fix(&mut self.basis, &self.table, &self.weak);
        if !kept {
            self.release_weak();
            if !self.pulled.fix(&mut self.basis, &self.table, &self.weak) {
                self.fix_by_rank(goal, linear);
                self.take_down_decided(activity);
            }
        }
        self.pulled.clear(false);
        for index in 0..self.left.len() {
            let (id, state) = self.left[index];
            if self.state[id] != RowState::Fixed && !self.basis.active().contains(&id) {
                self.state[id] = RowState::Inside;
                if !kept {
                    self.hold(id, state);
                }
            }
        }
    }

    /// What the level decided in doubt of a rank may rest on rows that looked weak: those that
    /// cannot move any more are active.
    fn take_down_decided(&self, activity: &mut [RowState]) {
        let tolerance = self.dependence_tolerance();
        for &(id, state) in &self.left {
            if self.basis.is_fixed(self.table.row(id), tolerance) {
                activity[id] = state;
            }
        }
    }

    /// Whether row `position` of the working set is needed to hold the optimum: its multiplier
    /// is well away from zero, so that the row is active at every optimum of the level.
    /// No multiplier `counts` where the level has no gradient.
    pub(crate) fn is_strongly_active(&self, position: usize, counts: bool) -> bool {
        let id = self.basis.active()[position];
        let rounding = CERTAIN * self.multiplier_rounding[position];
        self.state[id] == RowState::Equal || (counts && self.multipliers[position].abs() > rounding)
    }

    /// Rows of a minimised objective that are pulled keep their values; the others, within their
    /// ranges, are hard rows from here on.
    fn settle_objective(&mut self, rows: Range<usize>, activity: &mut [RowState]) {
        let mut any_inside = false;
        for id in rows.clone() {
            let pulled = self.state[id].is_active();
            let is_violated =
                self.is_pulled && self.pull[id].abs() > CERTAIN * self.pull_rounding[id];
            let held = pulled && (self.table.is_equality(id) || is_violated);
            if held {
                activity[id] = self.state[id];
                self.state[id] = RowState::Fixed;
            } else {
                if pulled {
                    self.let_go(id);
                }
                activity[id] = RowState::Inside;
                self.state[id] = RowState::Inside;
                self.residual[id] = 0.0;
                any_inside = true;
            }
        }
        if any_inside {
            self.in_play.push(rows);
        }
    }

    /// Takes the weak rows out of the working set.
    fn release_weak(&mut self) {
        for position in (0..self.basis.active().len()).rev() {
            if std::mem::take(&mut self.weak[position]) {
                self.pulled.release(&mut self.basis, &self.table, position);
            }
        }
    }

    /// Fixes the directions of the rows marked so, ranks decided by pivoting.
    fn fix_by_rank(&mut self, goal: Option<&Goal>, linear_of: Option<usize>) {
        let tolerance = self.settings.rank_tolerance;
        self.basis.clear_active();
        for &(id, _) in &self.left {
            if self.state[id] == RowState::Fixed {
                self.basis.fix(self.table.row(id), tolerance);
            }
        }
        let Some(Goal::Rows { rows, .. }) = goal else { return };
        self.least_squares.start(self.basis.free_count());
        for id in rows.clone() {
            let row = self.table.row(id);
            if self.state[id] == RowState::Fixed && row.norm() > 0.0 {
                let reduce = |out: &mut [f64]| self.basis.free_coordinates(row, out);
                self.least_squares.push(0.0, row.norm(), reduce);
            }
        }
        if let Some(level) = linear_of {
            let linear = &self.table.levels[level].linear;
            let size = norm(linear);
            self.least_squares.push(0.0, size, |out| self.basis.free_coordinates_of(linear, out));
        }
        self.least_squares.factorise(tolerance);
        let (reflectors, stride, tau) = self.least_squares.reflectors();
        self.basis.fix_reflected(reflectors, stride, tau);
    }
}
