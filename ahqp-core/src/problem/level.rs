//! Priority levels: their objectives and hard constraints.

use std::sync::Arc;

use nalgebra::{DMatrix, DVector};

use crate::error::Error;
use crate::linalg::vector::dot;
use crate::problem::ids::LevelId;
use crate::problem::matrix::CoefficientMatrix;
use crate::problem::rows::{Rows, Values, expect_size};
use crate::problem::source::{ConstraintSource, Names};

/// Objective of a level.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Objective {
    /// No objective. The level only adds constraints.
    None,
    /// ½ Σ wᵢ (distance of row i of `A x` to its range)² with the [weights](Rows::set_weights) wᵢ,
    /// which are 1 unless they are set. If the bounds are equal, this is ½‖A x − b‖² (the paper's
    /// eq. 1).
    LeastSquares(Rows),
    /// ½ xᵀHx + gᵀx with a symmetric positive semidefinite H (the form of the paper's Sec. III-B).
    Quadratic {
        /// H, n × n.
        hessian: DMatrix<f64>,
        /// g, of size n.
        gradient: DVector<f64>,
    },
}

impl Objective {
    fn kind(&self) -> &'static str {
        match self {
            Self::None => "nothing",
            Self::LeastSquares(_) => "rows",
            Self::Quadratic { .. } => "a quadratic",
        }
    }
}

/// One priority level: an objective, and hard constraints that hold from this level down.
///
/// ```
/// use ahqp_core::{Level, Rows};
/// use nalgebra::{dmatrix, dvector};
///
/// let level = Level::least_squares(Rows::equalities(&dmatrix![1.0, 1.0], &dvector![2.0])?)
///     .with_constraints(Rows::ranges(&dmatrix![1.0, 0.0], &dvector![0.0], &dvector![0.5])?)
///     .named("reach");
/// assert_eq!(level.constraints().len(), 1);
/// assert_eq!(level.name(), Some("reach"));
/// assert_eq!(level.violation(&[0.5, 0.5])?, 1.0);
/// # Ok::<(), ahqp_core::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Level {
    objective: Objective,
    constraints: Rows,
    name: Option<Arc<str>>,
}

impl Level {
    /// Creates a level that minimises the violation of `rows` in the least-squares sense.
    pub fn least_squares(rows: Rows) -> Self {
        let constraints = Rows::zeros(0, rows.columns());
        Self { objective: Objective::LeastSquares(rows), constraints, name: None }
    }

