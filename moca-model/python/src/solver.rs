//! `ahqp`: problems, the solver and its results.

pub(crate) mod certificate;
pub(crate) mod hierarchy;
pub(crate) mod limits;
pub(crate) mod row;
pub(crate) mod solution;

use std::time::{Duration, Instant};

use ahqp_core::{Budget, Level, Rows, Settings, WarmStart};
use numpy::PyUntypedArrayMethods;
use pyo3::prelude::*;

use crate::arrays::{Matrix, vector, vector_of, with_slice};
use crate::failure::{Failure, InfeasibleError, Result};
use crate::shared::Shared;
use ahqp_core::CoefficientMatrix;
use certificate::Certificate;
use hierarchy::{Hierarchy, Problem, set_bounds};
use row::Row;
use solution::Solution;

/// Solver for hierarchies of one shape. Each solve starts from the result of the one before.
///
/// `Solver(hierarchy, max_iterations=1000, feasibility_tolerance=1e-10, rank_tolerance=1e-10,
/// optimality_tolerance=1e-10, warm_start=True)`
///
/// Tolerances are relative, above 0 and at most 1e-4. Solving releases the interpreter's lock. A solver
/// used from two threads at once raises `RuntimeError`; `copy.copy(solver)` makes another one.
///
/// >>> import ahqp
/// >>> hierarchy = ahqp.Hierarchy(2)
/// >>> level = hierarchy.push([[1.0, 1.0]], [2.0], [2.0])
/// >>> ahqp.Solver(hierarchy).solve(hierarchy).x.round(12).tolist()
/// [1.0, 1.0]
#[pyclass(frozen, module = "ahqp")]
pub(crate) struct Solver(pub(crate) Shared<Memory>);

/// A solver, and the number of solves that it has begun.
#[derive(Debug, Clone)]
pub(crate) struct Memory {
    pub(crate) solver: ahqp_core::Solver,
    pub(crate) solves: u64,
}

impl Solver {
    fn of(solver: ahqp_core::Solver) -> Self {
        Self(Shared::new("solver", Memory { solver, solves: 0 }))
    }
}

#[pymethods]
impl Solver {
    #[new]
    #[pyo3(signature = (hierarchy, *, max_iterations=1000, feasibility_tolerance=1e-10, rank_tolerance=1e-10, optimality_tolerance=1e-10, warm_start=true))]
    fn new(
        hierarchy: &Hierarchy,
        max_iterations: usize,
        feasibility_tolerance: f64,
        rank_tolerance: f64,
        optimality_tolerance: f64,
        warm_start: bool,
    ) -> Result<Self> {
        let warm_start = if warm_start { WarmStart::PreviousActiveSet } else { WarmStart::Cold };
        let settings = Settings {
            max_iterations,
            feasibility_tolerance,
            rank_tolerance,
            optimality_tolerance,
            warm_start,
            ..Settings::default()
        };
        let problem = hierarchy.0.lock()?;
        Ok(Self::of(ahqp_core::Solver::new(&problem.hierarchy, settings)?))
    }

    /// Solves a hierarchy of the shape that the solver was made for.
    ///
    /// Parameters
    /// ----------
    /// hierarchy : Hierarchy
    /// iterations : int, optional
    ///     Largest number of iterations of this solve.
    /// time : float, optional
    ///     Largest wall-clock time of this solve [s].
    ///
    /// Returns
    /// -------
    /// Solution
    ///
    /// Raises
    /// ------
    /// InfeasibleError
    ///     Hard constraints contradict each other; its `conflict` lists them.
    /// Error
    ///     The data are no valid problem: NaN, empty bounds, another shape.
    #[pyo3(signature = (hierarchy, *, iterations=None, time=None))]
    fn solve(
        slf: &Bound<'_, Self>,
        hierarchy: &Bound<'_, Hierarchy>,
        iterations: Option<usize>,
        time: Option<f64>,
    ) -> Result<Solution> {
        let py = slf.py();
        let budget = Budget { iterations, time: time.map(duration).transpose()? };
        let mut memory = slf.get().0.lock()?;
        let problem = hierarchy.get().0.lock()?;
        let (Memory { solver, solves }, Problem { hierarchy: problem, changes }) =
            (&mut *memory, &*problem);
        *solves += 1;
        let (result, time) = py.detach(|| {
            let start = Instant::now();
            let result = solver.solve_within(problem, budget);
            let time = start.elapsed();
            (result.cloned(), time)
        });
        match result {
            Ok(found) => Ok(Solution {
                found,
                time,
                hierarchy: hierarchy.clone().unbind(),
                changes: *changes,
                solver: slf.clone().unbind(),
                solve: *solves,
            }),
            Err(error @ ahqp_core::Error::Infeasible { .. }) => {
                let exception = InfeasibleError::new_err(error.to_string());
                let conflict = rows(problem, solver.conflict());
                exception.value(py).setattr("conflict", conflict)?;
                Err(exception.into())
            }
            Err(error) => Err(error.into()),
        }
    }

