//! One level as a Clarabel problem in the free directions.

use clarabel::algebra::CscMatrix;
use clarabel::solver::{
    DefaultSettings, DefaultSolution, DefaultSolver, IPSolver, SolverStatus,
    SupportedConeT::{NonnegativeConeT, ZeroConeT},
};
use nalgebra::{DMatrix, DVector};

use super::{AT_BOUND, Cascade, span};
use crate::error::Error;
use crate::problem::rows::Rows;

/// A multiplier counts when it exceeds this fraction of the level's forces \[-\].
const NEEDED: f64 = 1e-6;

/// The least violation that tolerances are relative to, in units of its rounding \[-\].
const SMALLEST_UNIT: f64 = 1e6;
/// Tolerance and regularisation of Clarabel, tried one after the other where it fails.
const ATTEMPTS: [(f64, f64); 5] =
    [(1e-12, 1e-9), (1e-12, 1e-8), (1e-12, 1e-11), (1e-10, 1e-7), (1e-8, 1e-7)];

/// An optimum of one level.
#[derive(Clone)]
pub(super) struct Optimum {
    pub(super) x: DVector<f64>,
    /// Which held inequalities have a multiplier: they are active at every optimum.
    pub(super) needed: Vec<bool>,
    /// Which held inequalities lie at their bound.
    pub(super) active: Vec<bool>,
}

/// Minimise ½‖w‖² + linearᵀy with lower ≤ B y − w ≤ upper and G y ≤ h; x = origin + basis y.
pub(super) struct QuadraticProblem<'a> {
    pub(super) origin: DVector<f64>,
    pub(super) basis: &'a DMatrix<f64>,
    pub(super) b: DMatrix<f64>,
    pub(super) lower: DVector<f64>,
    pub(super) upper: DVector<f64>,
    pub(super) linear: DVector<f64>,
    pub(super) g: DMatrix<f64>,
    pub(super) h: DVector<f64>,
    /// Violations of this size are rounding.
    pub(super) rounding: f64,
}

impl<'a> QuadraticProblem<'a> {
    pub(super) fn new(
        cascade: &'a Cascade,
        origin: DVector<f64>,
        rows: &Rows,
        linear: &DVector<f64>,
    ) -> Self {
        let basis = &cascade.free;
        let matrix = DMatrix::from_row_iterator(
            rows.len(),
            rows.columns(),
            rows.iter().flat_map(|(a, ..)| a.iter().copied()),
        );
        let mut b = &matrix * basis;
        for (i, mut row) in b.row_iter_mut().enumerate() {
            if row.norm() <= span::DEPENDENT * matrix.row(i).norm() {
                row.fill(0.0);
            }
        }
        let finite = |bound: &&f64| bound.is_finite();
        let bounds = rows.lower().iter().chain(rows.upper()).filter(finite);
        let largest = bounds.fold(matrix.amax() * origin.amax(), |l, b| f64::max(l, b.abs()));
        let values = matrix * &origin;
        let (g, h) = reduced_inequalities(cascade, &origin);
        Self {
            lower: DVector::from_column_slice(rows.lower()) - &values,
            upper: DVector::from_column_slice(rows.upper()) - values,
            linear: basis.tr_mul(linear),
            rounding: 1e-13 * largest,
            origin,
            basis,
            b,
            g,
            h,
        }
    }

    /// B y minus the nearest point of its range, row by row.
    pub(super) fn violations(&self, y: &DVector<f64>) -> DVector<f64> {
        let mut values = &self.b * y;
        for (i, value) in values.iter_mut().enumerate() {
            *value -= value.clamp(self.lower[i], self.upper[i]);
        }
        values
    }

    pub(super) fn is_equality(&self, row: usize) -> bool {
        self.lower[row] == self.upper[row]
    }

    pub(super) fn value(&self, y: &DVector<f64>) -> f64 {
        0.5 * self.violations(y).norm_squared() + self.linear.dot(y)
    }

