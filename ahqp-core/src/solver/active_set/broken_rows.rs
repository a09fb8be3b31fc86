//! Hard rows that do not hold where a search has ended.
//!
//! Each decision of a search is right within the rounding of its own sum. Where all terms of a row are
//! small beside x, several of them together can leave it violated.

use super::ActiveSet;
use crate::linalg::vector::norm;
use crate::solver::data::Coefficients;
use crate::solver::tolerances::ROUNDS;

impl ActiveSet {
    /// The hard row that is most violated at x within its bounds, if that is no rounding.
    pub(crate) fn broken_row(&mut self) -> Option<usize> {
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

    /// Finds the most violated of these rows; none if the violation is rounding.
    pub(crate) fn most_violated(&self, rows: impl Iterator<Item = usize>) -> Option<usize> {
        let excess = rows.map(|id| (id, self.excess(id)));
        let worst = excess.max_by(|a, b| a.1.total_cmp(&b.1));
        worst.filter(|&(_, excess)| excess > 1.0).map(|(id, _)| id)
    }

    /// Moves x onto broken hard rows, one after the other (Kaczmarz), as long as that moves x by no more
    /// than the feasibility tolerance of its length.
    pub(crate) fn move_onto_broken_rows(&mut self) {
        let most = self.settings.feasibility_tolerance * norm(&self.x);
        for _ in 0..ROUNDS * self.data.n {
            let Some(id) = self.broken_row() else { return };
            let norm = self.data.norm_beside_bounds(id, &self.activity);
            let distance = self.violation(id) / norm;
            // Also where the row has nothing at free variables.
            if distance.is_nan() || distance.abs() > most {
                return;
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
    }
}
