//! Proof of lexicographic optimality, checked from the problem's data alone.
//!
//! At level k the rows above must balance the gradient of the objective. These are the bounds, the
//! hard rows of levels up to k, and the rows of the objectives above k, which are held. An
//! inequality may only push towards its inside. Its sign is decided at the first level at which its
//! multiplier is not zero (Escande, Mansard, Wieber, IJRR 33, 2014, Sec. 3).

mod multipliers;
mod of_solver;
mod refinement;
mod tolerances;

use std::collections::BTreeSet;

use nalgebra::DVector;

use crate::error::Error;
use crate::linalg::vector::{add_scaled, dot, norm, norm_max};
use crate::problem::hierarchy::Hierarchy;
use crate::problem::ids::LevelId;
use crate::problem::level::Objective;
use crate::problem::rows::Rows;
use crate::problem::source::ConstraintSource;
use crate::solver::data::ProblemData;
use tolerances::{MULTIPLIER, PRODUCT, VIOLATION};

/// Multipliers of every level, and of the choice of least norm after the last level.
///
/// ```
/// use ahqp_core::{Hierarchy, Level, Rows, Settings, Solver};
/// use nalgebra::{dmatrix, dvector};
///
/// let mut hierarchy = Hierarchy::new(1)?;
/// hierarchy.set_bounds(&dvector![-1.0], &dvector![1.0])?;
/// hierarchy.push(Level::least_squares(Rows::equalities(&dmatrix![2.0], &dvector![6.0])?))?;
/// let mut solver = Solver::new(&hierarchy, Settings::default())?;
/// let x = solver.solve(&hierarchy)?.optimum()?.to_vec();
/// let certificate = solver.certificate(&hierarchy)?;
/// assert!(certificate.residuals(&hierarchy, &x)?.worst() < 1e-9);
/// // 2 (2·1 − 6) + λ = 0 at the upper bound.
/// assert!((certificate.multipliers(0)[0].1 - 8.0).abs() < 1e-9);
/// # Ok::<(), ahqp_core::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Certificate {
    /// The problem whose optimality is proved.
    pub(crate) data: ProblemData,
    pub(crate) levels: Vec<Vec<(ConstraintSource, f64)>>,
    pub(crate) active: Vec<ConstraintSource>,
}

/// Residuals of a proof of optimality by a point and its multipliers. Each is the worst of all
/// levels, relative to the numbers involved.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct CertificateResiduals {
    /// Part of a level's gradient that the multipliers do not balance.
    pub stationarity: f64,
    /// Violation of a bound or hard constraint.
    pub feasibility: f64,
    /// Distance of an inequality from its bound, where its multiplier is not zero.
    pub complementarity: f64,
    /// Size of a multiplier with the wrong sign.
    pub sign: f64,
    /// Distance from x to the optimum, relative to the larger of their largest entries.
    ///
    /// It is computed where multipliers do not prove enough: where they leave a doubt, and where
    /// forces of rows of one level differ by more than a million. Doubles may hide the smaller
    /// forces then. The distance is found in arithmetic of 32 digits, starting from x. It is
    /// infinite if no optimum is found.
    pub distance: Option<f64>,
}

impl CertificateResiduals {
    /// Returns the largest residual: the violation, and the distance to the optimum. Where the
    /// distance was not needed, the residuals of the multipliers count instead.
    pub fn worst(&self) -> f64 {
        self.feasibility.max(self.distance.unwrap_or_else(|| self.of_multipliers()))
    }

    fn of_multipliers(&self) -> f64 {
        self.stationarity.max(self.complementarity).max(self.sign)
    }
}

impl Certificate {
    /// Returns the nonzero multipliers of a level, counted from 0. The number of levels stands for
    /// the choice of least norm. Multipliers are positive at an upper bound. The rows of a
    /// quadratic objective are those of its Hessian.
    pub fn multipliers(&self, level: usize) -> &[(ConstraintSource, f64)] {
        self.levels.get(level).map_or(&[], Vec::as_slice)
    }

    /// Returns the active set: rows and bounds that are held at a bound, and violated rows of
    /// objectives.
    pub fn active(&self) -> &[ConstraintSource] {
        &self.active
    }