    /// ‖violation‖ at x.
    pub(super) fn violation(&self, x: &DVector<f64>) -> f64 {
        self.violations(&self.coordinates(x)).norm()
    }

    /// y of x.
    pub(super) fn coordinates(&self, x: &DVector<f64>) -> DVector<f64> {
        self.basis.tr_mul(&(x - &self.origin))
    }

    /// x of y.
    pub(super) fn point(&self, y: &DVector<f64>) -> DVector<f64> {
        &self.origin + self.basis * y
    }

    /// An optimum, to tolerances relative to the violation at the origin.
    pub(super) fn solve(&self, level: usize) -> Result<Optimum, Error> {
        let (k, m, held) = (self.basis.ncols(), self.b.nrows(), self.h.len());
        let unit = self.violation(&self.origin);
        if k == 0 || (unit <= self.rounding && self.linear.norm() == 0.0) {
            let none = vec![false; held];
            return Ok(Optimum { x: self.origin.clone(), needed: none.clone(), active: none });
        }
        // The level's largest row gets norm one, and the violation at the origin size one.
        let scale = self.b.row_iter().map(|row| row.norm()).fold(0.0, f64::max);
        let scale = if scale > 0.0 { 1.0 / scale } else { 1.0 };
        let unit = unit.max(SMALLEST_UNIT * self.rounding) * scale;
        let unit = if unit > 0.0 { unit } else { 1.0 };
        let mut quadratic = DMatrix::zeros(k + m, k + m);
        let mut linear = DVector::zeros(k + m);
        linear.rows_mut(0, k).copy_from(&(&self.linear * (scale * scale / unit)));
        let mut conditions = Conditions::default();
        for i in 0..m {
            quadratic[(k + i, k + i)] = 1.0;
            let mut row = DVector::zeros(k + m);
            row.rows_mut(0, k).copy_from(&(self.b.row(i).transpose() * scale));
            row[k + i] = -1.0;
            conditions.range(&row, self.lower[i] * scale / unit, self.upper[i] * scale / unit);
        }
        let first = conditions.inequalities.len();
        for i in 0..held {
            let row = self.g.row(i).transpose().resize_vertically(k + m, 0.0);
            conditions.inequalities.push((row, self.h[i] / unit));
        }

        let solution = conditions.minimise(&quadratic, &linear, level)?;
        let values = DVector::from_column_slice(&solution.x);
        let y = values.rows(0, k) * unit;
        let w = values.rows(k, m);
        let forces = w.norm() + linear.norm();
        let least = NEEDED * (forces + 1e-2);
        let at = conditions.equalities.len() + first;
        let (z, s) = (&solution.z[at..], &solution.s[at..]);
        Ok(Optimum {
            x: self.point(&y),
            needed: (0..held).map(|i| z[i] > least && z[i] > s[i]).collect(),
            active: (0..held).map(|i| z[i] > s[i] || s[i] * unit < AT_BOUND).collect(),
        })
    }
}

/// Held inequalities that are active at every point that keeps all of them.
///
/// Among those at their bounds: maximise Σ tᵢ with gᵢ y + tᵢ ≤ 0 and −1 ≤ tᵢ ≤ 1. A row that
/// can be slack reaches t = 1, since y may be scaled; of the others at least one does not.
pub(super) fn never_slack(cascade: &Cascade) -> Result<Vec<usize>, Error> {
    let (g, h) = reduced_inequalities(cascade, &cascade.x);
    let k = cascade.free.ncols();
    let candidates: Vec<usize> = (0..h.len()).filter(|&i| h[i] < AT_BOUND).collect();
    let count = candidates.len();
    if k == 0 || count < 2 {
        return Ok(Vec::new());
    }
    let mut conditions = Conditions::default();
    let mut linear = DVector::zeros(k + count);
    for (position, &i) in candidates.iter().enumerate() {
        let mut row = g.row(i).transpose().resize_vertically(k + count, 0.0);
        row[k + position] = 1.0;
        conditions.inequalities.push((row, 0.0));
        let mut unit = DVector::zeros(k + count);
        unit[k + position] = 1.0;
        conditions.range(&unit, -1.0, 1.0);
        linear[k + position] = -1.0;
    }
    let none = DMatrix::zeros(k + count, k + count);
    let solution = conditions.minimise(&none, &linear, cascade.level)?;
    let stuck = candidates.iter().enumerate().filter(|(p, _)| solution.x[k + p] < 0.5);
    Ok(stuck.map(|(_, &i)| i).collect())
}

