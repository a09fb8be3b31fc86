//! The problem: levels of objectives and constraints in order of priority.

use std::fmt;

use nalgebra::{DMatrix, DVector, Dim, Matrix, RawStorage};

use crate::Error;
use crate::problem::rows::{Rows, expect_size};

/// What a level minimises.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Objective {
    /// Nothing: the level only adds constraints.
    None,
    /// ½ Σ (distance of a row of `A x` to its range)²; with equal bounds ½‖A x − b‖²
    /// (the paper's eq. 1).
    LeastSquares(Rows),
    /// ½ xᵀHx + gᵀx with H symmetric positive semidefinite (the form of the paper's Sec. III-B).
    Quadratic {
        /// H, n × n.
        hessian: DMatrix<f64>,
        /// g, of size n.
        gradient: DVector<f64>,
    },
}

/// One priority level: an objective, and hard constraints that hold from this level down.
///
/// ```
/// use ahqp_core::{Level, Rows};
/// use nalgebra::{dmatrix, dvector};
///
/// let level = Level::least_squares(Rows::equalities(&dmatrix![1.0, 1.0], &dvector![2.0])?)
///     .with_constraints(Rows::ranges(&dmatrix![1.0, 0.0], &dvector![0.0], &dvector![0.5])?);
/// assert_eq!(level.constraints().len(), 1);
/// # Ok::<(), ahqp_core::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Level {
    objective: Objective,
    constraints: Rows,
}

impl Level {
    /// A level that minimises the violation of `rows` in the least-squares sense.
    pub fn least_squares(rows: Rows) -> Self {
        let columns = rows.columns();
        Self { objective: Objective::LeastSquares(rows), constraints: Rows::zeros(0, columns) }
    }

    /// A level that minimises ½ xᵀHx + gᵀx, H of size n × n, g of size n.
    ///
    /// Whether H is symmetric and positive semidefinite is checked at each solve, since it may
    /// be rewritten between two of them.
    ///
    /// # Errors
    /// [`Error::Size`] when H is not square or g does not fit it.
    pub fn quadratic(hessian: DMatrix<f64>, gradient: DVector<f64>) -> Result<Self, Error> {
        expect_size("the columns of the Hessian", hessian.ncols(), hessian.nrows())?;
        expect_size("the gradient", gradient.len(), hessian.nrows())?;
        let columns = gradient.len();
        Ok(Self {
            objective: Objective::Quadratic { hessian, gradient },
            constraints: Rows::zeros(0, columns),
        })
    }

    /// A level that only adds hard constraints.
    pub fn constraints_only(rows: Rows) -> Self {
        Self { objective: Objective::None, constraints: rows }
    }

    /// The same level with `rows` as its hard constraints.
    #[must_use]
    pub fn with_constraints(mut self, rows: Rows) -> Self {
        self.constraints = rows;
        self
    }

    /// What the level minimises.
    pub fn objective(&self) -> &Objective {
        &self.objective
    }

    /// What must hold from this level down.
    pub fn constraints(&self) -> &Rows {
        &self.constraints
    }

    /// The hard constraints, to rewrite in place.
    pub fn constraints_mut(&mut self) -> &mut Rows {
        &mut self.constraints
    }

    /// The rows of a least-squares objective, to rewrite in place.
    pub fn least_squares_mut(&mut self) -> Option<&mut Rows> {
        match &mut self.objective {
            Objective::LeastSquares(rows) => Some(rows),
            Objective::None | Objective::Quadratic { .. } => None,
        }
    }

    /// Hessian and gradient of a quadratic objective, to rewrite in place (not to resize).
    pub fn quadratic_mut(&mut self) -> Option<(&mut DMatrix<f64>, &mut DVector<f64>)> {
        match &mut self.objective {
            Objective::Quadratic { hessian, gradient } => Some((hessian, gradient)),
            Objective::None | Objective::LeastSquares(_) => None,
        }
    }

