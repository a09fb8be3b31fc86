//! Fixing the decisions of a level for the levels below.

use std::ops::Range;

use super::ActiveSet;
use crate::linalg::vector::norm;
use crate::solver::active_set::goal::Goal;
use crate::solver::activity::Activity;
use crate::solver::tolerances::{CERTAIN, SETTLED};

impl ActiveSet {
    /// Fixes the decisions of a level at the end of its search. Active rows that it needs stay
    /// active.
    ///
    /// Violated rows of the objective keep their values. The other rows of the objective become
    /// hard rows. A row is not needed if its multiplier is rounding. It stays active until a level
    /// below drops it, which moves x along a direction in which no level above has a gradient.
    pub(crate) fn fix_level(&mut self, goal: Option<&Goal>) {
        let factorisation = &self.factorisation;
        for &id in factorisation.stacked.iter().chain(&factorisation.bounded) {
            self.fixed[id] |= self.activity[id] == Activity::Equal;
        }
        if goal.is_some() && self.has_gradient {
            let residuals = self.multipliers.residuals(factorisation);
            for (id, multiplier, rounding) in
                residuals.chain(self.multipliers.with_rounding(factorisation))
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
                self.monitor(rows);
            }
        }
    }

    /// Makes rows of a finished objective inactive that it does not need. They are not violated.
    /// Rows stay active if the optimum would move without them, since their force exists but is
    /// below rounding.
    fn release_unneeded(&mut self, goal: &Goal, rows: Range<usize>) {
        self.released.clear();
        let group = self.factorisation.groups.len() - 1;
        for id in rows {
            if self.activity[id].is_active() && !self.fixed[id] {
                self.released.push((id, self.activity[id]));
                self.activity[id] = Activity::Inactive;
                self.take_out(id, group);
            }
            if self.activity[id] == Activity::Inactive {
                self.residual[id] = 0.0;
            }
        }
        if self.released.is_empty() || !self.moves(goal) {
            return;
        }
        for index in 0..self.released.len() {
            let (id, state) = self.released[index];
            self.activity[id] = state;
            self.fixed[id] = true;
            self.add_row(id, group);
        }
    }

    /// Returns true if the minimum of the goal is not at x.
    fn moves(&mut self, goal: &Goal) -> bool {
        self.set_direction(goal).has_minimum
            && norm(&self.direction) > SETTLED * (1.0 + norm(&self.x))
    }
}