    /// The rows that cannot hold together, after a solve that raised `InfeasibleError`; else empty.
    fn conflict(&self, hierarchy: &Hierarchy) -> Result<Vec<Row>> {
        Ok(rows(&hierarchy.0.lock()?.hierarchy, self.0.lock()?.solver.conflict()))
    }

    /// The multipliers that prove the last solution optimal.
    ///
    /// Raises `Error` if the last solve did not end at the optimum, or the data have changed since.
    fn certificate(&self, py: Python<'_>, hierarchy: &Hierarchy) -> Result<Certificate> {
        let (mut memory, problem) = (self.0.lock()?, hierarchy.0.lock()?);
        let (solver, problem) = (&mut memory.solver, &problem.hierarchy);
        let inner = py.detach(|| solver.certificate(problem))?;
        Ok(Certificate { inner, problem: problem.clone() })
    }

    /// Forgets the previous active set: the next solve starts without one.
    fn forget(&self) -> Result<()> {
        self.0.lock()?.solver.forget();
        Ok(())
    }

    fn __copy__(&self) -> Result<Self> {
        Ok(Self::of(self.0.lock()?.solver.clone()))
    }
}

/// Solves one hierarchical problem in the layout of DAQP: the rows of all levels below each other.
///
/// Lexicographically minimises, highest priority first, the squared distance of each level's `A x` to its bounds.
/// `Solver` is faster for many problems of one shape.
///
/// Parameters
/// ----------
/// A : array_like, shape (m, n)
///     The rows of all levels, those of the first level on top.
/// lower, upper : array_like, shape (m,)
///     Their bounds; ±inf where there is none, equal for equalities.
/// breaks : array_like of int, shape (levels,)
///     Where each level ends: its last row + 1, the last entry being m (DAQP's `break_points`).
/// lb, ub : array_like, shape (n,), optional
///     Bounds of the variables, which always hold.
///
/// Returns
/// -------
/// Solution
#[pyfunction]
#[pyo3(signature = (A, lower, upper, breaks, lb=None, ub=None))]
#[allow(non_snake_case)]
pub(crate) fn solve(
    py: Python<'_>,
    A: &Bound<'_, PyAny>,
    lower: &Bound<'_, PyAny>,
    upper: &Bound<'_, PyAny>,
    breaks: &Bound<'_, PyAny>,
    lb: Option<&Bound<'_, PyAny>>,
    ub: Option<&Bound<'_, PyAny>>,
) -> Result<Solution> {
    let matrix = Matrix::read("A", A)?;
    let (m, n) = (matrix.view().nrows(), matrix.view().ncols());
    let (lower, upper) = (vector_of("lower", lower, m)?, vector_of("upper", upper, m)?);
    let mut hierarchy = hierarchy::new(n)?;
    set_bounds(&mut hierarchy, ["lb", "ub"], lb, ub)?;
    let mut start = 0;
    for end in breaks_of(breaks, m)? {
        let block = matrix.rows(start..end);
        let part = |bound: &crate::arrays::Vector<'_>| -> Vec<f64> {
            bound.as_array().iter().skip(start).take(end - start).copied().collect()
        };
        hierarchy.push(Level::least_squares(Rows::ranges(
            &block,
            &part(&lower),
            &part(&upper),
        )?))?;
        start = end;
    }
    let solver = ahqp_core::Solver::new(&hierarchy, Settings::default())?;
    let (hierarchy, solver) = (Bound::new(py, Hierarchy::of(hierarchy))?, Solver::of(solver));
    Solver::solve(&Bound::new(py, solver)?, &hierarchy, None, None)
}

/// Returns the ends of the levels over `m` rows.
fn breaks_of(breaks: &Bound<'_, PyAny>, m: usize) -> Result<Vec<usize>> {
    let wrong = || {
        let text =
            format!("breaks must be whole numbers that rise from above 0 to {m}, the rows of A");
        Failure::value(text)
    };
    let breaks = vector("breaks", breaks)?;
    let mut ends = Vec::with_capacity(breaks.len());
    for &end in breaks.as_array() {
        let last = ends.last().copied().unwrap_or(0);
        let rises = end.fract() == 0.0 && end > last as f64 && end <= m as f64;
        if !rises {
            return Err(wrong());
        }
        // The value is whole, and from 1 to m.
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        ends.push(end as usize);
    }
    if ends.last().copied().unwrap_or(0) == m { Ok(ends) } else { Err(wrong()) }
}

fn duration(seconds: f64) -> Result<Duration> {
    Duration::try_from_secs_f64(seconds)
        .map_err(|_| Failure::value(format!("time is {seconds} s; it must be positive and finite")))
}

fn rows(hierarchy: &ahqp_core::Hierarchy, sources: &[ahqp_core::ConstraintSource]) -> Vec<Row> {
    sources.iter().map(|&source| Row::new(hierarchy, source)).collect()
}

/// Calls `run` with all numbers of a vector, which are contiguous.
pub(crate) fn slice_of<T>(
    name: &str,
    value: &Bound<'_, PyAny>,
    run: impl FnOnce(&[f64]) -> T,
) -> Result<T> {
    Ok(with_slice(&vector(name, value)?, run))
}
