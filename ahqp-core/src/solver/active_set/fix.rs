//! Fixing what a level decided for the levels below.

use std::ops::Range;

use super::{ActiveSet, Goal};
use crate::linalg::vector::norm;
use crate::solver::activity::Activity;
use crate::solver::tolerances::{CERTAIN, SETTLED};

impl ActiveSet {
    /// Fixes what a level decided, at the end of its search: active rows that it needs stay active.
    ///
    /// Rows of the objective that are violated keep their values; the others are hard rows from here on.
    /// Active rows that the level does not need, as their multipliers are rounding, stay active until a
    /// level below drops them: that moves x along a direction in which no level above has a gradient.
    pub(crate) fn fix_level(&mut self, goal: Option<&Goal>) {
        let factorisation = &self.factorisation;
        for &id in factorisation.stacked.iter().chain(&factorisation.bounded) {
            self.fixed[id] |= self.activity[id] == Activity::Equal;
        }
        if goal.is_some() && self.has_gradient {
            // Where rows nearly depend on each other, a row that is fixed for its rounding would keep the
            // levels below from all that these rows leave open.
            let residuals = self.multipliers.residuals(factorisation);
            for (id, multiplier, rounding) in
                residuals.chain(self.multipliers.with_most_rounding(factorisation))
            {
                self.fixed[id] |= multiplier.abs() > CERTAIN * rounding;
            }
        }
        if let Some(goal @ Goal::Rows(rows)) = goal {
            if self.factorisation.hold_met_group() {
                self.residual[rows.clone()].fill(0.0);
            } else {
                self.release_unneeded(goal, rows.clone());
            }
            let rows = rows.clone();
            if rows.clone().any(|id| !self.fixed[id]) {
                self.in_play.push(rows);
            }
        }
        let fixed = &self.fixed;
        self.factorisation.close_groups(|id| !fixed[id]);
    }

    /// Makes rows of a minimised objective inactive that are not violated, unless x would move without them:
    /// where rows nearly depend on each other, rounding hides by how much the objective needs them.
    fn release_unneeded(&mut self, goal: &Goal, rows: Range<usize>) {
        for id in rows.clone() {
            if self.activity[id].is_active() && !self.fixed[id] {
                let state = self.activity[id];
                self.released.push((id, state));
                self.activity[id] = Activity::Inactive;
                self.factorisation.take_out(&self.data, &self.activity, id);
            }
        }
        if !self.released.is_empty() {
            let has_minimum = self.set_direction(goal);
            let is_far = norm(&self.direction) > SETTLED * (1.0 + norm(&self.x));
            if is_far || !has_minimum {
                self.take_back_released();
            }
            self.released.clear();
        }
        for id in rows {
            if self.activity[id] == Activity::Inactive {
                self.residual[id] = 0.0;
            }
        }
    }

    fn take_back_released(&mut self) {
        let group = self.factorisation.groups.len() - 1;
        for index in 0..self.released.len() {
            let (id, state) = self.released[index];
            self.activity[id] = state;
            self.fixed[id] = true;
            self.factorisation.add(&self.data, &self.activity, id, group);
        }
    }
}
