//! The primal active-set method within one level, from a point at which all monitored hard rows hold.
//!
//! Each iteration goes towards the minimum with the active rows held. It stops at the first
//! blocking row, which becomes active. If no row blocks, the row with the largest force of the
//! wrong sign becomes inactive (Nocedal & Wright, Numerical Optimization, algorithm 16.3). The
//! violations of soft rows are variables that are never formed. The objective never rises.
//! Where many rows meet, a search from a prediction may take long. It gives up, and one from
//! nothing begins, which comes to them one by one. Every search ends at the iteration limit.

use super::goal::Goal;
use super::{ActiveSet, Residuals};
use crate::linalg::vector::{add_scaled, norm};
use crate::solver::activity::Activity;
use crate::solver::data::active_bound;
use crate::solver::factorisation::{FreeCoordinates, Purpose, Step};
use crate::solver::tolerances::{LONG, ROUNDING, SETTLED};

/// Ending of a search.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum End {
    Optimal,
    Unbounded,
    OutOfBudget,
    /// A search from a prediction takes long.
    GaveUp,
}

/// A row that has just become inactive.
#[derive(Debug, Clone, Copy)]
struct Dropped {
    id: usize,
    /// Former activity and group.
    state: Activity,
    group: usize,
    /// True if the change left a free direction to an objective above the goal.
    frees_objectives_above: bool,
}

impl ActiveSet {
    /// Moves x to the minimum of the goal.
    pub(crate) fn search(&mut self, goal: &Goal) -> End {
        let (count, last) = (self.monitored.len(), self.monitored.last().cloned());
        if let Goal::Rows(rows) = goal {
            self.monitor(rows.clone());
        }
        let end = self.go_to_minimum(goal);
        self.monitored.truncate(count);
        if let (Some(now), Some(last)) = (self.monitored.last_mut(), last) {
            *now = last;
        }
        end
    }

    fn go_to_minimum(&mut self, goal: &Goal) -> End {
        self.tabu.clear();
        let mut dropped: Option<Dropped> = None;
        let begun = self.iterations;
        loop {
            if self.remaining.is_spent(self.iterations) {
                return End::OutOfBudget;
            }
            self.iterations += 1;
            let longest = LONG * self.data.n;
            let is_long = self.iterations - begun > longest;
            if is_long && self.is_predicted && self.remaining.left(self.iterations) > longest {
                return End::GaveUp;
            }
            let step = self.set_direction(goal);
            let has_minimum = step.has_minimum;
            let row = dropped.take();
            if let Some(row) = row.filter(|row| row.frees_objectives_above)
                && step.of_objectives_above > SETTLED * (1.0 + norm(&self.x))
            {
                self.take_back(goal, row);
                continue;
            }
            let full = if has_minimum { 1.0 } else { f64::INFINITY };
            let (length, blocking) = self.ratio_test(goal, full);
            self.advance(goal, length, step.moving);
            if blocking.is_none() && has_minimum {
                self.attain();
            }
            if let Some((id, bound)) = blocking {
                self.activate(goal, id, bound);
                continue;
            }
            if !has_minimum {
                return End::Unbounded;
            }
            dropped = self.find_wrong_row(goal).map(|id| self.drop_row(goal, id));
            if dropped.is_none() {
                return End::Optimal;
            }
        }
    }

    /// Computes the step to the minimum with the active rows held. If there is no minimum, it is a
    /// direction along which the goal decreases without bound.
    pub(super) fn set_direction(&mut self, goal: &Goal) -> Step {
        let free = match goal {
            Goal::Rows(_) => FreeCoordinates::Kept,
            Goal::Norm => FreeCoordinates::Zero,
        };
        let (part, max_norm) = (self.settings.feasibility_tolerance, self.max_norm);
        let Self { data, factorisation, x, value, activity, direction, attained, has_gaps, .. } =
            self;
        // A correction of a gap within the tolerance would move x far where rows nearly depend on
        // each other. Such rows are held where they are.
        let gap = |id: usize, purpose: Purpose| {
            let gap = active_bound(data, activity, id) - value[id];
            if purpose == Purpose::Minimised {
                return gap;
            }
            if gap.abs() <= ROUNDING * data.norm(id) * max_norm {
                return 0.0;
            }
            let is_closed = gap.abs() <= data.tolerance(id, x, max_norm, part);
            *has_gaps |= is_closed;
            if is_closed { 0.0 } else { gap }
        };
        let taken = factorisation.step_from(data, (x, *attained), gap, free, direction);
        for &variable in factorisation.stacked.iter().filter(|&&id| id < data.n) {
            // The step is exact, so that heavy rows see no rounding of it.
            let step = active_bound(data, activity, variable) - x[variable];
            direction[variable] = if taken.has_minimum { step } else { 0.0 };
        }
        taken
    }

    /// Computes x ← x + length · direction. The step moves the groups from `moving` on.
    fn advance(&mut self, goal: &Goal, length: f64, moving: usize) {
        if !length.is_finite() {
            return;
        }
        add_scaled(&mut self.x, length, &self.direction);
        self.max_norm = self.max_norm.max(norm(&self.x)).min(f64::MAX);
        for rows in &self.monitored {
            add_scaled(&mut self.value[rows.clone()], length, &self.slope[rows.clone()]);
        }
        let Self { data, factorisation, value, direction, .. } = self;
        for (id, step) in factorisation.steps_of_held(moving, |id| data.row(id).dot(direction)) {
            value[id] += length * step;
        }
        if let Goal::Rows(rows) = goal {
            for residual in &mut self.residual[rows.clone()] {
                *residual *= 1.0 - length.min(1.0);
            }
        }
    }

