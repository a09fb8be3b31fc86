//! The same hierarchy by another road: one Clarabel problem a level, then elimination of what
//! the level decided. Slow and independent; it is there to check the solver.
//!
//! An interior-point method needs a feasible set with an interior, and the optima of a level
//! have none: rows that had to be active are active at every one of them. Between levels the
//! cascade therefore turns inequalities that cannot be slack into equalities
//! (`interior::never_slack`) and eliminates all equalities by an orthonormal basis, so
//! that each level is a problem in the directions that are really free.

mod interior;
mod polish;
mod span;

use nalgebra::{DMatrix, DVector};

use crate::error::Error;
use crate::problem::hierarchy::Hierarchy;
use crate::problem::level::Objective;
use crate::problem::rows::Rows;
use crate::solver::data::ProblemData;
use interior::{Optimum, QuadraticProblem};
use polish::polish;
use span::complement;

/// What the bounds of a held row may be exceeded by, relative to their size \[-\].
const FEASIBLE: f64 = 1e-7;
/// How often a level is solved anew from its optimum for more digits.
const ROUNDS: usize = 3;
/// Rows with less room than this, relative to their size, are at their bound \[-\].
const AT_BOUND: f64 = 1e-8;

/// Solves `hierarchy` level by level with Clarabel's interior-point method.
///
/// Level residuals are right to about 1e-9 on problems whose rows differ little in scale and
/// whose levels are either dependent or clearly independent; it makes no claim on others.
///
/// ```
/// use ahqp_core::{Hierarchy, Level, Rows, solve_reference};
/// use nalgebra::{dmatrix, dvector};
///
/// let mut hierarchy = Hierarchy::new(2)?;
/// hierarchy.push(Level::least_squares(Rows::equalities(&dmatrix![1.0, 1.0], &dvector![2.0])?))?;
/// let x = solve_reference(&hierarchy)?;
/// assert!((x[0] - 1.0).abs() < 1e-6 && (x[1] - 1.0).abs() < 1e-6);
/// # Ok::<(), ahqp_core::Error>(())
/// ```
///
/// # Errors
/// The errors of [`Solver::solve`](crate::Solver::solve) for data that make no problem;
/// [`Error::Reference`] with the level and the reason for constraints that cannot hold, and with
/// Clarabel's status where it fails.
pub fn solve_reference(hierarchy: &Hierarchy) -> Result<DVector<f64>, Error> {
    ProblemData::new(hierarchy).load(hierarchy).map_err(|error| error.with_names(hierarchy))?;
    let n = hierarchy.variables();
    let mut cascade = Cascade::new(hierarchy);
    for (level, data) in hierarchy.levels().iter().enumerate() {
        cascade.level = level;
        cascade.constrain(data.constraints())?;
        match data.objective() {
            Objective::None => {}
            Objective::LeastSquares(rows) => {
                cascade.minimise(&weighed(rows)?, &DVector::zeros(n))?;
            }
            Objective::Quadratic { hessian, gradient } => {
                let (rows, linear) = as_least_squares(hessian, gradient)?;
                cascade.minimise(&rows, &linear)?;
            }
        }
    }
    cascade.level = hierarchy.levels().len();
    let zero = DVector::zeros(n);
    cascade.minimise(&Rows::equalities(&DMatrix::identity(n, n), &zero)?, &zero)?;
    Ok(cascade.x)
}

/// What holds so far: x is an optimum of all levels done, and every other optimum is x plus a
/// combination of the columns of `free` that keeps the inequalities.
struct Cascade {
    level: usize,
    x: DVector<f64>,
    free: DMatrix<f64>,
    inequalities: Vec<Inequality>,
}

/// a x ≤ b.
struct Inequality {
    a: DVector<f64>,
    b: f64,
}

impl Cascade {
    fn new(hierarchy: &Hierarchy) -> Self {
        let n = hierarchy.variables();
        let bounds = || hierarchy.lower().iter().zip(hierarchy.upper());
        let x = DVector::from_iterator(n, bounds().map(|(&l, &u)| 0.0_f64.clamp(l, u)));
        let free = DMatrix::identity(n, n);
        let mut cascade = Self { level: 0, x, free, inequalities: Vec::new() };
        for (i, (&lower, &upper)) in bounds().enumerate() {
            let mut unit = DVector::zeros(n);
            unit[i] = 1.0;
            cascade.hold_range(&unit, lower, upper);
        }
        cascade
    }

    /// Adds hard rows, after moving x to where they hold.
    fn constrain(&mut self, rows: &Rows) -> Result<(), Error> {
        if rows.is_empty() {
            return Ok(());
        }
        let optimum = self.optimum(rows, &DVector::zeros(self.x.len()))?;
        for (a, lower, upper) in rows.iter() {
            let value = DVector::from_row_slice(a).dot(&optimum.x);
            let violation = (value - value.clamp(lower, upper)).abs();
            if violation > FEASIBLE * (1.0 + value.abs()) {
                let status = format!("infeasible: a constraint stays violated by {violation:e}");
                return Err(Error::Reference { level: self.level, status });
            }
        }
        self.x = optimum.x;
        for (a, lower, upper) in rows.iter() {
            self.hold_range(&DVector::from_row_slice(a), lower, upper);
        }
        self.eliminate_never_slack()
    }

