//! Solves the problems of a set one after another, with times and proofs. The program `hqp` uses
//! it.

use std::{
    fmt,
    time::{Duration, Instant},
};

use ahqp_core::{Error, Hierarchy, Level, Objective, Rows, Settings, Solution, Solver, Status};
use serde::Serialize;

use crate::file::Problem;

/// The largest residual of a certificate that counts as proof.
const PROVED: f64 = 1e-8;

/// Ending of a problem: the STATUS column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Code {
    /// The problem is at its optimum.
    Solved = 0,
    /// The iterations ran out.
    IterationLimit = 1,
    /// Hard constraints cannot hold together.
    Infeasible = 2,
    /// An objective has no minimum.
    Unbounded = 3,
    /// The data are invalid.
    Refused = 4,
}

/// Result of one solve.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// Ending of the solve.
    pub code: Code,
    /// Number of iterations.
    pub iterations: usize,
    /// Copy of the solution, NaN if there is none.
    pub x: Vec<f64>,
    /// Reason why there is no solution.
    pub reason: Option<String>,
}

impl Outcome {
    fn refused(problem: &Problem, error: &Error, x: Vec<f64>) -> Self {
        let reason = Some(problem.reason(error));
        Self { code: Code::Refused, iterations: 0, x, reason }
    }
}

/// Times of the solves of a set.
#[derive(Debug, Default)]
pub struct Runs {
    settings: Settings,
    times: Vec<Duration>,
    iterations: usize,
}

impl Runs {
    /// Creates runs of a solver with these settings.
    pub fn with_settings(settings: Settings) -> Self {
        Self { settings, ..Self::default() }
    }

    /// Solves one problem. Reuses the solver of the problem before if their shapes agree.
    pub fn solve(&mut self, problem: &Problem, solver: &mut Option<Solver>, warm: bool) -> Outcome {
        let hierarchy = &problem.hierarchy;
        let mut x = vec![f64::NAN; hierarchy.variables()];
        loop {
            let ready = match solver {
                Some(ready) => ready,
                None => match Solver::new(hierarchy, self.settings) {
                    Ok(new) => solver.insert(new),
                    Err(error) => return Outcome::refused(problem, &error, x),
                },
            };
            if !warm {
                ready.forget();
            }
            std::hint::black_box(read_through(hierarchy));
            let start = Instant::now();
            let result =
                ready.solve(hierarchy).inspect(|solution| x.copy_from_slice(solution.best()));
            let time = start.elapsed();
            if matches!(result, Err(Error::ShapeChanged { .. })) {
                *solver = None;
                continue;
            }
            let iterations = result.as_ref().map_or(0, |solution| solution.iterations());
            self.times.push(time);
            self.iterations += iterations;
            let code = code(&result);
            let reason = result.err().map(|error| match ready.conflict() {
                [] => problem.reason(&error),
                conflict => format!("{}; {}", problem.reason(&error), problem.conflict(conflict)),
            });
            return Outcome { code, iterations, x, reason };
        }
    }

    /// Returns percentiles of the times.
    pub fn times(&self) -> Times {
        Times::new(&self.times, self.iterations)
    }
}

/// Percentiles of the times of single solves. `Display` prints them in one line.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Times {
    /// Median \[µs\].
    pub median_us: f64,
    /// 90th percentile \[µs\].
    pub p90_us: f64,
    /// 99th percentile \[µs\].
    pub p99_us: f64,
    /// Maximum \[µs\].
    pub max_us: f64,
    /// Mean number of iterations.
    pub mean_iterations: f64,
}

impl Times {
    /// Returns percentiles of these times of solves, which took so many iterations together.
    pub(crate) fn new(times: &[Duration], iterations: usize) -> Self {
        let mut times: Vec<f64> = times.iter().map(|t| t.as_secs_f64() * 1e6).collect();
        times.sort_by(f64::total_cmp);
        let at = |percent: usize| {
            let rank = (times.len() * percent).div_ceil(100).max(1) - 1;
            times.get(rank).copied().unwrap_or(0.0)
        };
        Self {
            median_us: at(50),
            p90_us: at(90),
            p99_us: at(99),
            max_us: at(100),
            mean_iterations: iterations as f64 / times.len().max(1) as f64,
        }
    }
}

impl fmt::Display for Times {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { median_us, p90_us, p99_us, max_us, mean_iterations } = self;
        write!(f, "median_us={median_us:.3} p90_us={p90_us:.3} p99_us={p99_us:.3} ")?;
        write!(f, "max_us={max_us:.3} mean_iterations={mean_iterations:.3}")
    }
}

/// Returns the sum of all numbers of a problem. Reading them brings them into the cache, where a
/// controller's numbers are after it computed them. Otherwise the time would include the first
/// access to parsed text.
fn read_through(hierarchy: &Hierarchy) -> f64 {
    let sum = |values: &[f64]| values.iter().sum::<f64>();
    let rows = |rows: &Rows| -> f64 {
        rows.iter().map(|(row, lower, upper)| sum(row) + lower + upper).sum()
    };
    let objective = |level: &Level| match level.objective() {
        Objective::LeastSquares(of_level) => rows(of_level),
        Objective::Quadratic { hessian, gradient } => hessian.sum() + gradient.sum(),
        _ => 0.0,
    };
    sum(hierarchy.lower())
        + sum(hierarchy.upper())
        + hierarchy.levels().iter().map(|l| rows(l.constraints()) + objective(l)).sum::<f64>()
}

/// Results of the certificates of a set.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct Proofs {
    /// Largest residual.
    #[serde(rename = "certificate_worst")]
    pub worst: f64,
    /// Number of certificates that prove nothing.
    #[serde(rename = "certificate_failed")]
    pub failed: usize,
}

impl Proofs {
    /// Checks the certificate of a solution. Returns what is wrong if it proves nothing.
    pub fn check(&mut self, problem: &Problem, solver: &mut Solver, x: &[f64]) -> Option<String> {
        let hierarchy = &problem.hierarchy;
        let residuals = solver
            .certificate(hierarchy)
            .and_then(|certificate| certificate.residuals(hierarchy, x));
        let proved = residuals.as_ref().is_ok_and(|residuals| residuals.worst() <= PROVED);
        if let Ok(residuals) = &residuals {
            self.worst = self.worst.max(residuals.worst());
        }
        if proved {
            return None;
        }
        self.failed += 1;
        let Problem { index, name, .. } = problem;
        Some(match residuals {
            Ok(residuals) => format!("problem {index} ({name}), not proved: {residuals:?}"),
            Err(error) => format!("problem {index} ({name}), not proved: {error}"),
        })
    }
}

fn code(result: &Result<&Solution, Error>) -> Code {
    match result {
        Ok(solution) if solution.status() == Status::Solved => Code::Solved,
        Ok(_) => Code::IterationLimit,
        Err(Error::Infeasible { .. }) => Code::Infeasible,
        Err(Error::Unbounded { .. }) => Code::Unbounded,
        Err(_) => Code::Refused,
    }
}
