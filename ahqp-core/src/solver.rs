//! Solver: loads the data, predicts the active set, searches, and returns the solution.

pub(crate) mod active_set;
pub(crate) mod activity;
pub(crate) mod budget;
mod cascade;
pub(crate) mod data;
pub(crate) mod factorisation;
pub(crate) mod multipliers;
mod prediction;
mod quadratic_factor;
#[cfg(feature = "serde")]
mod seconds;
pub(crate) mod settings;
pub(crate) mod solution;
pub(crate) mod status;
pub(crate) mod tolerances;

use crate::error::Error;
use crate::linalg::list::List;
use crate::linalg::vector::norm;
use crate::problem::hierarchy::Hierarchy;
use crate::problem::source::{ConstraintSource, Names};
#[cfg(feature = "reference")]
use crate::reference::solve_reference;
use active_set::ActiveSet;
use activity::Activity;
use budget::{Budget, RemainingBudget};
use data::ProblemData;
use prediction::Prediction;
#[cfg(feature = "reference")]
use settings::Stacking;
use settings::{Settings, WarmStart};
use solution::Solution;
use status::Status;
use tolerances::{FAR, ROUNDS, ROUNDS_AFTER, SHORT};

/// Solves hierarchies of one shape, without allocation after construction.
///
/// At each level the solver makes the new hard constraints hold. It minimises the objective in the
/// directions that the levels above left free. It then fixes the directions that the level decided.
/// The equality Aₖχ = Aₖχ*ₖ of the paper (after its eq. 1) thereby holds by elimination, and the
/// problems shrink from level to level.
///
/// See [`Hierarchy`] for an example.
#[derive(Debug, Clone)]
pub struct Solver {
    set: ActiveSet,
    prediction: Prediction,
    /// Result of a search, in reserve while another way to the optimum is tried.
    incumbent: Incumbent,
    settings: Settings,
    solution: Solution,
    warm_start: WarmStartState,
    conflict: List<ConstraintSource>,
}

/// State that the last solve leaves for a warm start.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum WarmStartState {
    Nothing,
    /// The point that it reached within its budget.
    Part,
    Optimum,
}

/// The best result so far.
#[derive(Debug, Clone)]
struct Incumbent {
    x: Vec<f64>,
    activity: Vec<Activity>,
}

impl Incumbent {
    fn copy_from(&mut self, set: &ActiveSet) {
        self.x.copy_from_slice(&set.x);
        self.activity.copy_from_slice(&set.activity);
    }

    fn copy_to(&self, set: &mut ActiveSet) {
        set.x.copy_from_slice(&self.x);
        set.activity.copy_from_slice(&self.activity);
    }
}

impl Solver {
    /// Creates a solver for hierarchies of this shape.
    ///
    /// # Errors
    /// [`Error::Value`] if a setting is out of range.
    pub fn new(hierarchy: &Hierarchy, settings: Settings) -> Result<Self, Error> {
        settings.validate()?;
        let data = ProblemData::new(hierarchy);
        let (n, count) = (data.n, data.len());
        Ok(Self {
            solution: Solution { x: vec![0.0; n], status: Status::Solved, iterations: 0 },
            prediction: Prediction::new(count, n),
            incumbent: Incumbent { x: vec![0.0; n], activity: vec![Activity::Inactive; count] },
            warm_start: WarmStartState::Nothing,
            conflict: List::with_capacity(count),
            set: ActiveSet::new(data, settings),
            settings,
        })
    }

    /// The settings.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Changes the settings. If tolerances or method change, the next solve is a cold start.
    ///
    /// # Errors
    /// [`Error::Value`] if a setting is out of range. The settings are then unchanged.
    pub fn set_settings(&mut self, settings: Settings) -> Result<(), Error> {
        settings.validate()?;
        if !settings.has_tolerances_of(&self.settings) {
            self.forget();
        }
        self.settings = settings;
        self.set.change_settings(settings);
        Ok(())
    }

    /// Checks the data of a hierarchy without solving it.
    ///
    /// # Errors
    /// Those of [`Solver::solve`] for invalid data: [`Error::Datum`], [`Error::EmptyRange`],
    /// [`Error::Hessian`].
    pub fn validate(hierarchy: &Hierarchy) -> Result<(), Error> {
        ProblemData::validate(hierarchy)
    }

