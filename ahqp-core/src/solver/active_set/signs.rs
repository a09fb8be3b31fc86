//! Signs of multipliers.

use crate::linalg::list::List;
use crate::solver::activity::Activity;

/// Active inequalities whose sign has been found right. The first nonzero multiplier decides.
#[derive(Debug, Clone)]
pub(super) struct Signs {
    /// Marks of all rows except the active inequalities whose sign is still open.
    settled: Vec<bool>,
    /// Number of open rows.
    pub(super) unsettled: usize,
    /// The row whose sign is most wrong, and its force: the multiplier times the row's norm.
    wrong: Option<(usize, f64)>,
    /// Rows whose activity the current check has changed.
    pub(super) changed: List<usize>,
}

impl Signs {
    pub(super) fn new(rows: usize) -> Self {
        Self {
            settled: vec![false; rows],
            unsettled: 0,
            wrong: None,
            changed: List::with_capacity(rows),
        }
    }

    pub(super) fn begin(&mut self, activity: &[Activity]) {
        self.changed.clear();
        self.wrong = None;
        self.unsettled = 0;
        for (settled, &state) in self.settled.iter_mut().zip(activity) {
            *settled = !matches!(state, Activity::Lower | Activity::Upper);
            self.unsettled += usize::from(!*settled);
        }
    }

    /// Checks the multiplier of a row in this state, given its rounding and the row's norm.
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
            let force = multiplier.abs() * norm;
            if state.has_wrong_sign(multiplier, rounding)
                && self.wrong.is_none_or(|(_, largest)| force > largest)
            {
                self.wrong = Some((id, force));
            }
        }
    }

    /// Returns true if the sign of row `id` is still open.
    pub(super) fn is_open(&self, id: usize) -> bool {
        !self.settled[id]
    }

    /// Makes the row inactive whose sign is most wrong. Returns true if there is one.
    pub(super) fn release(&mut self, activity: &mut [Activity]) -> bool {
        let Some((id, _)) = self.wrong.take() else { return false };
        activity[id] = Activity::Inactive;
        self.changed.push(id);
        true
    }
}
