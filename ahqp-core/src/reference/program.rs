//! A convex program in the form that Clarabel solves.

use clarabel::algebra::CscMatrix;
use clarabel::solver::{
    DefaultSettings, DefaultSolution, DefaultSolver, IPSolver, SolverStatus,
    SupportedConeT::{NonnegativeConeT, ZeroConeT},
};

use crate::error::Error;

/// Tolerance and regularisation of Clarabel. Each pair is tried if the one before fails.
const ATTEMPTS: [(f64, f64); 5] =
    [(1e-12, 1e-9), (1e-12, 1e-8), (1e-12, 1e-11), (1e-10, 1e-7), (1e-8, 1e-7)];
/// Largest residuals and duality gap of a point that counts as a solution even if Clarabel stopped
/// before its tolerance \[-\].
const CLOSE: f64 = 1e-8;

/// The program: minimise ½ Σ pᵢvᵢ² + qᵀv over rows a v = b and a v ≤ b.
pub(super) struct Program {
    /// Diagonal p of the quadratic part.
    curvature: Vec<f64>,
    /// Linear part q.
    linear: Vec<f64>,
    equalities: Vec<(Vec<f64>, f64)>,
    inequalities: Vec<(Vec<f64>, f64)>,
}

/// Solution v, with slack and multiplier of each inequality.
pub(super) struct Optimum {
    pub(super) v: Vec<f64>,
    pub(super) slacks: Vec<f64>,
    pub(super) multipliers: Vec<f64>,
}

impl Program {
    pub(super) fn new(curvature: Vec<f64>, linear: Vec<f64>) -> Self {
        Self { curvature, linear, equalities: Vec::new(), inequalities: Vec::new() }
    }

    /// Adds `row` v ≤ `bound`, and returns the index of the inequality.
    pub(super) fn limit(&mut self, row: Vec<f64>, bound: f64) -> usize {
        self.inequalities.push((row, bound));
        self.inequalities.len() - 1
    }

    /// Adds `lower` ≤ `row` v ≤ `upper`.
    pub(super) fn range(&mut self, row: Vec<f64>, lower: f64, upper: f64) {
        if lower == upper {
            self.equalities.push((row, lower));
            return;
        }
        if lower.is_finite() {
            self.limit(row.iter().map(|entry| -entry).collect(), -lower);
        }
        if upper.is_finite() {
            self.limit(row, upper);
        }
    }

    /// Returns the minimum. Coarser tolerances are tried if Clarabel fails.
    pub(super) fn minimise(&self, level: usize) -> Result<Optimum, Error> {
        let mut status = String::new();
        for (tolerance, regularisation) in ATTEMPTS {
            let solution = self
                .attempt(tolerance, regularisation)
                .map_err(|status| Error::Reference { level, status })?;
            let gap = (solution.obj_val - solution.obj_val_dual).abs();
            let close = solution.r_prim.max(solution.r_dual).max(gap) < CLOSE;
            let solved = match solution.status {
                SolverStatus::Solved | SolverStatus::AlmostSolved => true,
                SolverStatus::InsufficientProgress | SolverStatus::NumericalError => close,
                _ => false,
            };
            if solved {
                let first = self.equalities.len();
                return Ok(Optimum {
                    v: solution.x,
                    slacks: solution.s[first..].to_vec(),
                    multipliers: solution.z[first..].to_vec(),
                });
            }
            status = format!("{:?}", solution.status);
        }
        Err(Error::Reference { level, status })
    }

    fn attempt(&self, tolerance: f64, regularisation: f64) -> Result<DefaultSolution<f64>, String> {
        let n = self.linear.len();
        let curvature = CscMatrix::new_from_triplets(
            n,
            n,
            (0..n).collect(),
            (0..n).collect(),
            self.curvature.clone(),
        );
        let rows = || self.equalities.iter().chain(&self.inequalities);
        let matrix = match rows().next() {
            Some(_) => CscMatrix::from(rows().map(|(row, _)| row)),
            None => CscMatrix::zeros((0, n)),
        };
        let bounds: Vec<f64> = rows().map(|(_, bound)| *bound).collect();
        let cones = [ZeroConeT(self.equalities.len()), NonnegativeConeT(self.inequalities.len())];
        let settings = DefaultSettings {
            verbose: false,
            tol_gap_abs: tolerance,
            tol_gap_rel: tolerance,
            tol_feas: tolerance,
            reduced_tol_gap_abs: tolerance,
            reduced_tol_gap_rel: tolerance,
            reduced_tol_feas: tolerance,
            // Degenerate levels need the last digits of every step.
            iterative_refinement_reltol: 1e-15,
            iterative_refinement_abstol: 1e-16,
            iterative_refinement_max_iter: 50,
            iterative_refinement_stop_ratio: 1.5,
            static_regularization_constant: regularisation,
            max_iter: 200,
            ..DefaultSettings::default()
        };
        let mut solver =
            DefaultSolver::new(&curvature, &self.linear, &matrix, &bounds, &cones, settings)
                .map_err(|error| error.to_string())?;
        solver.solve();
        Ok(solver.solution)
    }
}
