//! Judgement of answers.

use ahqp_core::Hierarchy;
use proptest::prelude::RngExt;

use super::random;
use crate::exact::{double, solve_exactly};
use crate::extended::solve_extended;

/// Verdict on an answer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Verdict {
    /// The answer is right to 1e-6 (1 + |x|) in each variable.
    Right,
    /// Error of the answer, and the motion of the exact optimum if the data change by 1e-15.
    Wrong { error: f64, sensitivity: f64 },
}

/// Returns the largest difference, each relative to 1 + |b|.
pub(super) fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs() / (1.0 + b.abs())).fold(0.0, f64::max)
}

/// Returns the optimum by exact arithmetic. None if there is none.
pub(super) fn exact_optimum(hierarchy: &Hierarchy, guess: &[f64]) -> Option<Vec<f64>> {
    solve_exactly(hierarchy, guess).map(|exact| exact.iter().map(double).collect())
}

/// Returns the verdict on `x`, by extended precision if that leaves no doubt.
pub(super) fn judge(hierarchy: &Hierarchy, x: &[f64]) -> Verdict {
    let optimum =
        solve_extended(hierarchy, x).or_else(|| exact_optimum(hierarchy, x)).expect("an optimum");
    judge_against(hierarchy, x, &optimum)
}

/// Returns the verdict on `x` if the optimum is known. A point far from it is judged exactly.
pub(super) fn judge_against(hierarchy: &Hierarchy, x: &[f64], optimum: &[f64]) -> Verdict {
    if distance(x, optimum) <= 1e-6 {
        return Verdict::Right;
    }
    let exact = exact_optimum(hierarchy, optimum).expect("an optimum");
    assert!(distance(optimum, &exact) <= 1e-12, "{optimum:?}, but exactly {exact:?}");
    let moved = |seed| {
        let near = perturbed(hierarchy, seed);
        let moved = solve_extended(&near, &exact).or_else(|| exact_optimum(&near, &exact));
        moved.map_or(f64::INFINITY, |x| distance(&x, &exact))
    };
    let sensitivity = (0..4).map(moved).fold(0.0, f64::max);
    Verdict::Wrong { error: distance(x, &exact), sensitivity }
}

/// Returns the hierarchy with every coefficient and target changed by up to 1e-15 of it.
fn perturbed(hierarchy: &Hierarchy, seed: u64) -> Hierarchy {
    let mut random = random(seed);
    let mut other = hierarchy.clone();
    for id in other.ids() {
        let level = other.level_mut(id).unwrap();
        for hard in [true, false] {
            let rows = if hard { Ok(level.constraints_mut()) } else { level.rows_mut() };
            let Ok(rows) = rows else { continue };
            let mut nudge = |value: &mut f64| *value *= 1.0 + random.random_range(-1e-15..1e-15);
            for i in 0..rows.len() {
                rows.row_mut(i).unwrap().iter_mut().for_each(&mut nudge);
                let is_equality = rows.lower()[i] == rows.upper()[i];
                nudge(&mut rows.upper_mut()[i]);
                if is_equality {
                    rows.lower_mut()[i] = rows.upper()[i];
                } else {
                    nudge(&mut rows.lower_mut()[i]);
                }
            }
        }
    }
    other
}