    /// Checks that x is optimal, using only the data of the hierarchy and the multipliers.
    ///
    /// # Errors
    /// [`Error::Size`] if x does not fit. [`Error::ShapeChanged`] and [`Error::DataChanged`] if the
    /// certificate was made for another problem than `hierarchy`. Those of
    /// [`solve`](crate::Solver::solve) if the data are invalid.
    pub fn residuals(
        &self,
        hierarchy: &Hierarchy,
        x: &[f64],
    ) -> Result<CertificateResiduals, Error> {
        self.data.expect_unchanged(hierarchy).map_err(|error| hierarchy.named(error))?;
        crate::problem::rows::expect_size("x", x.len(), hierarchy.variables())?;
        let mut check = Check { hierarchy, x, residuals: CertificateResiduals::default() };
        check.feasibility();
        let mut settled = BTreeSet::new();
        for (level, multipliers) in self.levels.iter().enumerate() {
            check.level(level, multipliers, &mut settled)?;
        }
        let residuals = &mut check.residuals;
        if residuals.of_multipliers() > VIOLATION || refinement::is_needed(hierarchy, x) {
            residuals.distance = Some(refinement::distance(hierarchy, x));
        }
        Ok(check.residuals)
    }
}

struct Check<'a> {
    hierarchy: &'a Hierarchy,
    x: &'a [f64],
    residuals: CertificateResiduals,
}

/// A row of the problem at x.
struct RowAt {
    coefficients: Vec<f64>,
    /// Value a x and its violation: positive above the range, negative below.
    value: f64,
    violation: f64,
    lower: f64,
    upper: f64,
    /// Size that the rounding in a x is relative to.
    magnitude: f64,
    /// Sum of the sizes of the terms of a x and of the nearer bound.
    size: f64,
    norm: f64,
}

impl RowAt {
    /// Returns a gap to a bound relative to the row's terms at x, less the rounding of a vector as
    /// long as x.
    fn relative(&self, gap: f64, x_norm: f64) -> f64 {
        let rest = (gap.abs() - PRODUCT * self.norm * x_norm).max(0.0);
        rest / self.size.max(f64::MIN_POSITIVE)
    }
}

