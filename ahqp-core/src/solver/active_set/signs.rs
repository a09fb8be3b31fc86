//! Signs of multipliers.

use std::ops::{Deref, DerefMut};

use crate::linalg::list::List;
use crate::solver::activity::Activity;
use crate::solver::tolerances::RELEASED;

/// Which active inequalities have shown that their sign is right: the first multiplier that
/// differs from zero decides.
#[derive(Debug, Clone)]
pub(super) struct Signs {
    /// All rows but the active inequalities whose sign has yet to be seen.
    settled: Vec<bool>,
    /// How many those are.
    pub(super) unsettled: usize,
    wrong: WrongRows,
    /// Rows whose activity the check at hand has changed.
    pub(super) changed: List<usize>,
}

impl Signs {
    pub(super) fn new(rows: usize) -> Self {
        Self {
            settled: vec![false; rows],
            unsettled: 0,
            wrong: WrongRows::with_capacity(rows),
            changed: List::with_capacity(rows),
        }
    }

    pub(super) fn begin(&mut self, activity: &[Activity]) {
        self.changed.clear();
        self.wrong.clear();
        self.unsettled = 0;
        for (settled, &state) in self.settled.iter_mut().zip(activity) {
            *settled = !matches!(state, Activity::Lower | Activity::Upper);
            self.unsettled += usize::from(!*settled);
        }
    }

    /// Looks at the multiplier of a row in this state, given the rounding in it and the row's norm.
    pub(super) fn check(
        &mut self,
        id: usize,
        state: Activity,
        multiplier: f64,
        rounding: f64,
        norm: f64,
    ) {
        if !self.settled[id] && multiplier.abs() > rounding {
            self.settled[id] = true;
            self.unsettled -= 1;
            if state.has_wrong_sign(multiplier, rounding) {
                self.wrong.push((id, multiplier.abs() * norm));
            }
        }
    }

    /// Returns true if the sign of row `id` has yet to be seen.
    pub(super) fn is_open(&self, id: usize) -> bool {
        !self.settled[id]
    }

    /// Lets go of the rows that are most wrong; how many.
    pub(super) fn release(&mut self, activity: &mut [Activity]) -> usize {
        let before = self.changed.len();
        self.wrong.keep_large();
        for &(id, _) in self.wrong.iter() {
            activity[id] = Activity::Inactive;
            self.changed.push(id);
        }
        self.wrong.clear();
        self.changed.len() - before
    }
}

/// Rows whose sign is wrong, with their forces: multipliers times norms.
#[derive(Debug, Clone)]
pub(super) struct WrongRows(List<(usize, f64)>);

impl WrongRows {
    pub(super) fn with_capacity(rows: usize) -> Self {
        Self(List::with_capacity(rows))
    }

    fn largest(&self) -> f64 {
        self.iter().fold(0.0, |largest, &(_, force)| largest.max(force))
    }

    /// Keeps those whose forces are a large part of the largest.
    pub(super) fn keep_large(&mut self) {
        let least = RELEASED * self.largest();
        self.retain(|&(_, force)| force >= least);
    }

    /// Keeps the one with the largest force.
    pub(super) fn keep_largest(&mut self) {
        let largest = self.largest();
        self.retain(|&(_, force)| force == largest);
        self.truncate(1);
    }

    /// Keeps the first row of the problem.
    pub(super) fn keep_first(&mut self) {
        let first = self.iter().map(|&(id, _)| id).min();
        self.retain(|&(id, _)| Some(id) == first);
    }
}

impl Deref for WrongRows {
    type Target = List<(usize, f64)>;

    fn deref(&self) -> &Self::Target {
        &self.0
    }
}

impl DerefMut for WrongRows {
    fn deref_mut(&mut self) -> &mut Self::Target {
        &mut self.0
    }
}