    fn expect_columns(&self, variables: usize) -> Result<(), Error> {
        match &self.objective {
            Objective::None => {}
            Objective::LeastSquares(rows) => {
                expect_size("a row of the objective", rows.columns(), variables)?;
            }
            Objective::Quadratic { gradient, .. } => {
                expect_size("the gradient", gradient.len(), variables)?;
            }
        }
        expect_size("a row of the constraints", self.constraints.columns(), variables)
    }
}

/// A hierarchical quadratic programme over n variables.
///
/// Lexicographically minimise the levels' objectives, highest priority first,
/// subject to the bounds of the variables and, for each level, its own hard constraints and
/// those of all levels above it. What no level determines takes the least norm.
///
/// ```
/// use ahqp_core::{Hierarchy, Level, Rows, Settings, Solver};
/// use nalgebra::{dmatrix, dvector};
///
/// // First x + y = 2, then x as near to 5 as the bounds allow.
/// let mut hierarchy = Hierarchy::new(2)?;
/// hierarchy.set_bounds(&dvector![-1.0, -1.0], &dvector![1.5, 9.0])?;
/// hierarchy.push(Level::least_squares(Rows::equalities(&dmatrix![1.0, 1.0], &dvector![2.0])?))?;
/// hierarchy.push(Level::least_squares(Rows::equalities(&dmatrix![1.0, 0.0], &dvector![5.0])?))?;
///
/// let mut solver = Solver::new(&hierarchy, Settings::default())?;
/// let solution = solver.solve(&hierarchy)?;
/// assert!((solution.x()[0] - 1.5).abs() < 1e-12);
/// assert!((solution.x()[1] - 0.5).abs() < 1e-12);
/// # Ok::<(), ahqp_core::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Hierarchy {
    lower: Vec<f64>,
    upper: Vec<f64>,
    levels: Vec<Level>,
}

impl Hierarchy {
    /// An empty hierarchy over `variables` unbounded variables.
    ///
    /// # Errors
    /// [`Error::NoVariables`] for zero.
    pub fn new(variables: usize) -> Result<Self, Error> {
        if variables == 0 {
            return Err(Error::NoVariables);
        }
        Ok(Self {
            lower: vec![f64::NEG_INFINITY; variables],
            upper: vec![f64::INFINITY; variables],
            levels: Vec::new(),
        })
    }

    /// The number n of variables.
    pub fn variables(&self) -> usize {
        self.lower.len()
    }

    /// Adds a level below all present ones and returns its index.
    ///
    /// # Errors
    /// [`Error::Size`] when its rows do not cover the variables.
    pub fn push(&mut self, level: Level) -> Result<usize, Error> {
        level.expect_columns(self.variables())?;
        self.levels.push(level);
        Ok(self.levels.len() - 1)
    }

    /// The levels, highest priority first.
    pub fn levels(&self) -> &[Level] {
        &self.levels
    }

    /// Level `index`, to rewrite its data in place.
    ///
    /// # Errors
    /// [`Error::NoSuchLevel`] past the last.
    pub fn level_mut(&mut self, index: usize) -> Result<&mut Level, Error> {
        let levels = self.levels.len();
        self.levels.get_mut(index).ok_or(Error::NoSuchLevel { level: index, levels })
    }

    /// The lower bounds of the variables; negative infinity where there is none.
    pub fn lower(&self) -> &[f64] {
        &self.lower
    }

    /// The upper bounds of the variables; infinity where there is none.
    pub fn upper(&self) -> &[f64] {
        &self.upper
    }

    /// The bounds of the variables, to rewrite in place: `(lower, upper)`.
    pub fn bounds_mut(&mut self) -> (&mut [f64], &mut [f64]) {
        (&mut self.lower, &mut self.upper)
    }

