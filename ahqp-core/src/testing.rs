//! Random hierarchies for property tests of this crate, and of your own stacks.
//!
//! The strategies generate every kind of level: least-squares equalities and ranges, quadratics,
//! hard constraints and bounds. Rows may depend on each other, conflict, repeat earlier rows, be
//! zero, or be missing.
//!
//! All data are dyadic fractions, so that dependence is exact and independent of tolerances. Hard
//! constraints are feasible by construction: [`Solver::solve`](crate::Solver::solve) succeeds for
//! every hierarchy.
//!
//! ```
//! use ahqp_core::testing::{Sizes, hierarchies};
//! use ahqp_core::{Settings, Solver, Status};
//! use proptest::prelude::*;
//!
//! proptest!(|(hierarchy in hierarchies(Sizes { variables: 1..=8, ..Sizes::default() }))| {
//!     let mut solver = Solver::new(&hierarchy, Settings::default())?;
//!     prop_assert_eq!(solver.solve(&hierarchy)?.status(), Status::Solved);
//! });
//! ```
//!
pub mod problems;

mod build;
mod random;

use std::ops::RangeInclusive;

use proptest::prelude::*;

use crate::problem::hierarchy::Hierarchy;
use build::{HierarchyPlan, Kind, LevelPlan};

/// Sizes of the hierarchies of a strategy.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Sizes {
    /// Number of variables. Default 1 to 40.
    pub variables: RangeInclusive<usize>,
    /// Number of levels. Default 1 to 6.
    pub levels: RangeInclusive<usize>,
    /// Number of rows of a level's objective, and of its constraints. Default 0 to 10.
    pub rows: RangeInclusive<usize>,
}

impl Default for Sizes {
    fn default() -> Self {
        Self { variables: 1..=40, levels: 1..=6, rows: 0..=10 }
    }
}

/// Generates hierarchies of levels of all kinds, which have a solution.
pub fn hierarchies(sizes: Sizes) -> impl Strategy<Value = Hierarchy> {
    plans(sizes, level_plans).prop_filter_map("sizes agree", |plan| plan.build(0).ok())
}

/// Generates sequences of `length` hierarchies of one shape, which have a solution each. Matrices
/// stay, while bounds and targets change at random.
pub fn hierarchy_sequences(sizes: Sizes, length: u64) -> impl Strategy<Value = Vec<Hierarchy>> {
    plans(sizes, level_plans).prop_filter_map("sizes agree", move |plan| {
        (0..length).map(|variation| plan.build(variation).ok()).collect()
    })
}

/// Generates hierarchies of least-squares equalities alone, without bounds or constraints.
pub fn equality_hierarchies(sizes: Sizes) -> impl Strategy<Value = Hierarchy> {
    plans(sizes, |rows| {
        level_plans(rows).prop_map(|plan| LevelPlan {
            kind: Kind::Equalities,
            constraints: 0,
            ..plan
        })
    })
    .prop_filter_map("sizes agree", |plan| HierarchyPlan { bounded: false, ..plan }.build(0).ok())
}

fn plans<S: Strategy<Value = LevelPlan>>(
    sizes: Sizes,
    level: impl Fn(RangeInclusive<usize>) -> S,
) -> impl Strategy<Value = HierarchyPlan> {
    let levels = prop::collection::vec(level(sizes.rows), sizes.levels.clone());
    // If levels hold at a common point, their constraints can hold there too.
    let consistent = 0..=*sizes.levels.end();
    let seed = any::<u64>().no_shrink();
    (sizes.variables, levels, any::<bool>(), consistent, seed).prop_map(
        |(variables, levels, bounded, consistent, seed)| HierarchyPlan {
            variables,
            bounded,
            consistent,
            levels,
            seed,
        },
    )
}

fn level_plans(rows: RangeInclusive<usize>) -> impl Strategy<Value = LevelPlan> {
    let kind = prop_oneof![
        1 => Just(Kind::None),
        4 => Just(Kind::Equalities),
        4 => Just(Kind::Ranges),
        2 => Just(Kind::Quadratic),
    ];
    let constraints = prop_oneof![2 => Just(0), 1 => rows.clone()];
    let seed = any::<u64>().no_shrink();
    (kind, rows, constraints, any::<bool>(), any::<bool>(), seed).prop_map(
        |(kind, rows, constraints, deficient, repeats, seed)| LevelPlan {
            kind,
            rows,
            constraints,
            deficient,
            repeats,
            seed,
        },
    )
}
