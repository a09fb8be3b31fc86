//! Problems: levels of objectives and constraints in order of priority.

use std::fmt;
use std::sync::Arc;

use nalgebra::{DMatrix, DVector};

use crate::error::{Error, Spot};
use crate::problem::ids::LevelId;
use crate::problem::level::{Level, names_of, of_level};
use crate::problem::rows::{Rows, Values, collect_names, expect_size, write};
use crate::problem::source::{ConstraintSource, Names};

/// A hierarchical quadratic program over n variables.
///
/// The levels' objectives are minimised lexicographically, highest priority first. The bounds of
/// the variables hold. At each level its hard constraints and those of all levels above hold too.
/// What no level determines takes the least norm.
///
/// ```
/// use ahqp_core::{Hierarchy, Level, Rows, Settings, Solver};
/// use nalgebra::{dmatrix, dvector};
///
/// // First x + y = 2, then x as near to 5 as the bounds allow.
/// let mut hierarchy = Hierarchy::new(2)?;
/// hierarchy.set_bounds(&dvector![-1.0, -1.0], &dvector![1.5, 9.0])?;
/// hierarchy.push(Level::least_squares(Rows::equalities(&dmatrix![1.0, 1.0], &dvector![2.0])?))?;
/// let near = Rows::equalities(&dmatrix![1.0, 0.0], &dvector![5.0])?;
/// let near = hierarchy.push(Level::least_squares(near).named("near"))?;
///
/// let mut solver = Solver::new(&hierarchy, Settings::default())?;
/// let x = solver.solve(&hierarchy)?.optimum()?;
/// assert!((x[0] - 1.5).abs() < 1e-12 && (x[1] - 0.5).abs() < 1e-12);
///
/// // The next tick: other data, the same solver.
/// hierarchy.rows_mut(near)?.set_targets(&[-5.0])?;
/// let x = solver.solve(&hierarchy)?.optimum()?;
/// assert!((x[0] + 1.0).abs() < 1e-12 && (x[1] - 3.0).abs() < 1e-12);
/// # Ok::<(), ahqp_core::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Hierarchy {
    lower: Vec<f64>,
    upper: Vec<f64>,
    levels: Vec<Level>,
    /// Names of all variables, or empty.
    variable_names: Vec<Arc<str>>,
}

/// Beginning of the message about a hierarchy without variables.
const NO_VARIABLES: &str = "the hierarchy has no variables: their number";

impl Hierarchy {
    /// Creates a hierarchy over `variables` unbounded variables, without levels.
    ///
    /// # Errors
    /// [`Error::Value`] if `variables` is zero.
    pub fn new(variables: usize) -> Result<Self, Error> {
        if variables == 0 {
            return Err(Error::value(NO_VARIABLES, 0.0, "at least 1"));
        }
        Ok(Self {
            lower: vec![f64::NEG_INFINITY; variables],
            upper: vec![f64::INFINITY; variables],
            levels: Vec::new(),
            variable_names: Vec::new(),
        })
    }

    /// The number n of variables.
    pub fn variables(&self) -> usize {
        self.lower.len()
    }

    /// Names every variable, for errors and conflicts.
    ///
    /// # Errors
    /// [`Error::Size`] unless there are n names.
    pub fn name_variables<T: Into<Arc<str>>>(
        &mut self,
        names: impl IntoIterator<Item = T>,
    ) -> Result<(), Error> {
        self.variable_names = collect_names("the names of the variables", names, self.variables())?;
        Ok(())
    }

    /// Names of the variables, empty if they have none.
    pub fn variable_names(&self) -> &[Arc<str>] {
        &self.variable_names
    }

    /// Adds a level below all others and returns its id.
    ///
    /// # Errors
    /// [`Error::Size`] if its rows do not cover the variables.
    pub fn push(&mut self, level: Level) -> Result<LevelId, Error> {
        level.expect_columns(self.variables())?;
        self.levels.push(level);
        Ok(LevelId::new(self.levels.len() - 1))
    }

    /// The levels, highest priority first.
    pub fn levels(&self) -> &[Level] {
        &self.levels
    }

    /// The ids of the levels, highest priority first.
    pub fn ids(&self) -> impl Iterator<Item = LevelId> + use<> {
        (0..self.levels.len()).map(LevelId::new)
    }

    /// Level `id`.
    ///
    /// # Errors
    /// [`Error::NoSuchLevel`] if the id is that of another hierarchy with more levels.
    pub fn level(&self, id: LevelId) -> Result<&Level, Error> {
        self.levels.get(id.index()).ok_or(Error::NoSuchLevel { level: id })
    }

