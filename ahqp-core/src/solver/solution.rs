//! What a solve returns.

/// How a solve ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Status {
    /// Every level is at its optimum.
    Solved,
    /// The iterations ran out within `level`: levels above it are at their optimum, all their
    /// constraints hold, and the levels from it down are as good as they got. The next warm solve
    /// goes on from there.
    IterationLimit {
        /// The level in which the iterations ran out; the number of levels stands for the choice of
        /// least norm behind the last, as in a [`Certificate`](crate::Certificate).
        level: usize,
    },
}

/// The answer of [`Solver::solve`](crate::Solver::solve); it lives in the solver.
#[derive(Debug, Clone, PartialEq)]
pub struct Solution {
    pub(crate) x: Vec<f64>,
    pub(crate) status: Status,
    pub(crate) iterations: usize,
    pub(crate) violations: Vec<f64>,
}

impl Solution {
    /// The variables, of size n.
    pub fn x(&self) -> &[f64] {
        &self.x
    }

    /// How the solve ended.
    pub fn status(&self) -> Status {
        self.status
    }

    /// Iterations spent: rounds of mending and steps of searches, over all levels.
    pub fn iterations(&self) -> usize {
        self.iterations
    }

    /// ‖violation‖₂ of each level's least-squares rows at x; zero for other kinds of level.
    pub fn violations(&self) -> &[f64] {
        &self.violations
    }
}
