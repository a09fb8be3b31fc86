//! Construction of a hierarchy from a plan, which proptest can shrink.

use nalgebra::{DMatrix, DVector};

use super::random::Random;
use crate::error::Error;
use crate::problem::hierarchy::Hierarchy;
use crate::problem::level::Level;
use crate::problem::rows::Rows;

/// Objective of a level.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    None,
    Equalities,
    Ranges,
    Quadratic,
}

#[derive(Debug, Clone)]
pub(super) struct LevelPlan {
    pub(super) kind: Kind,
    pub(super) rows: usize,
    /// Number of rows of its constraints. They are left out if they could not be satisfied.
    pub(super) constraints: usize,
    /// True if some rows are combinations of others.
    pub(super) deficient: bool,
    /// True if some rows repeat earlier ones, and some are zero.
    pub(super) repeats: bool,
    pub(super) seed: u64,
}

#[derive(Debug, Clone)]
pub(super) struct HierarchyPlan {
    pub(super) variables: usize,
    pub(super) bounded: bool,
    /// Number of first levels whose optimum is at a common point.
    pub(super) consistent: usize,
    pub(super) levels: Vec<LevelPlan>,
    pub(super) seed: u64,
}

/// Probability that a range is an equality, and otherwise that its lower side is free. `exact`
/// tells whether the ends of the range may be the value itself.
#[derive(Clone, Copy)]
struct Shares {
    equal: f64,
    one_sided: f64,
    exact: bool,
}

impl HierarchyPlan {
    /// Builds the hierarchy. `variation` changes only its bounds and targets.
    pub(super) fn build(&self, variation: u64) -> Result<Hierarchy, Error> {
        let n = self.variables;
        let mut hierarchy = Hierarchy::new(n)?;
        let mut random = Random::new(self.seed.wrapping_add(variation));
        let point: Vec<f64> = (0..n).map(|_| random.dyadic() / 4.0).collect();
        let slack = self.slack_level();
        let closed = self.bounded && slack.is_none() && self.seed.is_multiple_of(2);
        if self.bounded {
            let shares =
                Shares { equal: 0.05, one_sided: if closed { 0.0 } else { 0.2 }, exact: true };
            let (lower, upper) = hierarchy.bounds_mut();
            for (i, &value) in point.iter().enumerate() {
                (lower[i], upper[i]) = range_around(value, shares, &mut random);
            }
        }
        if slack.is_some() {
            let (lower, upper) = hierarchy.bounds_mut();
            (lower[n - 1], upper[n - 1]) = (f64::NEG_INFINITY, f64::INFINITY);
        }
        let mut pool = Vec::new();
        for (k, plan) in self.levels.iter().enumerate() {
            let mut matrices = Random::new(plan.seed);
            let mut objective = plan.matrix(plan.rows, n, &mut pool, &mut matrices);
            let mut constraints = plan.matrix(plan.constraints, n, &mut pool, &mut matrices);
            // The slack variable is free until the level that needs it.
            if slack.is_some_and(|level| k <= level) {
                set_last(&mut objective, 0.0);
                set_last(&mut constraints, if slack == Some(k) { -1.0 } else { 0.0 });
            }
            let mut targets = Random::new(plan.seed ^ self.seed.wrapping_add(variation));
            let consistent = (k < self.consistent).then_some(&point[..]);
            let level = plan.objective(&objective, n, consistent, closed, &mut targets)?;
            hierarchy.push(if k <= self.consistent {
                let around = |row: &[f64], _: &mut Random| dot(row, &point);
                // The optimum of ½xᵀHx + gᵀx is known only up to cond(H), so it needs some room.
                let above = &self.levels[..k];
                let shares = Shares { exact: above.iter().all(LevelPlan::is_exact), ..CONSTRAINT };
                level.with_constraints(rows(&constraints, n, shares, &mut targets, around)?)
            } else if slack == Some(k) {
                let mut rows = rows(&constraints, n, CONSTRAINT, &mut targets, |_, _| 0.0)?;
                rows.lower_mut().fill(f64::NEG_INFINITY);
                level.with_constraints(rows)
            } else {
                level
            })?;
        }
        Ok(hierarchy)
    }

    /// Returns the level whose constraints a x − s ≤ b can always hold, by a variable s that no
    /// level above affects. None if there is no such level.
    fn slack_level(&self) -> Option<usize> {
        let mut later = self.levels.iter().enumerate().skip(self.consistent + 1);
        let found = later.find(|(_, plan)| plan.constraints > 0).map(|(k, _)| k);
        found.filter(|_| self.variables > 1)
    }
}

