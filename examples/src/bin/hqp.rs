//! Solves a set of hierarchical problems and says how long each took.

use std::{
    fs::File,
    io::{BufReader, BufWriter, Write, stdout},
    path::PathBuf,
    time::{Duration, Instant},
};

use ahqp_core::{Error, Hierarchy, Level, Objective, Rows, Settings, Solution, Solver, Status};
use anyhow::{Context, Result};
use clap::Parser;
use examples::hqp_file::{HqpReader, Problem};

/// Solves a set of hierarchical quadratic problems.
///
/// Prints a line for each problem, `INDEX STATUS ITERATIONS x_0 … x_{n-1}`, and at the end the
/// times of the solves to standard error. STATUS is 0 for solved, 1 when the iterations ran out,
/// 2 for hard constraints that contradict each other, 3 for an unbounded problem, 4 for
/// data that make no problem; from 2 on there is no solution and every x_i is NaN.
#[derive(Debug, Parser)]
#[command(version)]
struct Options {
    /// The set (the book's page on the format describes it).
    file: PathBuf,
    /// Start each solve from the solution of the problem before, when their shapes agree.
    #[arg(long)]
    warm: bool,
    /// How often the whole set is solved; the times are those of all solves.
    #[arg(long, value_name = "K", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..))]
    repeat: u32,
    /// Check a certificate of optimality of every solution, outside the times. To standard error go
    /// the residuals of those that fail and a line `certificate_worst=… certificate_failed=…`.
    #[arg(long)]
    certificate: bool,
}

/// The largest residual of a certificate that counts as proof.
const PROVED: f64 = 1e-8;

/// How a problem ended: the STATUS column.
#[derive(Debug, Clone, Copy)]
enum Code {
    Solved = 0,
    IterationLimit = 1,
    Infeasible = 2,
    Unbounded = 3,
    Refused = 4,
}

fn main() -> Result<()> {
    let options = Options::parse();
    let shown = options.file.display();
    let file = File::open(&options.file).with_context(|| format!("cannot open {shown}"))?;
    let reader = HqpReader::new(BufReader::new(file)).with_context(|| shown.to_string())?;
    let problems: Vec<Problem> =
        reader.collect::<Result<_, _>>().with_context(|| shown.to_string())?;

    let mut output = BufWriter::new(stdout().lock());
    let mut runs = Runs::default();
    let mut proofs = Proofs::default();
    for pass in 0..options.repeat {
        let mut solver = None;
        for problem in &problems {
            let outcome = runs.solve(problem, &mut solver, options.warm);
            if pass == 0 {
                report(&mut output, problem, &outcome)?;
            }
            if options.certificate
                && let (Some(solver), (Code::Solved, _, x)) = (&mut solver, &outcome)
            {
                proofs.check(problem, solver, x);
            }
        }
    }
    output.flush()?;
    if options.certificate {
        eprintln!("certificate_worst={:e} certificate_failed={}", proofs.worst, proofs.failed);
    }
    eprintln!("{}", runs.summary());
    Ok(())
}

/// One solve's result: the solution's copy, or why there is none.
type Outcome = (Code, usize, Vec<f64>);

#[derive(Debug, Default)]
struct Runs {
    times: Vec<Duration>,
    iterations: usize,
}

impl Runs {
    /// Solves one problem, with the solver of the one before when their shapes agree.
    fn solve(&mut self, problem: &Problem, solver: &mut Option<Solver>, warm: bool) -> Outcome {
        let hierarchy = &problem.hierarchy;
        let mut x = vec![f64::NAN; hierarchy.variables()];
        loop {
            let ready = match solver {
                Some(ready) => ready,
                None => match Solver::new(hierarchy, Settings::default()) {
                    Ok(new) => solver.insert(new),
                    Err(_) => return (Code::Refused, 0, x),
                },
            };
            if !warm {
                ready.forget();
            }
            std::hint::black_box(read_through(hierarchy));
            let start = Instant::now();
            let result = ready.solve(hierarchy).inspect(|solution| x.copy_from_slice(solution.x()));
            let time = start.elapsed();
            if matches!(result, Err(Error::ShapeChanged { .. })) {
                *solver = None;
                continue;
            }
            let iterations = result.as_ref().map_or(0, |solution| solution.iterations());
            self.times.push(time);
            self.iterations += iterations;
            return (code(&result), iterations, x);
        }
    }

    /// Percentiles of the times, as one line.
    fn summary(&self) -> String {
        let mut times: Vec<f64> = self.times.iter().map(|t| t.as_secs_f64() * 1e6).collect();
        times.sort_by(f64::total_cmp);
        let at = |percent: usize| {
            let rank = (times.len() * percent).div_ceil(100).max(1) - 1;
            times.get(rank).copied().unwrap_or(0.0)
        };
        let mean = self.iterations as f64 / times.len().max(1) as f64;
        format!(
            "median_us={:.3} p90_us={:.3} p99_us={:.3} max_us={:.3} mean_iterations={mean:.3}",
            at(50),
            at(90),
            at(99),
            at(100),
        )
    }
}

/// The sum of all numbers of a problem: reading them brings them into the cache, where numbers are
/// that a controller has just computed. Without it the first touch of parsed text would be timed.
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

/// What the certificates say.
#[derive(Debug, Default)]
struct Proofs {
    worst: f64,
    failed: usize,
}

impl Proofs {
    fn check(&mut self, problem: &Problem, solver: &mut Solver, x: &[f64]) {
        let hierarchy = &problem.hierarchy;
        let residuals = solver
            .certificate(hierarchy)
            .and_then(|certificate| certificate.residuals(hierarchy, x));
        let proved = residuals.as_ref().is_ok_and(|residuals| residuals.worst() <= PROVED);
        if let Ok(residuals) = &residuals {
            self.worst = self.worst.max(residuals.worst());
        }
        if !proved {
            self.failed += 1;
            eprintln!("certificate of problem {}: {residuals:?}", problem.index);
        }
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

fn report(output: &mut impl Write, problem: &Problem, outcome: &Outcome) -> Result<()> {
    let (code, iterations, x) = outcome;
    write!(output, "{} {} {iterations}", problem.index, *code as u8)?;
    for value in x {
        write!(output, " {value:.16e}")?;
    }
    writeln!(output)?;
    Ok(())
}