    /// Forgets the previous active set, so that the next solve is a cold start.
    pub fn forget(&mut self) {
        self.warm_start = WarmStartState::Nothing;
    }

    /// Returns the rows that cannot hold together after [`Error::Infeasible`], and nothing
    /// otherwise.
    ///
    /// These are constraints, bounds, and rows of objectives above, held at the values that their
    /// levels reached. Rows of a quadratic objective are those of its factor.
    /// [`Hierarchy::describe`] describes a row in words.
    pub fn conflict(&self) -> &[ConstraintSource] {
        &self.conflict
    }

    /// Returns the solution of the last solve. None before the first solve, after an error, and
    /// after [`forget`](Self::forget).
    pub fn solution(&self) -> Option<&Solution> {
        (self.warm_start != WarmStartState::Nothing).then_some(&self.solution)
    }

    /// Returns the active set and the point of the last solve, if it ended at the optimum.
    pub(crate) fn at_optimum(&mut self) -> Option<(&mut ActiveSet, &[f64])> {
        (self.warm_start == WarmStartState::Optimum).then_some((&mut self.set, &self.solution.x))
    }

    /// Solves `hierarchy`, which must have the shape given at construction.
    ///
    /// # Errors
    /// Invalid data: [`Error::Datum`], [`Error::EmptyRange`], [`Error::Hessian`],
    /// [`Error::ShapeChanged`]. A problem without a solution: [`Error::Infeasible`],
    /// [`Error::Unbounded`]. A problem beyond double precision: [`Error::Overflow`].
    pub fn solve(&mut self, hierarchy: &Hierarchy) -> Result<&Solution, Error> {
        self.solve_within(hierarchy, Budget::default())
    }

    /// Solves `hierarchy` within a budget of iterations and time. If the budget runs out, the
    /// [`Status`] says so, and the next warm solve continues from there.
    ///
    /// # Errors
    /// Those of [`solve`](Self::solve).
    pub fn solve_within(
        &mut self,
        hierarchy: &Hierarchy,
        budget: Budget,
    ) -> Result<&Solution, Error> {
        self.set.remaining = RemainingBudget::new(budget, self.settings.max_iterations);
        self.find_solution(hierarchy).map_err(|error| hierarchy.named(error))?;
        Ok(&self.solution)
    }

    /// Loads the data, predicts the active set, searches, and reads out the solution.
    fn find_solution(&mut self, hierarchy: &Hierarchy) -> Result<(), Error> {
        let start = std::mem::replace(&mut self.warm_start, WarmStartState::Nothing);
        self.conflict.clear();
        self.set.iterations = 0;
        self.set.data.load(hierarchy)?;
        #[cfg(feature = "reference")]
        if self.settings.stacking == Stacking::Equalities {
            return self.stack_equalities(hierarchy);
        }
        let status = if self.predict(start) {
            Status::Solved
        } else {
            self.search(hierarchy.levels().len())?
        };
        if !norm(&self.set.x).is_finite() {
            return Err(Error::Overflow);
        }
        self.remember(status);
        self.read_out(status);
        Ok(())
    }

    /// Solves by [`Stacking::Equalities`]. The active set stays unknown.
    #[cfg(feature = "reference")]
    fn stack_equalities(&mut self, hierarchy: &Hierarchy) -> Result<(), Error> {
        let optimum = solve_reference(hierarchy)?;
        self.set.x.copy_from_slice(optimum.as_slice());
        self.set.iterations = hierarchy.levels().len();
        self.warm_start = WarmStartState::Part;
        self.read_out(Status::Solved);
        Ok(())
    }