    /// Sets the bounds of all variables; they hold at every level.
    ///
    /// # Errors
    /// [`Error::Size`] unless both have n entries.
    pub fn set_bounds<D: Dim, T, E: Dim, U>(
        &mut self,
        lower: &Matrix<f64, D, nalgebra::U1, T>,
        upper: &Matrix<f64, E, nalgebra::U1, U>,
    ) -> Result<(), Error>
    where
        T: RawStorage<f64, D, nalgebra::U1>,
        U: RawStorage<f64, E, nalgebra::U1>,
    {
        expect_size("the lower bound of the variables", lower.nrows(), self.variables())?;
        expect_size("the upper bound of the variables", upper.nrows(), self.variables())?;
        self.lower.iter_mut().zip(lower.iter()).for_each(|(to, from)| *to = *from);
        self.upper.iter_mut().zip(upper.iter()).for_each(|(to, from)| *to = *from);
        Ok(())
    }
}

impl Hierarchy {
    /// An error that names the first difference to `other` unless both hold the same numbers.
    pub(crate) fn expect_equal(&self, other: &Self) -> Result<(), Error> {
        let (levels, others) = (self.levels.len(), other.levels.len());
        if self.variables() != other.variables() || levels != others {
            return Err(Error::ShapeChanged { level: levels.min(others) });
        }
        let bounds = |hierarchy: &Self, i: usize| (hierarchy.lower[i], hierarchy.upper[i]);
        if let Some(variable) = (0..self.variables()).find(|&i| bounds(self, i) != bounds(other, i))
        {
            let source_of_row = ConstraintSource::Bound { variable };
            return Err(Error::DataChanged { source_of_row });
        }
        self.levels
            .iter()
            .zip(&other.levels)
            .enumerate()
            .try_for_each(|(index, (level, other))| level.expect_equal(other, index))
    }
}

impl Level {
    /// An error that names the first difference to `other` unless both hold the same numbers.
    fn expect_equal(&self, other: &Self, level: usize) -> Result<(), Error> {
        if let Some(row) = difference(&self.constraints, &other.constraints, level)? {
            let source_of_row = ConstraintSource::Constraint { level, row };
            return Err(Error::DataChanged { source_of_row });
        }
        let changed = match (&self.objective, &other.objective) {
            (Objective::None, Objective::None) => None,
            (Objective::LeastSquares(rows), Objective::LeastSquares(others)) => {
                difference(rows, others, level)?
            }
            (
                Objective::Quadratic { hessian: h, gradient: g },
                Objective::Quadratic { hessian: others_h, gradient: others_g },
            ) if h.shape() == others_h.shape() && g.len() == others_g.len() => {
                (0..g.len()).find(|&i| h.row(i) != others_h.row(i) || g[i] != others_g[i])
            }
            _ => return Err(Error::ShapeChanged { level }),
        };
        match changed {
            None => Ok(()),
            Some(row) => {
                let source_of_row = ConstraintSource::Objective { level, row };
                Err(Error::DataChanged { source_of_row })
            }
        }
    }
}

/// The first row that differs, of blocks of the same shape.
fn difference(rows: &Rows, others: &Rows, level: usize) -> Result<Option<usize>, Error> {
    if (rows.len(), rows.columns()) != (others.len(), others.columns()) {
        return Err(Error::ShapeChanged { level });
    }
    Ok(rows.iter().zip(others.iter()).position(|(row, other)| row != other))
}

/// Where a row of the problem comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[non_exhaustive]
pub enum ConstraintSource {
    /// The bounds of a variable.
    Bound {
        /// The variable.
        variable: usize,
    },
    /// A hard constraint of a level.
    Constraint {
        /// The level.
        level: usize,
        /// The row of its constraints.
        row: usize,
    },
    /// A row of a level's objective.
    Objective {
        /// The level.
        level: usize,
        /// The row of its objective.
        row: usize,
    },
}

impl fmt::Display for ConstraintSource {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Bound { variable } => write!(formatter, "the bounds of variable {variable}"),
            Self::Constraint { level, row } => {
                write!(formatter, "constraint row {row} of level {level}")
            }
            Self::Objective { level, row } => {
                write!(formatter, "objective row {row} of level {level}")
            }
        }
    }
}
