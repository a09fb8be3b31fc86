//! Signs of multipliers.

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
    /// Rows whose sign is wrong, and their multipliers times their norms.
    wrong: List<(usize, f64)>,
    /// Rows whose activity the check at hand has changed.
    pub(super) changed: List<usize>,
}

impl Signs {
    pub(super) fn new(rows: usize) -> Self {
        Self {
            settled: vec![false; rows],
            unsettled: 0,
            wrong: List::with_capacity(rows),
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
        let most = self.wrong.iter().fold(0.0_f64, |most, &(_, force)| most.max(force));
        let before = self.changed.len();
        for &(id, force) in &self.wrong {
            if force >= RELEASED * most {
                activity[id] = Activity::Inactive;
                self.changed.push(id);
            }
        }
        self.wrong.clear();
        self.changed.len() - before
    }
}
