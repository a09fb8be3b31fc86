//! One level as a program in the directions that the levels above leave free.

use nalgebra::{DMatrix, DVector};

use super::program::Program;
use super::row_space::row_norms;
use super::task::Task;
use super::{AT_BOUND, Cascade, DETERMINED};
use crate::error::Error;

/// A multiplier counts if it exceeds this fraction of the level's forces \[-\].
const NEEDED: f64 = 1e-6;
/// Smallest violation that tolerances are relative to, in units of its rounding \[-\].
const SMALLEST_UNIT: f64 = 1e6;

/// An optimum of one level.
#[derive(Clone)]
pub(super) struct LevelOptimum {
    pub(super) x: DVector<f64>,
    /// Inequalities with a nonzero multiplier, which are active at every optimum.
    pub(super) needed: Vec<bool>,
    /// Inequalities at their bound.
    pub(super) active: Vec<bool>,
}

/// The program: minimise ½‖w‖² + linearᵀy with lower ≤ B y − w ≤ upper and G y ≤ h, where x =
/// origin + Z y.
pub(super) struct LevelProgram<'a> {
    pub(super) origin: DVector<f64>,
    /// The basis Z.
    pub(super) nullspace: &'a DMatrix<f64>,
    pub(super) b: DMatrix<f64>,
    pub(super) lower: DVector<f64>,
    pub(super) upper: DVector<f64>,
    pub(super) linear: DVector<f64>,
    pub(super) g: DMatrix<f64>,
    pub(super) h: DVector<f64>,
    /// Violations of this size are rounding.
    pub(super) rounding: f64,
}

impl<'a> LevelProgram<'a> {
    pub(super) fn new(cascade: &'a Cascade, origin: DVector<f64>, task: &Task) -> Self {
        let nullspace = &cascade.nullspace;
        let matrix = &task.matrix;
        let mut b = matrix * nullspace;
        for (i, size) in row_norms(matrix).into_iter().enumerate() {
            if b.row(i).norm() <= DETERMINED * size {
                b.row_mut(i).fill(0.0);
            }
        }
        let values = matrix * &origin;
        let bounds = task.lower.iter().chain(task.upper.iter());
        let largest = bounds
            .filter(|bound| bound.is_finite())
            .fold(matrix.amax() * origin.amax(), |largest, b| largest.max(b.abs()));
        let (g, h) = cascade.reduced_inequalities(&origin);
        Self {
            lower: &task.lower - &values,
            upper: &task.upper - &values,
            linear: nullspace.transpose() * &task.linear,
            rounding: 1e-13 * largest,
            origin,
            nullspace,
            b,
            g,
            h,
        }
    }

    /// Returns B y minus the nearest point of its range, row by row.
    pub(super) fn violations(&self, y: &DVector<f64>) -> DVector<f64> {
        let values = &self.b * y;
        DVector::from_fn(values.nrows(), |i, _| {
            values[i] - values[i].clamp(self.lower[i], self.upper[i])
        })
    }

    pub(super) fn is_equality(&self, row: usize) -> bool {
        self.lower[row] == self.upper[row]
    }

    pub(super) fn value(&self, y: &DVector<f64>) -> f64 {
        0.5 * self.violations(y).norm_squared() + self.linear.dot(y)
    }

    /// Returns ‖violation‖ at x.
    pub(super) fn violation(&self, x: &DVector<f64>) -> f64 {
        self.violations(&self.coordinates(x)).norm()
    }

    /// Returns the y of x.
    pub(super) fn coordinates(&self, x: &DVector<f64>) -> DVector<f64> {
        self.nullspace.transpose() * (x - &self.origin)
    }

    /// Returns the x of y.
    pub(super) fn point(&self, y: &DVector<f64>) -> DVector<f64> {
        &self.origin + self.nullspace * y
    }

    /// Returns an optimum, to tolerances relative to the violation at the origin.
    pub(super) fn solve(&self, level: usize) -> Result<LevelOptimum, Error> {
        let (m, k) = self.b.shape();
        let held = self.h.nrows();
        let unit = self.violation(&self.origin);
        if k == 0 || (unit <= self.rounding && self.linear.norm() == 0.0) {
            let none = vec![false; held];
            let x = self.origin.clone();
            return Ok(LevelOptimum { x, needed: none.clone(), active: none });
        }
        // The level's largest row is scaled to norm one, and the violation at the origin to size
        // one.
        let scale = row_norms(&self.b).into_iter().fold(0.0, f64::max);
        let scale = if scale > 0.0 { 1.0 / scale } else { 1.0 };
        let unit = unit.max(SMALLEST_UNIT * self.rounding) * scale;
        let unit = if unit > 0.0 { unit } else { 1.0 };

        // The variables are y / unit and w.
        let mut linear: Vec<f64> = self.linear.iter().map(|l| l * scale * scale / unit).collect();
        let tilt = norm(&linear);
        linear.resize(k + m, 0.0);
        let curvature = (0..k + m).map(|i| if i < k { 0.0 } else { 1.0 }).collect();
        let mut program = Program::new(curvature, linear);
        for i in 0..m {
            let mut row: Vec<f64> = self.b.row(i).iter().map(|entry| entry * scale).collect();
            row.resize(k + m, 0.0);
            row[k + i] = -1.0;
            program.range(row, self.lower[i] * scale / unit, self.upper[i] * scale / unit);
        }
        let limits: Vec<usize> = (0..held)
            .map(|i| {
                let mut row: Vec<f64> = self.g.row(i).iter().copied().collect();
                row.resize(k + m, 0.0);
                program.limit(row, self.h[i] / unit)
            })
            .collect();

        let optimum = program.minimise(level)?;
        let (y, w) = optimum.v.split_at(k);
        let least = NEEDED * (norm(w) + tilt + 1e-2);
        let multiplier_and_slack =
            || limits.iter().map(|&at| (optimum.multipliers[at], optimum.slacks[at]));
        Ok(LevelOptimum {
            x: self.point(&DVector::from_fn(k, |i, _| y[i] * unit)),
            needed: multiplier_and_slack().map(|(z, s)| z > least && z > s).collect(),
            active: multiplier_and_slack().map(|(z, s)| z > s || s * unit < AT_BOUND).collect(),
        })
    }
}

fn norm(values: &[f64]) -> f64 {
    values.iter().map(|value| value * value).sum::<f64>().sqrt()
}