    /// Records that x is where the active rows hold. Variables at a bound are set to it exactly.
    fn attain(&mut self) {
        self.attained = self.factorisation.groups.len();
        for &variable in self.factorisation.stacked.iter().filter(|&&id| id < self.data.n) {
            self.x[variable] = active_bound(&self.data, &self.activity, variable);
        }
    }

    /// Makes a row active. A hard row joins the group of hard rows, a row of the objective the
    /// group of the objective.
    fn activate(&mut self, goal: &Goal, id: usize, bound: Activity) {
        self.activity[id] = bound;
        let last = self.factorisation.groups.len() - 1;
        let is_behind = matches!(goal, Goal::Rows(_)) && !goal.has_row(id);
        let group = if is_behind { last.saturating_sub(1) } else { last };
        let is_held = self.factorisation.groups[group].purpose == Purpose::Held;
        assert!(is_held || goal.has_row(id) || !cfg!(feature = "testing"));
        self.add_row(id, group);
    }

    /// Makes an active row inactive.
    fn drop_row(&mut self, goal: &Goal, id: usize) -> Dropped {
        if goal.has_row(id) {
            self.residual[id] = self.violation_of_active(id);
        }
        let (state, group) = (self.activity[id], self.factorisation.group_with(id));
        let rank = self.factorisation.rank_of_objectives_above();
        self.activity[id] = Activity::Inactive;
        self.take_out(id, group);
        let frees_objectives_above = self.factorisation.rank_of_objectives_above() > rank;
        Dropped { id, state, group, frees_objectives_above }
    }

    /// Makes a row active again if an objective above would move x without it. That objective needs
    /// the row with a multiplier that rounding hides. The row stays active to the end of the
    /// search.
    fn take_back(&mut self, goal: &Goal, row: Dropped) {
        if goal.has_row(row.id) {
            self.residual[row.id] = 0.0;
        }
        self.activity[row.id] = row.state;
        self.add_row(row.id, row.group);
        self.tabu.push(row.id);
    }

    /// Returns aᵢx − bound of an active row.
    fn violation_of_active(&self, id: usize) -> f64 {
        let bounds =
            if self.activity[id] == Activity::Lower { &self.data.lower } else { &self.data.upper };
        self.value[id] - bounds[id]
    }

    /// Returns the row with the largest force among those that should become inactive, since their
    /// multipliers have the wrong sign. None at the optimum.
    fn find_wrong_row(&mut self, goal: &Goal) -> Option<usize> {
        self.has_gradient = self.balance(goal);
        if !self.has_gradient {
            return None;
        }
        // Most such rows are far above rounding. The exact rounding is then not needed.
        let clear = self.multipliers.clear_force(&self.data, &self.factorisation);
        let pairs = self.multipliers.pairs(&self.factorisation).map(|(id, m)| (id, m, 0.0));
        let wrong = self.wrong_rows(pairs).filter(|&(_, force)| force > clear);
        let largest = wrong.max_by(|a, b| a.1.total_cmp(&b.1));
        if largest.is_some() {
            return largest.map(|(id, _)| id);
        }
        let Self { data, factorisation, multipliers, .. } = self;
        multipliers.set_rounding(data, factorisation);
        let wrong = self.wrong_rows(self.multipliers.with_rounding(&self.factorisation));
        wrong.max_by(|a, b| a.1.total_cmp(&b.1)).map(|(id, _)| id)
    }

    /// Returns the rows of the goal that may become inactive and have a wrong sign, with their
    /// forces. Rows that balance the gradient are given as (row, multiplier, rounding).
    fn wrong_rows(
        &self,
        pairs: impl Iterator<Item = (usize, f64, f64)>,
    ) -> impl Iterator<Item = (usize, f64)> {
        let rows = self.multipliers.residuals(&self.factorisation).chain(pairs);
        rows.filter(|&(id, multiplier, rounding)| {
            self.activity[id].has_wrong_sign(multiplier, rounding) && self.may_drop(id)
        })
        .map(|(id, multiplier, _)| (id, multiplier.abs() * self.data.norm(id)))
    }

    /// Balances the gradient of the goal at x. Returns false if it is rounding only.
    fn balance(&mut self, goal: &Goal) -> bool {
        let Self { data, factorisation, multipliers, value, activity, x, .. } = self;
        match goal {
            Goal::Norm => {
                multipliers.balance_norm(data, factorisation, x);
                true
            }
            Goal::Rows(_) => {
                let last = factorisation.groups.len() - 1;
                value[..data.n].copy_from_slice(x);
                let of = (last, Residuals::Balanced);
                multipliers.balance_level(data, factorisation, value, activity, of)
            }
        }
    }

    /// Returns true if row `id` is active and may become inactive.
    fn may_drop(&self, id: usize) -> bool {
        let is_inequality = matches!(self.activity[id], Activity::Lower | Activity::Upper);
        is_inequality && !self.fixed[id] && !self.tabu.contains(&id)
    }
}