/// G y ≤ h with rows of unit norm.
fn reduced_inequalities(cascade: &Cascade, origin: &DVector<f64>) -> (DMatrix<f64>, DVector<f64>) {
    let count = cascade.inequalities.len();
    let mut g = DMatrix::zeros(count, cascade.free.ncols());
    let mut h = DVector::zeros(count);
    for (i, inequality) in cascade.inequalities.iter().enumerate() {
        let row = cascade.free.tr_mul(&inequality.a);
        let norm = row.norm();
        g.row_mut(i).copy_from(&(row.transpose() / norm));
        h[i] = (inequality.b - inequality.a.dot(origin)).max(0.0) / norm;
    }
    (g, h)
}

/// Conditions of a Clarabel problem: a v = b, and a v ≤ b.
#[derive(Default)]
struct Conditions {
    equalities: Vec<(DVector<f64>, f64)>,
    inequalities: Vec<(DVector<f64>, f64)>,
}

impl Conditions {
    fn range(&mut self, row: &DVector<f64>, lower: f64, upper: f64) {
        if lower == upper {
            self.equalities.push((row.clone(), lower));
            return;
        }
        if upper.is_finite() {
            self.inequalities.push((row.clone(), upper));
        }
        if lower.is_finite() {
            self.inequalities.push((-row, -lower));
        }
    }

    /// The minimum of ½vᵀPv + qᵀv; tried again with coarser tolerances where Clarabel fails.
    fn minimise(
        &self,
        p: &DMatrix<f64>,
        q: &DVector<f64>,
        level: usize,
    ) -> Result<DefaultSolution<f64>, Error> {
        let rows: Vec<_> = self.equalities.iter().chain(&self.inequalities).collect();
        let matrix = sparse(&DMatrix::from_fn(rows.len(), q.len(), |i, j| rows[i].0[j]));
        let bounds: Vec<f64> = rows.iter().map(|(_, b)| *b).collect();
        let cones = [ZeroConeT(self.equalities.len()), NonnegativeConeT(self.inequalities.len())];
        let mut status = String::new();
        for (tolerance, regularisation) in ATTEMPTS {
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
                DefaultSolver::new(&sparse(p), q.as_slice(), &matrix, &bounds, &cones, settings)
                    .map_err(|error| Error::Reference { level, status: error.to_string() })?;
            solver.solve();
            let solution = solver.solution;
            let gap = (solution.obj_val - solution.obj_val_dual).abs();
            let close = solution.r_prim.max(solution.r_dual).max(gap) < 1e-8;
            match solution.status {
                SolverStatus::Solved | SolverStatus::AlmostSolved => return Ok(solution),
                SolverStatus::InsufficientProgress | SolverStatus::NumericalError if close => {
                    return Ok(solution);
                }
                other => status = format!("{other:?}"),
            }
        }
        Err(Error::Reference { level, status })
    }
}

fn sparse(matrix: &DMatrix<f64>) -> CscMatrix<f64> {
    let (rows, columns) = matrix.shape();
    let mut pointers = vec![0];
    let (mut indices, mut values) = (Vec::new(), Vec::new());
    for column in matrix.column_iter() {
        for (i, &value) in column.iter().enumerate() {
            if value != 0.0 {
                indices.push(i);
                values.push(value);
            }
        }
        pointers.push(indices.len());
    }
    CscMatrix::new(rows, columns, pointers, indices, values)
}