    /// Minimises ½ Σ (violation of `rows`)² + linearᵀx and holds the optimum.
    fn minimise(&mut self, rows: &Rows, linear: &DVector<f64>) -> Result<(), Error> {
        let optimum = self.optimum(rows, linear)?;
        self.x = optimum.x;
        let mut held: Vec<_> = self
            .inequalities
            .iter()
            .zip(&optimum.needed)
            .filter(|(_, needed)| **needed)
            .map(|(inequality, _)| inequality.a.clone())
            .collect();
        held.push(linear.clone());
        let mut ranges = Vec::new();
        for (a, lower, upper) in rows.iter() {
            let a = DVector::from_row_slice(a);
            let value = a.dot(&self.x);
            let slack = AT_BOUND * (1.0 + value.abs());
            if lower == upper || value > upper + slack || value < lower - slack {
                held.push(a);
            } else {
                ranges.push((a, lower, upper));
            }
        }
        self.hold(&held);
        for (a, lower, upper) in ranges {
            self.hold_range(&a, lower, upper);
        }
        self.eliminate_never_slack()
    }

    fn optimum(&self, rows: &Rows, linear: &DVector<f64>) -> Result<Optimum, Error> {
        let mut problem = QuadraticProblem::new(self, self.x.clone(), rows, linear);
        let (mut best, mut proved) = polish(&problem, problem.solve(self.level)?);
        for _ in 0..ROUNDS {
            // Where little violation is left, its digits show only in its own unit.
            if proved || problem.violation(&best.x) > 0.3 * problem.violation(&problem.origin) {
                break;
            }
            problem = QuadraticProblem::new(self, best.x.clone(), rows, linear);
            let Ok(rough) = problem.solve(self.level) else { break };
            let (finer, surely) = polish(&problem, rough);
            if problem.violation(&finer.x) > problem.violation(&best.x) {
                break;
            }
            (best, proved) = (finer, surely);
        }
        Ok(best)
    }

    /// a x keeps its value from here on, for each a.
    fn hold(&mut self, rows: &[DVector<f64>]) {
        let rest = complement(&self.free, rows);
        self.free = rest;
        let free = &self.free;
        self.inequalities.retain(|i| free.tr_mul(&i.a).norm() > span::DEPENDENT * i.a.norm());
    }

    /// lower ≤ a x ≤ upper holds from here on, as it does at x.
    fn hold_range(&mut self, a: &DVector<f64>, lower: f64, upper: f64) {
        if lower == upper {
            self.hold(std::slice::from_ref(a));
        } else if self.free.tr_mul(a).norm() > span::DEPENDENT * a.norm() {
            let value = a.dot(&self.x);
            if upper.is_finite() {
                self.inequalities.push(Inequality { a: a.clone(), b: upper.max(value) });
            }
            if lower.is_finite() {
                self.inequalities.push(Inequality { a: -a, b: -lower.min(value) });
            }
        }
    }

    fn eliminate_never_slack(&mut self) -> Result<(), Error> {
        loop {
            let stuck = interior::never_slack(self)?;
            if stuck.is_empty() {
                return Ok(());
            }
            let rows: Vec<_> = stuck.iter().map(|&i| self.inequalities[i].a.clone()).collect();
            let mut index = 0;
            self.inequalities.retain(|_| {
                index += 1;
                !stuck.contains(&(index - 1))
            });
            self.hold(&rows);
        }
    }
}

/// The rows that weigh something, with their bounds multiplied by the roots of their weights.
fn weighed(rows: &Rows) -> Result<Rows, Error> {
    let kept: Vec<usize> = (0..rows.len()).filter(|&i| rows.weight(i) > 0.0).collect();
    let mut weighed = Rows::zeros(kept.len(), rows.columns());
    for (to, from) in kept.into_iter().enumerate() {
        let root = rows.weight(from).sqrt();
        let row: Vec<f64> = rows.row(from).into_iter().flatten().map(|a| root * a).collect();
        weighed.set_row(to, &row, root * rows.lower()[from], root * rows.upper()[from])?;
    }
    Ok(weighed)
}

/// ½xᵀHx + gᵀx = ½‖Rx − b‖² + linearᵀx + constant, with H = RᵀR by pivoted Cholesky
/// factorisation and Rᵀb the part of −g in its range.
fn as_least_squares(
    hessian: &DMatrix<f64>,
    gradient: &DVector<f64>,
) -> Result<(Rows, DVector<f64>), Error> {
    let n = gradient.len();
    let least = 1e-12 * hessian.amax();
    let mut rest = hessian.clone();
    let mut roots = Vec::new();
    while roots.len() < n {
        let pivot = rest.diagonal().imax();
        let size = rest[(pivot, pivot)];
        if size <= least {
            break;
        }
        let row = rest.row(pivot) / size.sqrt();
        rest -= row.tr_mul(&row);
        roots.push(row);
    }
    let r = DMatrix::from_fn(roots.len(), n, |i, j| roots[i][j]);
    let sizes: Vec<f64> = hessian.diagonal().iter().map(|d| d.abs().sqrt()).collect();
    let none = DVector::zeros(roots.len());
    let b = span::least_squares(&r.transpose(), &sizes, &-gradient, &none).unwrap_or(none);
    let mut linear = gradient + r.tr_mul(&b);
    if linear.norm() <= 1e-9 * gradient.norm() {
        linear.fill(0.0);
    }
    Ok((Rows::equalities(&r, &b)?, linear))
}