    /// Predicts the active set from earlier solves and repairs the prediction. Returns true if that
    /// led to the optimum. Otherwise leaves a start for the search.
    fn predict(&mut self, start: WarmStartState) -> bool {
        if self.settings.warm_start == WarmStart::Cold || start == WarmStartState::Nothing {
            self.prediction.forget();
            self.start_from_nothing();
            return false;
        }
        self.set.is_predicted = start == WarmStartState::Optimum;
        if start == WarmStartState::Optimum {
            self.prediction.predict(&mut self.set.activity);
        }
        self.set.fit();
        self.set.predicted.copy_from_slice(&self.set.activity);
        if start == WarmStartState::Optimum {
            let left = self.set.remaining.left(self.set.iterations);
            let rounds = ROUNDS.max(self.set.data.n / FAR);
            if self.set.repair(rounds.min(left)) {
                return true;
            }
            if self.set.is_rank_in_doubt() {
                self.start_from_nothing();
            }
        }
        false
    }

    /// Makes the next search start at zero, with only equalities active.
    fn start_from_nothing(&mut self) {
        self.set.is_predicted = false;
        self.set.predicted.fill(Activity::Inactive);
        self.solution.x.fill(0.0);
    }

    /// Returns true if the next search starts at zero, with only equalities active.
    fn is_from_nothing(&self) -> bool {
        self.set.predicted.iter().all(|state| !state.is_active())
            && self.solution.x.iter().all(|&x| x == 0.0)
    }

    fn remember(&mut self, status: Status) {
        if status == Status::Solved {
            self.warm_start = WarmStartState::Optimum;
            self.prediction.learn(&self.set.activity);
        } else {
            self.warm_start = WarmStartState::Part;
        }
    }

    /// Searches all levels from the prediction, and from nothing if that takes long or fails.
    ///
    /// A prediction may hold rows that meet only within their tolerances. Where they nearly depend
    /// on each other, such tolerances move x far.
    fn search(&mut self, levels: usize) -> Result<Status, Error> {
        let mut found = self.search_once(levels);
        if !matches!(found, Ok(Some(_))) && !self.is_from_nothing() {
            self.conflict.clear();
            self.start_from_nothing();
            found = self.search_once(levels);
        }
        Ok(found?.unwrap_or_else(|| self.set.remaining.status(None)))
    }

    /// Searches all levels, and ensures that the result satisfies the data. Searches again from
    /// nothing if the rank tolerance decided the active set. The same if x is so much shorter than
    /// its start that rounding took half of its digits. None if a search gives up.
    fn search_once(&mut self, levels: usize) -> Result<Option<Status>, Error> {
        let solved = Some(Status::Solved);
        let status = self.search_levels(levels)?;
        if status != solved {
            return Ok(status);
        }
        let length = norm(&self.set.x);
        let is_rounded = length > 0.0 && length < SHORT * norm(&self.solution.x);
        if !self.is_from_nothing() && (is_rounded || self.set.is_rank_in_doubt()) {
            self.incumbent.copy_from(&self.set);
            self.start_from_nothing();
            if self.search_levels(levels) != Ok(solved) {
                self.conflict.clear();
                self.incumbent.copy_to(&mut self.set);
            }
        }
        self.polish();
        match self.set.move_onto_broken_rows() {
            None => Ok(status),
            Some(id) => Err(self.inaccurate(id)),
        }
    }

    /// Repairs errors of rounding where the forces of rows differ much, and gaps of held rows within
    /// their tolerances. A new factorisation of all levels, with the active bounds as columns, has
    /// less rounding than an updated one.
    fn polish(&mut self) {
        if self.set.has_gaps || self.set.has_scale_disparity() {
            self.incumbent.copy_from(&self.set);
            let left = self.set.remaining.left(self.set.iterations);
            if !self.set.repair(ROUNDS_AFTER.min(left)) {
                self.incumbent.copy_to(&mut self.set);
            }
        }
    }

    /// Returns the error for a hard row that does not hold.
    fn inaccurate(&self, id: usize) -> Error {
        let source_of_row = self.set.data.sources[id];
        let violation = self.set.violation(id).abs() / self.set.data.scale(id);
        Error::Inaccurate { source_of_row, violation, names: Names::default() }
    }

    fn read_out(&mut self, status: Status) {
        let data = &self.set.data;
        self.solution.status = status;
        self.solution.iterations = self.set.iterations;
        for (i, (to, &from)) in self.solution.x.iter_mut().zip(&self.set.x).enumerate() {
            *to = from.clamp(data.lower[i], data.upper[i]);
        }
    }
}
