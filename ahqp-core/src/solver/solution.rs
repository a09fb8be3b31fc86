//! Result of a solve.

use crate::error::Error;
use crate::solver::status::Status;

/// Result of [`Solver::solve`](crate::Solver::solve), which owns it.
///
/// ```
/// use ahqp_core::{Budget, Error, Hierarchy, Level, Rows, Settings, Solver};
/// use nalgebra::{dmatrix, dvector};
///
/// let mut hierarchy = Hierarchy::new(2)?;
/// hierarchy.push(Level::least_squares(Rows::equalities(&dmatrix![1.0, 1.0], &dvector![2.0])?))?;
/// let mut solver = Solver::new(&hierarchy, Settings::default())?;
///
/// // What is not the optimum cannot pass for it; how far it came is there when asked for.
/// let solution = solver.solve_within(&hierarchy, Budget::iterations(1))?;
/// assert!(matches!(solution.optimum(), Err(Error::Unfinished { .. })));
/// assert_eq!(solution.best().len(), 2);
///
/// let x = solver.solve(&hierarchy)?.optimum()?;
/// assert!((x[0] - 1.0).abs() < 1e-12 && (x[1] - 1.0).abs() < 1e-12);
/// # Ok::<(), Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[must_use = "a solution may not be the optimum: take `optimum()`, or see `status()`"]
pub struct Solution {
    pub(crate) x: Vec<f64>,
    pub(crate) status: Status,
    pub(crate) iterations: usize,
}

impl Solution {
    /// Returns the variables at the optimum, of size n.
    ///
    /// # Errors
    /// [`Error::Unfinished`] unless the solve ended with [`Status::Solved`].
    pub fn optimum(&self) -> Result<&[f64], Error> {
        match self.status {
            Status::Solved => Ok(&self.x),
            status => Err(Error::Unfinished { status }),
        }
    }

    /// Returns the variables that the solve reached, of size n: the optimum, or the point that
    /// [`Status`] describes.
    pub fn best(&self) -> &[f64] {
        &self.x
    }

    /// Returns how the solve ended.
    pub fn status(&self) -> Status {
        self.status
    }

    /// Number of iterations: rounds of repair and steps of searches, over all levels.
    pub fn iterations(&self) -> usize {
        self.iterations
    }
}
