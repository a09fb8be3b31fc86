//! Solves ordinary quadratic programs: minimise ½xᵀPx + qᵀx + r subject to lower ≤ (A, I) x ≤
//! upper.
//!
//! It prints a line for each program:
//! `cargo run --release -p ahqp-core --example quadratic_programs -- FILES`.
//!
//! A file is little-endian. It contains n and the number m of rows of A as 64-bit integers. Then
//! come doubles: r, P, q, A, m + n lower bounds and m + n upper bounds.
//! `benches/peers/maros_meszaros.py` writes such files.
#![allow(clippy::print_stdout, missing_docs)]

use std::error::Error;
use std::path::Path;
use std::time::Instant;

use ahqp_core::nalgebra::{DMatrix, DVector};
use ahqp_core::{Hierarchy, Level, Rows, Settings, Solver};

/// A quadratic program as a hierarchy of one level, with the data to evaluate a point.
struct Problem {
    hierarchy: Hierarchy,
    hessian: DMatrix<f64>,
    gradient: DVector<f64>,
    constant: f64,
}

fn main() -> Result<(), Box<dyn Error>> {
    for path in std::env::args().skip(1) {
        let name = Path::new(&path).file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let problem = read(&std::fs::read(&path)?).map_err(|error| format!("{path}: {error}"))?;
        let begun = Instant::now();
        match solve(&problem) {
            Ok((value, iterations)) => {
                let time = begun.elapsed().as_secs_f64();
                println!("{name} solved {value:.12e} {iterations} {time:.4}");
            }
            Err(error) => println!("{name} refused {error}"),
        }
    }
    Ok(())
}

/// Returns the smallest value and the number of iterations.
fn solve(problem: &Problem) -> Result<(f64, usize), ahqp_core::Error> {
    let settings = Settings { max_iterations: 100_000, ..Settings::default() };
    let mut solver = Solver::new(&problem.hierarchy, settings)?;
    let solution = solver.solve(&problem.hierarchy)?;
    let x = DVector::from_column_slice(solution.optimum()?);
    let value = 0.5 * x.dot(&(&problem.hessian * &x)) + problem.gradient.dot(&x) + problem.constant;
    Ok((value, solution.iterations()))
}

fn read(bytes: &[u8]) -> Result<Problem, Box<dyn Error>> {
    let words = bytes.chunks_exact(8).map(|word| word.try_into().map(u64::from_le_bytes));
    let words = words.collect::<Result<Vec<u64>, _>>()?;
    let [n, m, numbers @ ..] = &words[..] else { return Err("too short".into()) };
    let [n, m] = [usize::try_from(*n)?, usize::try_from(*m)?];
    let numbers: Vec<f64> = numbers.iter().map(|&bits| f64::from_bits(bits)).collect();
    let [constant, rest @ ..] = &numbers[..] else { return Err("too short".into()) };
    if rest.len() != n * n + n + m * n + 2 * (m + n) {
        return Err(format!("{} numbers do not make {n} variables and {m} rows", rest.len()).into());
    }
    let (hessian, rest) = rest.split_at(n * n);
    let (gradient, rest) = rest.split_at(n);
    let (matrix, bounds) = rest.split_at(m * n);
    let (lower, upper) = bounds.split_at(m + n);
    let hessian = DMatrix::from_row_slice(n, n, hessian);
    let gradient = DVector::from_column_slice(gradient);
    let mut constraints = Rows::zeros(m, n);
    for (i, row) in matrix.chunks_exact(n).enumerate() {
        constraints.set_row(i, row, lower[i], upper[i])?;
    }
    let mut hierarchy = Hierarchy::new(n)?;
    hierarchy.set_bounds(&lower[m..], &upper[m..])?;
    hierarchy.push(Level::quadratic(&hessian, &gradient)?.with_constraints(constraints))?;
    Ok(Problem { hierarchy, hessian, gradient, constant: *constant })
}
