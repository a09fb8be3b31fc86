//! Random sequences of hierarchies whose rows have very different weights.

use std::ops::RangeInclusive;

use ahqp_core::{Hierarchy, Level, Rows};
use nalgebra::{DMatrix, DVector};
use proptest::prelude::*;
use proptest::test_runner::TestRng;

/// Random hierarchies of one shape whose rows have weights 10^U(−spread, spread). All variables are
/// bounded, and the last level is near a target.
pub(super) struct Shape {
    variables: usize,
    levels: Vec<usize>,
    hard: usize,
    spread: f64,
    /// Weight of each row of the levels.
    weights: Vec<f64>,
    coefficients: Vec<f64>,
    equality: Vec<bool>,
}

impl Shape {
    pub(super) fn random(random: &mut TestRng, variables: usize, spread: f64) -> Self {
        let levels: Vec<usize> = (0..random.random_range(1..=3))
            .map(|_| random.random_range(1..=variables.min(5)))
            .collect();
        let hard = random.random_range(0..=2);
        let count = levels.iter().sum::<usize>() + hard;
        Self {
            variables,
            hard,
            spread,
            weights: (0..count)
                .map(|_| 10_f64.powf(random.random_range(-spread..=spread)))
                .collect(),
            coefficients: (0..count * variables).map(|_| random.random_range(-1.0..1.0)).collect(),
            equality: (0..count).map(|_| random.random_bool(0.6)).collect(),
            levels,
        }
    }

    /// Returns a tick with the same rows, slightly changed, and targets that jump.
    pub(super) fn tick(&self, random: &mut TestRng) -> Hierarchy {
        let n = self.variables;
        let mut hierarchy = Hierarchy::new(n).unwrap();
        let (lower, upper) = hierarchy.bounds_mut();
        lower.fill(-1.0);
        upper.fill(1.0);
        let mut at = 0;
        let mut hard = Some(self.hard);
        for &count in &self.levels {
            let rows = self.rows(random, &mut at, count, false);
            let mut level = Level::least_squares(rows);
            if let Some(hard) = hard.take() {
                level = level.with_constraints(self.rows(random, &mut at, hard, true));
            }
            hierarchy.push(level).unwrap();
        }
        let near = DVector::from_fn(n, |_, _| random.random_range(-1.5..1.5));
        let identity = DMatrix::identity(n, n) * 10_f64.powf(-self.spread);
        let near = near * 10_f64.powf(-self.spread);
        hierarchy.push(Level::least_squares(Rows::equalities(&identity, &near).unwrap())).unwrap();
        hierarchy
    }

    fn rows(&self, random: &mut TestRng, at: &mut usize, count: usize, hard: bool) -> Rows {
        let n = self.variables;
        let mut rows = Rows::zeros(count, n);
        for i in 0..count {
            let weight = self.weights[*at];
            let row = &self.coefficients[*at * n..(*at + 1) * n];
            for (to, from) in rows.row_mut(i).unwrap().iter_mut().zip(row) {
                *to = weight * (from + 1e-3 * random.random_range(-1.0..1.0));
            }
            let far = if random.random_bool(0.1) { 100.0 } else { 2.0 };
            let target = weight * random.random_range(-far..far);
            // Zero satisfies every hard row.
            let (lower, upper) = if hard {
                (-target.abs(), random.random_range(0.0..1.0) * weight)
            } else if self.equality[*at] {
                (target, target)
            } else {
                (target, target + weight * random.random_range(0.0..1.0))
            };
            (rows.lower_mut()[i], rows.upper_mut()[i]) = (lower, upper);
            *at += 1;
        }
        rows
    }
}

/// Returns four ticks of a random shape.
pub(super) fn sequence(
    random: &mut TestRng,
    variables: RangeInclusive<usize>,
    spread: f64,
) -> Vec<Hierarchy> {
    let n = random.random_range(variables);
    let shape = Shape::random(random, n, spread);
    (0..4).map(|_| shape.tick(random)).collect()
}

/// Returns four ticks of one level: a task of rows of weights 10³ and 1 above a posture of weight
/// 10⁻⁵, which presses against bounds.
pub(super) fn task_over_posture(random: &mut TestRng) -> Vec<Hierarchy> {
    const POSTURE: f64 = 1e-5;
    let n = random.random_range(3..=10);
    let mut shape = Shape::random(random, n, 0.0);
    let task = random.random_range(1..=n);
    shape.levels = vec![task];
    let count = task + shape.hard;
    shape.weights = (0..count).map(|_| [1e3, 1.0][random.random_range(0..2)]).collect();
    shape.coefficients = (0..count * n).map(|_| random.random_range(-1.0..1.0)).collect();
    shape.equality = (0..count).map(|_| random.random_bool(0.8)).collect();
    let tick = |random: &mut TestRng| {
        let (mut at, mut rows) = (0, Rows::zeros(task + n, n));
        for (i, (row, lower, upper)) in shape.rows(random, &mut at, task, false).iter().enumerate()
        {
            rows.row_mut(i).unwrap().copy_from_slice(row);
            (rows.lower_mut()[i], rows.upper_mut()[i]) = (lower, upper);
        }
        for j in 0..n {
            rows.row_mut(task + j).unwrap()[j] = POSTURE;
            let target = POSTURE * random.random_range(-1.5..1.5);
            (rows.lower_mut()[task + j], rows.upper_mut()[task + j]) = (target, target);
        }
        let hard = shape.rows(random, &mut at, shape.hard, true);
        let mut hierarchy = Hierarchy::new(n).unwrap();
        let (lower, upper) = hierarchy.bounds_mut();
        lower.fill(-1.0);
        upper.fill(1.0);
        hierarchy.push(Level::least_squares(rows).with_constraints(hard)).unwrap();
        hierarchy
    };
    (0..4).map(|_| tick(random)).collect()
}

/// Rounds coefficients to −1, 0 and 1 and targets to halves, and multiplies each row by a power of
/// two near its weight. Rows are then exact combinations of others, and bounds meet in one point.
pub(super) fn with_ties(mut hierarchy: Hierarchy) -> Hierarchy {
    for id in hierarchy.ids().collect::<Vec<_>>() {
        let level = hierarchy.level_mut(id).unwrap();
        for hard in [true, false] {
            let rows = if hard { level.constraints_mut() } else { level.rows_mut().unwrap() };
            for i in 0..rows.len() {
                let row = rows.row_mut(i).unwrap();
                let largest = row.iter().fold(0.0_f64, |largest, a| largest.max(a.abs()));
                let weight = largest.log2().floor().exp2();
                for a in row {
                    *a = (*a / weight).round() * weight;
                }
                for hand in [Rows::lower_mut, Rows::upper_mut] {
                    let bound = &mut hand(rows)[i];
                    *bound = (2.0 * *bound / weight).round() / 2.0 * weight;
                }
            }
        }
    }
    hierarchy
}
