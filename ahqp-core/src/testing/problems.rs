//! Problems for benchmarks: sequences of robot-like problems and unrelated random problems. The
//! same seed gives the same problems.

mod manipulator;
mod random_comparison;

use super::random::Random;
use crate::error::Error;
use crate::problem::hierarchy::Hierarchy;
use crate::problem::level::Level;
use crate::problem::rows::Rows;

pub use manipulator::controller_sequence;
pub use random_comparison::random_comparison;

/// Returns problems of a humanoid's size: 38 bounded variables, 60 inequalities, then five levels
/// of 6 to 12 equalities, smooth in time.
///
/// # Errors
/// Those of [`Hierarchy`]'s constructors, which the sizes here do not cause.
pub fn humanoid_sequence(seed: u64, ticks: usize) -> Result<Vec<Hierarchy>, Error> {
    const N: usize = 38;
    const INEQUALITIES: usize = 60;
    let random = &mut Random::new(seed);
    let root = (N as f64).sqrt();
    let tasks: Vec<Task> = [6, 12, 6, 8, 12].map(|rows| Task::new(rows, N, random)).into();
    let still = normal_rows(INEQUALITIES, N, 1.0 / root, random);
    let moving = normal_rows(INEQUALITIES, N, 0.3 / root, random);
    let limits: Vec<f64> = (0..INEQUALITIES).map(|_| random.uniform(0.35, 1.2)).collect();
    let bounds: Vec<f64> = (0..N).map(|_| random.uniform(0.5, 2.0)).collect();
    let at = |tick: usize| {
        let phase = 0.004 * tick as f64;
        let mut hierarchy = Hierarchy::new(N)?;
        let (lower, upper) = hierarchy.bounds_mut();
        for (i, bound) in bounds.iter().enumerate() {
            (lower[i], upper[i]) = (-bound, *bound);
        }
        let mut rows = Rows::zeros(INEQUALITIES, N);
        for i in 0..INEQUALITIES {
            fill(&mut rows, i, |j| still[i][j] + moving[i][j] * (1.3 * phase).sin())?;
            rows.lower_mut()[i] = f64::NEG_INFINITY;
            rows.upper_mut()[i] = limits[i] * (1.0 + 0.2 * (phase + i as f64).sin());
        }
        hierarchy.push(Level::constraints_only(rows))?;
        for task in &tasks {
            hierarchy.push(Level::least_squares(task.at(phase)?))?;
        }
        Ok(hierarchy)
    };
    (0..ticks).map(at).collect()
}

/// Returns hierarchies of variable size: `variables` bounded variables, and one level for each
/// entry of `rows`. A third of the rows are inequalities. All data change a little from tick to
/// tick.
///
/// # Errors
/// [`Error::Value`] if there are no variables.
pub fn growing_sequence(
    seed: u64,
    variables: usize,
    rows: &[usize],
    ticks: usize,
) -> Result<Vec<Hierarchy>, Error> {
    const CHANGE: f64 = 0.02;
    let random = &mut Random::new(seed);
    let root = (variables as f64).sqrt();
    let base: Vec<Vec<GrowingRow>> = rows
        .iter()
        .map(|&m| {
            normal_rows(m, variables, 1.0 / root, random)
                .into_iter()
                .map(|coefficients| GrowingRow {
                    coefficients,
                    target: 0.7 * random.normal(),
                    kind: match random.below(6) {
                        0 => RowKind::OneSided,
                        1 => RowKind::TwoSided,
                        _ => RowKind::Equality,
                    },
                })
                .collect()
        })
        .collect();
    let mut at = |_| {
        let mut hierarchy = Hierarchy::new(variables)?;
        let (lower, upper) = hierarchy.bounds_mut();
        lower.fill(-1.2);
        upper.fill(1.2);
        for level in &base {
            let mut rows = Rows::zeros(level.len(), variables);
            for (i, row) in level.iter().enumerate() {
                fill(&mut rows, i, |j| row.coefficients[j] + CHANGE / root * random.normal())?;
                let upper = row.target + CHANGE * random.normal();
                rows.upper_mut()[i] = upper;
                rows.lower_mut()[i] = match row.kind {
                    RowKind::OneSided => f64::NEG_INFINITY,
                    RowKind::TwoSided => upper - 0.5,
                    RowKind::Equality => upper,
                };
            }
            hierarchy.push(Level::least_squares(rows))?;
        }
        Ok(hierarchy)
    };
    (0..ticks).map(&mut at).collect()
}

struct GrowingRow {
    coefficients: Vec<f64>,
    target: f64,
    kind: RowKind,
}

#[derive(Clone, Copy)]
enum RowKind {
    OneSided,
    TwoSided,
    Equality,
}

/// A task of the humanoid, with rows and targets that oscillate.
struct Task {
    rows: [Vec<Vec<f64>>; 2],
    targets: [Vec<f64>; 2],
}

impl Task {
    fn new(count: usize, columns: usize, random: &mut Random) -> Self {
        let scale = 1.0 / (columns as f64).sqrt();
        let mut rows = [0, 1].map(|_| normal_rows(count, columns, scale, random));
        // Every task lacks some limbs. The first six variables, the floating base, affect all
        // tasks.
        for j in 6..columns {
            if random.chance(0.35) {
                rows.iter_mut().flatten().for_each(|row| row[j] = 0.0);
            }
        }
        let targets = [0, 1].map(|_| (0..count).map(|_| 0.5 * random.normal()).collect());
        Self { rows, targets }
    }

    fn at(&self, phase: f64) -> Result<Rows, Error> {
        let [first, second] = &self.rows;
        let columns = first.first().map_or(0, Vec::len);
        let mut rows = Rows::zeros(first.len(), columns);
        for i in 0..first.len() {
            fill(&mut rows, i, |j| first[i][j] * phase.cos() + 0.6 * second[i][j] * phase.sin())?;
            let target =
                self.targets[0][i] * (3.0 * phase).cos() + self.targets[1][i] * (5.0 * phase).sin();
            (rows.lower_mut()[i], rows.upper_mut()[i]) = (target, target);
        }
        Ok(rows)
    }
}

fn normal_rows(rows: usize, columns: usize, scale: f64, random: &mut Random) -> Vec<Vec<f64>> {
    let mut row = || (0..columns).map(|_| scale * random.normal()).collect();
    (0..rows).map(|_| row()).collect()
}

fn fill(rows: &mut Rows, index: usize, value: impl FnMut(usize) -> f64) -> Result<(), Error> {
    let row = rows.row_mut(index)?;
    let columns = row.len();
    row.iter_mut().zip((0..columns).map(value)).for_each(|(to, from)| *to = from);
    Ok(())
}