    /// Creates a level that minimises ½ xᵀHx + gᵀx, with H of size n × n and g of size n.
    ///
    /// ```
    /// use ahqp_core::{Level, Objective};
    /// use nalgebra::{dmatrix, dvector};
    ///
    /// let level = Level::quadratic(&dmatrix![2.0, 0.0; 0.0, 2.0], &dvector![-1.0, 0.0])?;
    /// assert!(matches!(level.objective(), Objective::Quadratic { .. }));
    /// # Ok::<(), ahqp_core::Error>(())
    /// ```
    ///
    /// Each solve checks that H is symmetric and positive semidefinite, since it may be rewritten
    /// between solves.
    ///
    /// # Errors
    /// [`Error::Size`] if H is not square or g does not fit it.
    pub fn quadratic<'a>(
        hessian: &impl CoefficientMatrix,
        gradient: impl Values<'a>,
    ) -> Result<Self, Error> {
        let (n, gradient) = (hessian.nrows(), gradient.into_iter().copied());
        expect_size("the columns of the Hessian", hessian.ncols(), n)?;
        expect_size("the gradient", gradient.len(), n)?;
        let hessian = DMatrix::from_fn(n, n, |row, column| hessian.entry(row, column));
        let gradient = DVector::from_iterator(n, gradient);
        let constraints = Rows::zeros(0, n);
        Ok(Self { objective: Objective::Quadratic { hessian, gradient }, constraints, name: None })
    }

    /// Creates a level that only adds hard constraints.
    pub fn constraints_only(rows: Rows) -> Self {
        Self { objective: Objective::None, constraints: rows, name: None }
    }

    /// Sets the hard constraints of the level.
    #[must_use]
    pub fn with_constraints(mut self, rows: Rows) -> Self {
        self.constraints = rows;
        self
    }

    /// Names the level, for errors and conflicts.
    #[must_use]
    pub fn named(mut self, name: impl Into<Arc<str>>) -> Self {
        self.name = Some(name.into());
        self
    }

    /// Name of the level, if it has one.
    pub fn name(&self) -> Option<&str> {
        self.name.as_deref()
    }

    pub(crate) fn shared_name(&self) -> Option<&Arc<str>> {
        self.name.as_ref()
    }

    /// Objective of the level.
    pub fn objective(&self) -> &Objective {
        &self.objective
    }

    /// Hard constraints that hold from this level down.
    pub fn constraints(&self) -> &Rows {
        &self.constraints
    }

    /// Hard constraints, to rewrite in place (not to resize).
    pub fn constraints_mut(&mut self) -> &mut Rows {
        &mut self.constraints
    }

    /// Rows of a least-squares objective, to rewrite in place (not to resize).
    ///
    /// # Errors
    /// [`Error::OtherObjective`] if the level minimises a quadratic, or nothing.
    pub fn rows_mut(&mut self) -> Result<&mut Rows, Error> {
        let (found, name) = (self.objective.kind(), self.name.as_ref());
        match &mut self.objective {
            Objective::LeastSquares(rows) => Ok(rows),
            _ => Err(other_objective("rows", found, name)),
        }
    }

    /// Hessian and gradient of a quadratic objective, to rewrite in place (not to resize).
    ///
    /// # Errors
    /// [`Error::OtherObjective`] if the level minimises rows, or nothing.
    pub fn quadratic_mut(&mut self) -> Result<(&mut DMatrix<f64>, &mut DVector<f64>), Error> {
        let (found, name) = (self.objective.kind(), self.name.as_ref());
        match &mut self.objective {
            Objective::Quadratic { hessian, gradient } => Ok((hessian, gradient)),
            _ => Err(other_objective("a quadratic", found, name)),
        }
    }

    /// Returns √(Σ wᵢ dᵢ²) of a least-squares objective at `x`. dᵢ is the distance of row i to its
    /// range and wᵢ its weight. Zero for other kinds of objective. Allocates nothing.
    ///
    /// # Errors
    /// [`Error::Size`] if x does not fit the rows.
    pub fn violation(&self, x: &[f64]) -> Result<f64, Error> {
        let Objective::LeastSquares(rows) = &self.objective else { return Ok(0.0) };
        expect_size("x", x.len(), rows.columns())?;
        let squares = rows.iter().enumerate().map(|(index, (row, lower, upper))| {
            let value = dot(row, x);
            let distance = (lower - value).max(value - upper).max(0.0);
            rows.weight(index) * distance * distance
        });
        Ok(squares.sum::<f64>().sqrt())
    }

    pub(crate) fn expect_columns(&self, variables: usize) -> Result<(), Error> {
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

fn other_objective(wanted: &'static str, got: &'static str, name: Option<&Arc<str>>) -> Error {
    let names = Names { level: name.cloned(), row: None };
    Error::OtherObjective { level: None, got, wanted, names }
}

/// Adds the level to an error about an objective.
pub(crate) fn of_level<T>(level: LevelId, result: Result<T, Error>) -> Result<T, Error> {
    result.map_err(|error| match error {
        Error::OtherObjective { got, wanted, names, .. } => {
            Error::OtherObjective { level: Some(level), got, wanted, names }
        }
        other => other,
    })
}

/// Returns the names of a row of `level`, or of the bounds of one of the `variables`.
pub(crate) fn names_of(
    source: ConstraintSource,
    level: Option<&Level>,
    variables: &[Arc<str>],
) -> Names {
    let row = match source {
        ConstraintSource::Bound { variable } => variables.get(variable).cloned(),
        ConstraintSource::Constraint { row, .. } => {
            level.and_then(|level| level.constraints().names().get(row).cloned())
        }
        ConstraintSource::Objective { row, .. } => match level.map(Level::objective) {
            Some(Objective::LeastSquares(rows)) => rows.names().get(row).cloned(),
            _ => None,
        },
    };
    Names { row, level: level.and_then(|level| level.shared_name().cloned()) }
}