const CONSTRAINT: Shares = Shares { equal: 0.1, one_sided: 0.6, exact: true };

impl LevelPlan {
    fn is_exact(&self) -> bool {
        self.kind != Kind::Quadratic
    }

    /// Returns rows of dyadic fractions, including dependent ones as planned.
    fn matrix(
        &self,
        rows: usize,
        columns: usize,
        pool: &mut Vec<Vec<f64>>,
        random: &mut Random,
    ) -> Vec<Vec<f64>> {
        let rank = if self.deficient { 1 + random.below(rows) } else { rows };
        let scale = [1.0, 1.0, 1.0, 0.125, 16.0][random.below(5)];
        let mut matrix: Vec<Vec<f64>> = Vec::with_capacity(rows);
        for i in 0..rows {
            let row = if self.repeats && !pool.is_empty() && random.chance(0.25) {
                let factor = if random.chance(0.5) { 1.0 } else { -2.0 };
                pool[random.below(pool.len())].iter().map(|entry| factor * entry).collect()
            } else if self.repeats && random.chance(0.05) {
                vec![0.0; columns]
            } else if i < rank {
                (0..columns).map(|_| scale * random.dyadic()).collect()
            } else {
                combination(&matrix[..rank], columns, random)
            };
            matrix.push(row);
        }
        // Combinations of combinations would grow without bound.
        pool.extend(matrix.iter().filter(|row| row.iter().all(|v| v.abs() <= 64.0)).cloned());
        matrix
    }

    /// Returns the level without constraints. Its optimum is at `consistent`, if that is given.
    fn objective(
        &self,
        matrix: &[Vec<f64>],
        n: usize,
        consistent: Option<&[f64]>,
        closed: bool,
        random: &mut Random,
    ) -> Result<Level, Error> {
        let equal = if self.kind == Kind::Ranges { 0.5 } else { 1.0 };
        let shares = Shares { equal, one_sided: 0.4, exact: true };
        let target = |row: &[f64], random: &mut Random| {
            consistent.map_or_else(|| 4.0 * random.dyadic(), |x| dot(row, x))
        };
        let objective = rows(matrix, n, shares, random, target)?;
        match self.kind {
            Kind::None => Ok(Level::constraints_only(Rows::zeros(0, n))),
            Kind::Equalities | Kind::Ranges => Ok(Level::least_squares(objective)),
            Kind::Quadratic => {
                let a = DMatrix::from_fn(matrix.len(), n, |i, j| matrix[i][j]);
                let b = DVector::from_column_slice(objective.upper());
                // Outside the range of H the objective is linear, and only bounds limit it.
                let tilt = if closed && consistent.is_none() { 1.0 } else { 0.0 };
                let tilt = DVector::from_fn(n, |_, _| tilt * random.dyadic());
                Level::quadratic(&a.tr_mul(&a), &(tilt - a.tr_mul(&b)))
            }
        }
    }
}

/// Returns `matrix` with ranges that contain the value of `target`.
fn rows(
    matrix: &[Vec<f64>],
    columns: usize,
    shares: Shares,
    random: &mut Random,
    target: impl Fn(&[f64], &mut Random) -> f64,
) -> Result<Rows, Error> {
    let mut rows = Rows::zeros(matrix.len(), columns);
    for (i, coefficients) in matrix.iter().enumerate() {
        let (lower, upper) = range_around(target(coefficients, random), shares, random);
        rows.set_row(i, coefficients, lower, upper)?;
    }
    Ok(rows)
}

/// Returns a range that contains `value`, sometimes at its end.
fn range_around(value: f64, shares: Shares, random: &mut Random) -> (f64, f64) {
    if shares.exact && random.chance(shares.equal) {
        return (value, value);
    }
    let mut margin = || match (shares.exact, random.chance(0.2)) {
        (true, true) => 0.0,
        (true, false) => random.dyadic().abs(),
        (false, _) => random.dyadic().abs() + 0.0625,
    };
    let (below, above) = (margin(), margin());
    let lower = if random.chance(shares.one_sided) { f64::NEG_INFINITY } else { value - below };
    (lower, value + above)
}

fn combination(rows: &[Vec<f64>], columns: usize, random: &mut Random) -> Vec<f64> {
    let mut sum = vec![0.0; columns];
    for row in rows {
        let weight = [-1.0, 0.0, 1.0][random.below(3)];
        sum.iter_mut().zip(row).for_each(|(to, from)| *to += weight * from);
    }
    sum
}

fn set_last(matrix: &mut [Vec<f64>], value: f64) {
    for last in matrix.iter_mut().filter_map(|row| row.last_mut()) {
        *last = value;
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}
