//! Writes the benchmarks' problems as text, for other solvers:
//! `cargo run --release -p ahqp-core --features testing --example write_problems -- FOLDER [SEED]`.
#![allow(missing_docs)]

use std::error::Error;
use std::fs::{File, create_dir_all};
use std::io::{BufWriter, Write};
use std::path::Path;

use ahqp_core::testing::problems::{
    controller_sequence, growing_sequence, humanoid_sequence, random_comparison,
};
use ahqp_core::{Hierarchy, Objective, Rows};

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let folder = arguments.next().ok_or("give the folder to write to")?;
    let seed = arguments.next().map_or(Ok(1), |seed| seed.parse::<u64>())?;
    create_dir_all(&folder)?;
    let write = |name: &str, problems: &[Hierarchy]| {
        write_set(&Path::new(&folder).join(format!("{name}.hqp")), name, problems)
    };
    write("a_seq", &controller_sequence(seed, 2000)?)?;
    write("b_seq", &humanoid_sequence(seed, 300)?)?;
    for n in [10, 20, 40, 80, 160] {
        let ticks = if n > 80 { 10 } else { 100 };
        let rows = [n / 3, n / 3, n / 2];
        write(&format!("d_n{n}"), &growing_sequence(seed, n, &rows, ticks)?)?;
    }
    for levels in [2, 4, 8] {
        let rows = vec![48 / levels; levels];
        write(&format!("d_p{levels}"), &growing_sequence(seed, 40, &rows, 100)?)?;
    }
    for percent in [0, 20, 50, 80, 100] {
        let problems = random_comparison(seed, f64::from(percent) / 100.0, 100)?;
        write(&format!("p_eq{percent:02}"), &problems)?;
    }
    Ok(())
}

fn write_set(path: &Path, name: &str, problems: &[Hierarchy]) -> std::io::Result<()> {
    let mut out = BufWriter::new(File::create(path)?);
    writeln!(out, "hqpset {name} {}", problems.len())?;
    for (index, problem) in problems.iter().enumerate() {
        // The bounds come first, then the constraints and objectives that are not empty.
        let levels: Vec<(u8, &Rows)> = problem
            .levels()
            .iter()
            .flat_map(|level| {
                let objective = match level.objective() {
                    Objective::LeastSquares(rows) => Some((0, rows)),
                    _ => None,
                };
                [(!level.constraints().is_empty()).then_some((1, level.constraints())), objective]
            })
            .flatten()
            .collect();
        writeln!(out, "problem {index} t{index} {} {}", problem.variables(), levels.len() + 1)?;
        write_bounds(&mut out, problem)?;
        for (hard, rows) in levels {
            write_rows(&mut out, hard, rows)?;
        }
    }
    out.flush()
}

/// Writes the bounds of the variables that have any.
fn write_bounds(out: &mut impl Write, problem: &Hierarchy) -> std::io::Result<()> {
    let bounds = problem.lower().iter().zip(problem.upper());
    let finite: Vec<_> =
        bounds.enumerate().filter(|(_, (l, u))| l.is_finite() || u.is_finite()).collect();
    writeln!(out, "level B 1 {}", finite.len())?;
    for (variable, (&lower, &upper)) in finite {
        writeln!(out, "{variable} {} {}", number(lower), number(upper))?;
    }
    Ok(())
}

fn write_rows(out: &mut impl Write, hard: u8, rows: &Rows) -> std::io::Result<()> {
    writeln!(out, "level G {hard} {}", rows.len())?;
    for (coefficients, lower, upper) in rows.iter() {
        for coefficient in coefficients {
            write!(out, "{} ", number(*coefficient))?;
        }
        writeln!(out, "{} {}", number(lower), number(upper))?;
    }
    Ok(())
}

/// Formats a number without loss. ±1e30 stands for infinity.
fn number(value: f64) -> String {
    if value.is_finite() {
        value.to_string()
    } else {
        format!("{}1e30", if value > 0.0 { "" } else { "-" })
    }
}
