//! Slow, independent solver that checks [`Solver`]: the paper's cascade of quadratic programs (Sec.
//! III-A).
//!
//! Level k minimises ½‖A_k χ − b_k‖² under the inequalities so far and the stacked equalities E χ =
//! E χ*. What the levels above decided thereby stays as at their optimum χ* (Kanoun, Lamiraux and
//! Wieber, "Kinematic control of redundant manipulators: generalizing the task-priority framework
//! to inequality task", IEEE T-RO 27(4), 2011). Let Z be an orthonormal basis of the nullspace of
//! E. The points that keep the equalities are χ* + Z y. Clarabel solves each level for y.
//!
//! An interior-point method needs a feasible set with an interior. The optima of a level have none,
//! since rows that had to be active are active at each of them. Between levels the cascade
//! therefore turns inequalities that cannot be slack into equalities.

mod always_active;
mod level;
mod polish;
mod program;
mod row_space;
mod singular;
mod task;

use nalgebra::{DMatrix, DVector};

use crate::error::Error;
use crate::problem::hierarchy::Hierarchy;
use crate::problem::level::Objective;
use crate::solver::data::ProblemData;
use always_active::always_active;
use level::{LevelOptimum, LevelProgram};
use polish::polish;
use row_space::{RowSpace, row_norms};
use task::Task;

/// Largest violation of a hard row's bounds, relative to their size \[-\].
const FEASIBLE: f64 = 1e-7;
/// Largest number of times a level is solved again from its optimum for more digits.
const ROUNDS: usize = 3;
/// Rows within this distance of their bound, relative to their size, are at the bound \[-\].
const AT_BOUND: f64 = 1e-8;

/// A row is determined by the equalities if they leave less than this fraction of it \[-\].
/// Where their smallest singular value is σ, the basis Z is accurate to about 1e-16/σ. So Z gives
/// determined rows a random rest, which must not pass for a row.
const DETERMINED: f64 = 1e-8;

/// Solves `hierarchy` level by level with Clarabel's interior-point method.
///
/// Residuals of the levels are accurate to about 1e-9 under two conditions. The rows must differ
/// little in scale, and the levels must be either dependent or clearly independent. There is no
/// claim for other problems.
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
/// Those of [`Solver::validate`](crate::Solver::validate). [`Error::Reference`] with the level and
/// the reason if constraints cannot hold, or with Clarabel's status if Clarabel fails.
pub fn solve_reference(hierarchy: &Hierarchy) -> Result<DVector<f64>, Error> {
    ProblemData::validate(hierarchy)?;
    let n = hierarchy.variables();
    let mut cascade = Cascade::new(hierarchy)?;
    for (level, data) in hierarchy.levels().iter().enumerate() {
        cascade.level = level;
        cascade.constrain(&Task::of_rows(data.constraints(), n))?;
        match data.objective() {
            Objective::None => {}
            Objective::LeastSquares(rows) => cascade.minimise(&Task::of_weighted(rows, n))?,
            Objective::Quadratic { hessian, gradient } => {
                let task = Task::of_quadratic(hessian, gradient);
                cascade.minimise(&task.ok_or_else(|| no_convergence(level))?)?;
            }
        }
    }
    cascade.level = hierarchy.levels().len();
    cascade.minimise(&Task::least_norm(n))?;
    Ok(DVector::from_iterator(n, cascade.x.iter().copied()))
}

/// State of the cascade. χ* is an optimum of all levels so far. Every other optimum is χ* + Z y for
/// a y that satisfies the inequalities.
struct Cascade {
    level: usize,
    /// χ*.
    x: DVector<f64>,
    /// Rows of E.
    equalities: Vec<DVector<f64>>,
    /// Z, with E Z = 0 and ZᵀZ = I.
    nullspace: DMatrix<f64>,
    inequalities: Vec<Inequality>,
}

/// The inequality a χ ≤ b.
struct Inequality {
    a: DVector<f64>,
    b: f64,
}

impl Cascade {
    fn new(hierarchy: &Hierarchy) -> Result<Self, Error> {
        let n = hierarchy.variables();
        let bounds = Task::of_bounds(hierarchy);
        let mut cascade = Self {
            level: 0,
            x: DVector::from_fn(n, |i, _| 0.0_f64.clamp(bounds.lower[i], bounds.upper[i])),
            equalities: Vec::new(),
            nullspace: DMatrix::identity(n, n),
            inequalities: Vec::new(),
        };
        cascade.keep(&bounds, FEASIBLE)?;
        Ok(cascade)
    }

