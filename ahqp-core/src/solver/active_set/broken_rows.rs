//! Hard rows that are violated at the end of a search.
//!
//! Each decision of a search is right within the rounding of its own sum. If all terms of a row are
//! small compared with x, several decisions together can leave it violated.

use super::ActiveSet;
use crate::linalg::vector::norm;
use crate::solver::data::Coefficients;
use crate::solver::tolerances::ROUNDS_AFTER;

impl ActiveSet {
    /// Clamps x to its bounds, and returns the most violated hard row. None if the violation is
    /// rounding.
    fn broken_row(&mut self) -> Option<usize> {
        for (x, (&lower, &upper)) in
            self.x.iter_mut().zip(self.data.lower.iter().zip(&self.data.upper))
        {
            *x = x.clamp(lower, upper);
        }
        let Self { data, x, value, .. } = self;
        for level in &data.levels {
            data.multiply(level.constraints.clone(), x, value);
        }
        let constraints = self.data.levels.iter().flat_map(|level| level.constraints.clone());
        self.most_violated(constraints)
    }

    /// Returns the most violated of these rows. None if the violation is rounding.
    pub(crate) fn most_violated(&self, rows: impl Iterator<Item = usize>) -> Option<usize> {
        let relative_violation = rows.map(|id| (id, self.relative_violation(id)));
        let worst = relative_violation.max_by(|a, b| a.1.total_cmp(&b.1));
        worst.filter(|&(_, relative_violation)| relative_violation > 1.0).map(|(id, _)| id)
    }

    /// Moves x onto violated hard rows one after the other (Kaczmarz). Returns a row that stays
    /// violated. It stops at a row for which x would have to move by more than the feasibility
    /// tolerance of its length.
    pub(crate) fn move_onto_broken_rows(&mut self) -> Option<usize> {
        let most = self.settings.feasibility_tolerance * norm(&self.x);
        for _ in 0..ROUNDS_AFTER * self.data.n {
            let id = self.broken_row()?;
            let norm = self.data.norm_beside_bounds(id, &self.activity);
            let distance = self.violation(id) / norm;
            // The distance is NaN if the row has no coefficient at a free variable.
            if distance.is_nan() || distance.abs() > most {
                return Some(id);
            }
            let Self { data, x, activity, .. } = self;
            match data.row(id).coefficients() {
                Coefficients::Unit(variable) => x[variable] -= distance,
                Coefficients::Dense(row) => {
                    let free = x.iter_mut().zip(row).zip(activity.iter());
                    for ((x, a), _) in free.filter(|(_, state)| !state.is_active()) {
                        *x -= distance * (a / norm);
                    }
                }
            }
        }
        self.broken_row()
    }
}
