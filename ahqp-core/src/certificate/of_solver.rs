//! Certificate of a solver's last solution.

use super::Certificate;
use super::multipliers::Proof;
use crate::error::Error;
use crate::problem::hierarchy::Hierarchy;
use crate::problem::ids::LevelId;
use crate::problem::source::ConstraintSource;
use crate::solver::Solver;
use crate::solver::data::ProblemData;

impl Solver {
    /// Returns the multipliers that prove the last solution optimal. [`Certificate::residuals`]
    /// checks them. Allocates, so it is for debugging and tests, not for the control loop.
    ///
    /// # Errors
    /// Those of [`solve`](Self::solve) if the data are invalid. [`Error::NotSolved`] if the last
    /// solve did not end at the optimum, or was [forgotten](Self::forget). [`Error::DataChanged`]
    /// if `hierarchy` does not contain the data that were solved.
    pub fn certificate(&mut self, hierarchy: &Hierarchy) -> Result<Certificate, Error> {
        let (set, x) = self.at_optimum().ok_or(Error::NotSolved)?;
        set.data.expect_unchanged(hierarchy).map_err(|error| hierarchy.named(error))?;
        set.fit();
        set.factorise();
        let found = Proof::new(set, x).levels()?;
        let data = &mut set.data;
        let levels = found
            .iter()
            .map(|multipliers| named(hierarchy, data, multipliers))
            .collect::<Result<_, _>>()?;
        let active = (0..data.len())
            .filter(|&id| set.activity[id].is_active())
            .map(|id| data.sources[id])
            .collect();
        Ok(Certificate { data: data.clone(), levels, active })
    }
}

/// Returns the multipliers with the sources of their rows. Those of a quadratic's factor are
/// converted to rows of its Hessian.
fn named(
    hierarchy: &Hierarchy,
    data: &mut ProblemData,
    found: &[(usize, f64)],
) -> Result<Vec<(ConstraintSource, f64)>, Error> {
    let mut all: Vec<_> = Vec::with_capacity(found.len());
    for (level, of_hierarchy) in hierarchy.levels().iter().enumerate() {
        let rows = data.levels[level].clone();
        let of_level = found.iter().filter(|(id, _)| rows.objective.contains(id));
        if rows.quadratic {
            let mut multipliers = vec![0.0; rows.used];
            for &(id, multiplier) in of_level {
                multipliers[id - rows.objective.start] = multiplier;
            }
            if multipliers.iter().any(|&multiplier| multiplier != 0.0) {
                let on_hessian =
                    data.hessian_multipliers(level, of_hierarchy.objective(), &multipliers)?;
                all.extend(on_hessian.into_iter().map(|(row, multiplier)| {
                    (ConstraintSource::Objective { level: LevelId::new(level), row }, multiplier)
                }));
            }
        } else {
            all.extend(of_level.map(|&(id, m)| (data.sources[id], m * data.scale(id))));
        }
    }
    let plain = |id: usize| !matches!(data.sources[id], ConstraintSource::Objective { .. });
    let plain = found.iter().filter(|(id, _)| plain(*id));
    all.extend(plain.map(|&(id, m)| (data.sources[id], m * data.scale(id))));
    Ok(all)
}