    /// Adds hard rows, after moving χ* to a point at which they hold.
    fn constrain(&mut self, rows: &Task) -> Result<(), Error> {
        if rows.matrix.nrows() == 0 {
            return Ok(());
        }
        self.x = self.optimum(rows)?.x;
        let values = &rows.matrix * &self.x;
        for (i, &value) in values.iter().enumerate() {
            let violation = (value - value.clamp(rows.lower[i], rows.upper[i])).abs();
            if violation > FEASIBLE * (1.0 + value.abs()) {
                let status = format!("infeasible: a constraint stays violated by {violation:e}");
                return Err(Error::Reference { level: self.level, status });
            }
        }
        self.keep(rows, FEASIBLE)?;
        self.stack_always_active()
    }

    /// Minimises `task` and keeps the optimum.
    fn minimise(&mut self, task: &Task) -> Result<(), Error> {
        let optimum = self.optimum(task)?;
        self.x = optimum.x;
        let needed = self.inequalities.iter().zip(optimum.needed).filter(|(_, needed)| *needed);
        self.equalities.extend(needed.map(|(inequality, _)| inequality.a.clone()));
        self.equalities.push(task.linear.clone());
        self.keep(task, AT_BOUND)?;
        self.stack_always_active()
    }

    fn optimum(&self, task: &Task) -> Result<LevelOptimum, Error> {
        let mut program = LevelProgram::new(self, self.x.clone(), task);
        let (mut best, mut proved) = polish(&program, program.solve(self.level)?);
        for _ in 0..ROUNDS {
            // If little violation is left, its digits show only in its own unit.
            let before = program.violation(&program.origin);
            if proved || program.violation(&best.x) > 0.3 * before {
                break;
            }
            program = LevelProgram::new(self, best.x.clone(), task);
            let Ok(rough) = program.solve(self.level) else { break };
            let (finer, surely) = polish(&program, rough);
            if program.violation(&finer.x) > program.violation(&best.x) {
                break;
            }
            (best, proved) = (finer, surely);
        }
        Ok(best)
    }

    /// Keeps the values that the rows of `task` reach at χ*. Equalities, and rows violated by more
    /// than `slack` relative to their size, keep their value. Other rows keep their range.
    fn keep(&mut self, task: &Task, slack: f64) -> Result<(), Error> {
        let values = &task.matrix * &self.x;
        let is_stacked = |i: usize| {
            let (lower, upper, value) = (task.lower[i], task.upper[i], values[i]);
            let slack = slack * (1.0 + value.abs());
            lower == upper || value > upper + slack || value < lower - slack
        };
        let row = |i: usize| task.matrix.row(i).transpose();
        let (stacked, ranges): (Vec<_>, Vec<_>) = (0..values.nrows()).partition(|&i| is_stacked(i));
        self.equalities.extend(stacked.into_iter().map(row));
        for i in ranges {
            if task.upper[i].is_finite() {
                let b = task.upper[i].max(values[i]);
                self.inequalities.push(Inequality { a: row(i), b });
            }
            if task.lower[i].is_finite() {
                let b = -task.lower[i].min(values[i]);
                self.inequalities.push(Inequality { a: -row(i), b });
            }
        }
        self.project()
    }

    /// Computes Z, and drops inequalities whose value is determined by the equalities.
    fn project(&mut self) -> Result<(), Error> {
        let rows = &self.equalities;
        let stacked = DMatrix::from_fn(rows.len(), self.x.nrows(), |i, j| rows[i][j]);
        let space = RowSpace::new(&stacked, &row_norms(&stacked));
        self.nullspace = space.ok_or_else(|| no_convergence(self.level))?.nullspace;
        let nullspace = self.nullspace.transpose();
        self.inequalities.retain(|i| (&nullspace * &i.a).norm() > DETERMINED * i.a.norm());
        Ok(())
    }

    /// Turns inequalities that no remaining point satisfies with slack into equalities.
    fn stack_always_active(&mut self) -> Result<(), Error> {
        loop {
            let active = always_active(self)?;
            if active.is_empty() {
                return Ok(());
            }
            // The order from the last to the first keeps the earlier indices valid.
            for index in active.into_iter().rev() {
                self.equalities.push(self.inequalities.remove(index).a);
            }
            self.project()?;
        }
    }

    /// Returns G and h of the inequalities G y ≤ h at `origin` + Z y, with rows of unit norm.
    fn reduced_inequalities(&self, origin: &DVector<f64>) -> (DMatrix<f64>, DVector<f64>) {
        let (count, n) = (self.inequalities.len(), self.x.nrows());
        let rows = DMatrix::from_fn(count, n, |i, j| self.inequalities[i].a[j]);
        let mut g = &rows * &self.nullspace;
        let values = rows * origin;
        let mut h = DVector::zeros(count);
        for (i, norm) in row_norms(&g).into_iter().enumerate() {
            g.row_mut(i).iter_mut().for_each(|entry| *entry /= norm);
            h[i] = (self.inequalities[i].b - values[i]).max(0.0) / norm;
        }
        (g, h)
    }
}

fn no_convergence(level: usize) -> Error {
    Error::Reference { level, status: "the singular values do not converge".to_owned() }
}
