//! Comparison of the two stacking methods along a sequence of problems.
//!
//! ```
//! use ahqp_core::nalgebra::DMatrix;
//! use ahqp_core::{Hierarchy, Level, Rows};
//! use hqp_problems::comparison::Comparison;
//!
//! let mut problem = Hierarchy::new(2)?;
//! let sum = DMatrix::from_row_slice(1, 2, &[1.0, 1.0]);
//! problem.push(Level::least_squares(Rows::equalities(&sum, &[2.0])?))?;
//! let mut comparison = Comparison::default();
//! let difference = comparison.add(&problem, &[1.0, 1.0])?;
//! assert!(difference < 1e-9 && comparison.result().compared == 1);
//! # Ok::<(), ahqp_core::Error>(())
//! ```

use std::fmt;
use std::time::{Duration, Instant};

use ahqp_core::{Error, Hierarchy, Settings, Solver, Stacking};
use serde::Serialize;

use crate::solving::Times;

/// Solves each problem of a sequence by both stacking methods.
#[derive(Debug, Default)]
pub struct Comparison {
    elimination: Method,
    equalities: Method,
    compared: usize,
    failed: usize,
    largest: f64,
}

/// A method with its times.
#[derive(Debug, Default)]
struct Method {
    solver: Option<Solver>,
    times: Vec<Duration>,
    iterations: usize,
}

impl Method {
    /// Solves, from the solution before if the shapes agree, and returns the optimum.
    fn solve(&mut self, hierarchy: &Hierarchy, stacking: Stacking) -> Result<&[f64], Error> {
        let settings = Settings { stacking, ..Settings::default() };
        let solver = match &mut self.solver {
            Some(solver) => solver,
            none => none.insert(Solver::new(hierarchy, settings)?),
        };
        let timed = |solver: &mut Solver| {
            let start = Instant::now();
            let ended = solver.solve(hierarchy).map(drop);
            (ended, start.elapsed())
        };
        let (mut ended, mut time) = timed(solver);
        if matches!(ended, Err(Error::ShapeChanged { .. })) {
            *solver = Solver::new(hierarchy, settings)?;
            (ended, time) = timed(solver);
        }
        ended?;
        let solution = solver.solution().ok_or(Error::NotSolved)?;
        self.times.push(time);
        self.iterations += solution.iterations();
        solution.optimum()
    }

    fn times(&self) -> Times {
        Times::new(&self.times, self.iterations)
    }
}

impl Comparison {
    /// Adds a problem and its optimum `x`, which elimination has found, and returns the largest
    /// difference of a variable from the optimum by stacked equalities.
    ///
    /// # Errors
    /// [`Error::Size`] for an `x` of another size. Errors of a method that does not solve
    /// the problem, which is then counted as failed.
    pub fn add(&mut self, hierarchy: &Hierarchy, x: &[f64]) -> Result<f64, Error> {
        let difference = self.difference(hierarchy, x);
        match &difference {
            Ok(difference) => {
                self.compared += 1;
                self.largest = self.largest.max(*difference);
            }
            Err(_) => self.failed += 1,
        }
        difference
    }

    fn difference(&mut self, hierarchy: &Hierarchy, x: &[f64]) -> Result<f64, Error> {
        let (what, got, wanted) = ("the optimum", x.len(), hierarchy.variables());
        if got != wanted {
            return Err(Error::Size { what, got, wanted });
        }
        // Only its time counts: it is the method that found x.
        self.elimination.solve(hierarchy, Stacking::Elimination)?;
        let other = self.equalities.solve(hierarchy, Stacking::Equalities)?;
        let differences = x.iter().zip(other).map(|(x, other)| (x - other).abs());
        Ok(differences.fold(0.0, f64::max))
    }

    /// The result so far.
    pub fn result(&self) -> Compared {
        Compared {
            compared: self.compared,
            failed: self.failed,
            largest_difference: self.largest,
            elimination: self.elimination.times(),
            equalities: self.equalities.times(),
        }
    }
}

/// Result of a comparison. `Display` prints it in three lines.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Compared {
    /// Number of problems that both methods solved.
    pub compared: usize,
    /// Number of problems that one of them did not solve.
    pub failed: usize,
    /// Largest difference of a variable of χ* \[-\].
    pub largest_difference: f64,
    /// Times by elimination.
    pub elimination: Times,
    /// Times by stacked equalities.
    pub equalities: Times,
}

impl fmt::Display for Compared {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { compared, failed, largest_difference, elimination, equalities } = self;
        write!(f, "stacking: {compared} problems by both methods, {failed} failed, ")?;
        writeln!(f, "largest difference of a variable {largest_difference:.1e}")?;
        writeln!(f, "  elimination: {elimination}")?;
        write!(f, "  equalities:  {equalities}")
    }
}