    /// Level `id`, to rewrite its data in place.
    ///
    /// # Errors
    /// Those of [`level`](Self::level).
    pub fn level_mut(&mut self, id: LevelId) -> Result<&mut Level, Error> {
        self.levels.get_mut(id.index()).ok_or(Error::NoSuchLevel { level: id })
    }

    /// The rows that level `id` minimises, to rewrite in place (not to resize).
    ///
    /// # Errors
    /// [`Error::OtherObjective`] if the level minimises a quadratic, or nothing.
    /// [`Error::NoSuchLevel`] as in [`level`](Self::level).
    pub fn rows_mut(&mut self, id: LevelId) -> Result<&mut Rows, Error> {
        of_level(id, self.level_mut(id)?.rows_mut())
    }

    /// The hard constraints of level `id`, to rewrite in place (not to resize).
    ///
    /// # Errors
    /// Those of [`level`](Self::level).
    pub fn constraints_mut(&mut self, id: LevelId) -> Result<&mut Rows, Error> {
        Ok(self.level_mut(id)?.constraints_mut())
    }

    /// The Hessian and gradient that level `id` minimises, to rewrite in place (not to resize).
    ///
    /// # Errors
    /// [`Error::OtherObjective`] if the level minimises rows, or nothing. [`Error::NoSuchLevel`] as
    /// in [`level`](Self::level).
    pub fn quadratic_mut(
        &mut self,
        id: LevelId,
    ) -> Result<(&mut DMatrix<f64>, &mut DVector<f64>), Error> {
        of_level(id, self.level_mut(id)?.quadratic_mut())
    }

    /// Describes a row in words, with the names of its level, row or variable.
    ///
    /// ```
    /// use ahqp_core::{Error, Hierarchy, Level, Rows, Settings, Solver};
    /// use nalgebra::dmatrix;
    ///
    /// let mut hierarchy = Hierarchy::new(1)?;
    /// hierarchy.set_bounds(&[0.0], &[1.0])?;
    /// hierarchy.name_variables(["elbow"])?;
    /// let rows = Rows::at_least(&dmatrix![1.0], &[2.0])?.with_names(["raised"])?;
    /// hierarchy.push(Level::constraints_only(rows).named("posture"))?;
    ///
    /// let mut solver = Solver::new(&hierarchy, Settings::default())?;
    /// assert!(matches!(solver.solve(&hierarchy), Err(Error::Infeasible { .. })));
    /// let conflict = solver.conflict().iter().map(|&row| hierarchy.describe(row).to_string());
    /// assert_eq!(conflict.collect::<Vec<_>>(), [
    ///     "constraint row 0 \"raised\" of level 0 \"posture\"",
    ///     "the bounds of variable 0 \"elbow\"",
    /// ]);
    /// # Ok::<(), Error>(())
    /// ```
    pub fn describe(&self, row: ConstraintSource) -> impl fmt::Display + use<> {
        self.names(row).label(row)
    }

    pub(crate) fn names(&self, row: ConstraintSource) -> Names {
        let level = row.level().and_then(|id| self.level(id).ok());
        names_of(row, level, &self.variable_names)
    }

    /// Adds the names of this hierarchy to an error.
    pub(crate) fn named(&self, mut error: Error) -> Error {
        match error.spot_mut() {
            Some(Spot::Row(row, names)) => *names = self.names(row),
            Some(Spot::Level(level, names)) => {
                let level = self.level(level).ok();
                names.level = level.and_then(|level| level.shared_name().cloned());
            }
            None => {}
        }
        error
    }

    /// Lower bounds of the variables. Negative infinity stands for none.
    pub fn lower(&self) -> &[f64] {
        &self.lower
    }

    /// Upper bounds of the variables. Infinity stands for none.
    pub fn upper(&self) -> &[f64] {
        &self.upper
    }

    /// The bounds of the variables, to rewrite in place: `(lower, upper)`.
    pub fn bounds_mut(&mut self) -> (&mut [f64], &mut [f64]) {
        (&mut self.lower, &mut self.upper)
    }

    /// Sets the bounds of all variables, which hold at every level.
    ///
    /// # Errors
    /// [`Error::Size`] unless both have n entries.
    pub fn set_bounds<'a>(
        &mut self,
        lower: impl Values<'a>,
        upper: impl Values<'a>,
    ) -> Result<(), Error> {
        let (lower, upper) = (lower.into_iter(), upper.into_iter());
        expect_size("the lower bound of the variables", lower.len(), self.variables())?;
        expect_size("the upper bound of the variables", upper.len(), self.variables())?;
        write(&mut self.lower, lower);
        write(&mut self.upper, upper);
        Ok(())
    }
}