impl Check<'_> {
    fn feasibility(&mut self) {
        let mut worst = 0.0_f64;
        let x_norm = norm(self.x);
        for variable in 0..self.x.len() {
            let row = self.bound(variable);
            worst = worst.max(row.relative(row.violation, x_norm));
        }
        for level in self.hierarchy.levels() {
            for index in 0..level.constraints().len() {
                if let Some(row) = self.row(level.constraints(), index) {
                    worst = worst.max(row.relative(row.violation, x_norm));
                }
            }
        }
        self.residuals.feasibility = worst;
    }

    /// Checks stationarity, complementarity and signs of one level.
    fn level(
        &mut self,
        level: usize,
        multipliers: &[(ConstraintSource, f64)],
        settled: &mut BTreeSet<ConstraintSource>,
    ) -> Result<(), Error> {
        let (mut balance, mut size) = self.gradient(level, settled);
        for &(source, multiplier) in multipliers {
            let row = self.source(source, level)?;
            add_scaled(&mut balance, multiplier, &row.coefficients);
            size += multiplier.abs() * row.norm;
        }
        let size = size.max(f64::MIN_POSITIVE);
        self.residuals.stationarity = self.residuals.stationarity.max(norm_max(&balance) / size);
        for &(source, multiplier) in multipliers {
            let row = self.source(source, level)?;
            let share = multiplier.abs() * row.norm / size;
            let is_free = row.lower == row.upper || settled.contains(&source);
            if share <= MULTIPLIER || is_free {
                continue;
            }
            let bound = if multiplier > 0.0 { row.upper } else { row.lower };
            if bound.is_infinite() {
                self.residuals.sign = self.residuals.sign.max(share);
                continue;
            }
            let gap = (row.value - bound).abs();
            let other = if multiplier > 0.0 { row.lower } else { row.upper };
            if (row.value - other).abs() < gap {
                // The row is at its other bound, and its multiplier has the wrong sign.
                self.residuals.sign = self.residuals.sign.max(share);
            } else {
                settled.insert(source);
                let gap = row.relative(gap, norm(self.x)).min(share);
                self.residuals.complementarity = self.residuals.complementarity.max(gap);
            }
        }
        Ok(())
    }

    /// Returns the gradient of a level's objective and the size of its terms. Violated rows are
    /// held from here on, and their multipliers may have either sign.
    fn gradient(&self, level: usize, settled: &mut BTreeSet<ConstraintSource>) -> (Vec<f64>, f64) {
        let n = self.x.len();
        let mut gradient = vec![0.0; n];
        let mut size = 0.0;
        match self.hierarchy.levels().get(level).map(crate::problem::level::Level::objective) {
            None => {
                gradient.copy_from_slice(self.x);
                size = norm(self.x);
            }
            Some(Objective::None) => {}
            Some(Objective::LeastSquares(rows)) => {
                for index in 0..rows.len() {
                    let Some(row) = self.objective_row(rows, index) else { continue };
                    let weight = rows.weight(index);
                    add_scaled(&mut gradient, weight * row.violation, &row.coefficients);
                    size += weight * row.norm * (row.violation.abs() + row.magnitude);
                    if row.relative(row.violation, norm(self.x)) > VIOLATION {
                        let level = LevelId::new(level);
                        settled.insert(ConstraintSource::Objective { level, row: index });
                    }
                }
            }
            Some(Objective::Quadratic { hessian, gradient: linear }) => {
                let x = DVector::from_column_slice(self.x);
                gradient.copy_from_slice((hessian * &x + linear).as_slice());
                size = hessian.norm() * x.norm() + linear.norm();
            }
        }
        (gradient, size)
    }

    fn source(&self, source: ConstraintSource, level: usize) -> Result<RowAt, Error> {
        let levels = self.hierarchy.levels();
        let missing = || Error::NoSuchLevel { level: LevelId::new(level) };
        match source {
            ConstraintSource::Bound { variable } if variable < self.x.len() => {
                Ok(self.bound(variable))
            }
            ConstraintSource::Constraint { level: at, row } if at.index() <= level => {
                let rows = levels
                    .get(at.index())
                    .map(crate::problem::level::Level::constraints)
                    .ok_or_else(missing)?;
                self.row(rows, row).ok_or_else(missing)
            }
            ConstraintSource::Objective { level: at, row } if at.index() < level => {
                match levels.get(at.index()).map(crate::problem::level::Level::objective) {
                    Some(Objective::LeastSquares(rows)) => {
                        self.objective_row(rows, row).ok_or_else(missing)
                    }
                    Some(Objective::Quadratic { hessian, .. }) if row < hessian.nrows() => {
                        let coefficients: Vec<f64> = hessian.row(row).iter().copied().collect();
                        let value = dot(&coefficients, self.x);
                        Ok(self.row_at(coefficients, value, value))
                    }
                    _ => Err(missing()),
                }
            }
            _ => Err(missing()),
        }
    }

    fn bound(&self, variable: usize) -> RowAt {
        let mut coefficients = vec![0.0; self.x.len()];
        coefficients[variable] = 1.0;
        let (lower, upper) = (self.hierarchy.lower()[variable], self.hierarchy.upper()[variable]);
        self.row_at(coefficients, lower, upper)
    }

    fn row(&self, rows: &Rows, index: usize) -> Option<RowAt> {
        let coefficients = rows.row(index)?.to_vec();
        Some(self.row_at(coefficients, *rows.lower().get(index)?, *rows.upper().get(index)?))
    }

    /// Returns a row of an objective. A row of weight zero bounds nothing.
    fn objective_row(&self, rows: &Rows, index: usize) -> Option<RowAt> {
        if rows.weight(index) > 0.0 {
            return self.row(rows, index);
        }
        let coefficients = rows.row(index)?.to_vec();
        Some(self.row_at(coefficients, f64::NEG_INFINITY, f64::INFINITY))
    }

    fn row_at(&self, coefficients: Vec<f64>, lower: f64, upper: f64) -> RowAt {
        let value = dot(&coefficients, self.x);
        let length = norm(&coefficients);
        let nearer = lower.abs().min(upper.abs());
        let nearer = if nearer.is_finite() { nearer } else { 0.0 };
        let magnitude = nearer + length * norm(self.x);
        let terms = coefficients.iter().zip(self.x).map(|(a, x)| (a * x).abs());
        // A row without coefficients is judged in its own unit.
        let size = nearer + if length > 0.0 { terms.sum() } else { 1.0 };
        let violation = (value - upper).max(0.0) + (value - lower).min(0.0);
        RowAt { coefficients, value, violation, lower, upper, magnitude, size, norm: length }
    }
}
