//! Check that a hierarchy still contains the data that were solved.

use super::ProblemData;
use crate::error::Error;
use crate::problem::hierarchy::Hierarchy;
use crate::problem::ids::LevelId;
use crate::problem::level::Objective;
use crate::problem::source::{ConstraintSource, Names};

impl ProblemData {
    /// Returns an error for the first row in which `hierarchy` differs from the data loaded last.
    /// Allocates.
    pub(crate) fn expect_unchanged(&self, hierarchy: &Hierarchy) -> Result<(), Error> {
        self.check_shape(hierarchy)?;
        let mut fresh = Self::new(hierarchy);
        fresh.load(hierarchy)?;
        let bounds = |table: &Self, id: usize| (table.lower[id], table.upper[id], table.scales[id]);
        // Rows without bounds do not count, nor rows of a quadratic beyond its rank.
        let counts = |id: usize| self.lower[id].is_finite() || self.upper[id].is_finite();
        let differs = |id: usize| {
            bounds(self, id) != bounds(&fresh, id)
                || (id >= self.n && counts(id) && self.coefficients(id) != fresh.coefficients(id))
        };
        let linear = || {
            let levels = self.levels.iter().zip(&fresh.levels).enumerate();
            levels.into_iter().find_map(|(level, (old, new))| {
                let row = old.linear.iter().zip(&new.linear).position(|(old, new)| old != new)?;
                Some(ConstraintSource::Objective { level: LevelId::new(level), row })
            })
        };
        let Some(id) = (0..self.len()).find(|&id| differs(id)) else {
            return match linear() {
                Some(source_of_row) => {
                    Err(Error::DataChanged { source_of_row, names: Names::default() })
                }
                None => Ok(()),
            };
        };
        let mut source_of_row = self.sources[id];
        if let ConstraintSource::Objective { level, row } = &mut source_of_row
            && let Objective::Quadratic { hessian, gradient } =
                hierarchy.levels()[level.index()].objective()
        {
            fresh.factor.factorise(level.index(), hessian, gradient)?;
            *row = fresh.factor.pivot(*row).unwrap_or(*row);
        }
        Err(Error::DataChanged { source_of_row, names: Names::default() })
    }
}
