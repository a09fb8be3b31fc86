//! Random hierarchies for property tests: of this crate, and of stacks of your own.
//!
//! The strategies make every kind of level (least-squares equalities and ranges, quadratics,
//! hard constraints, bounds), with rows that depend on each other, conflict, repeat earlier
//! rows, vanish or are missing altogether. All data are dyadic fractions, so that dependence is
//! exact and not a matter of tolerances, and hard constraints are feasible by construction:
//! [`Solver::solve`](crate::Solver::solve) succeeds on every one of them.
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

/// How large the hierarchies of a strategy become.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Sizes {
    /// How many variables. Default 1 to 40.
    pub variables: RangeInclusive<usize>,
    /// How many levels. Default 1 to 6.
    pub levels: RangeInclusive<usize>,
    /// How many rows the objective of a level has, and how many its constraints. Default 0 to 10.
    pub rows: RangeInclusive<usize>,
}

impl Default for Sizes {
    fn default() -> Self {
        Self { variables: 1..=40, levels: 1..=6, rows: 0..=10 }
    }
}

/// Hierarchies of levels of all kinds, with a solution.
pub fn hierarchies(sizes: Sizes) -> impl Strategy<Value = Hierarchy> {
    plans(sizes, level_plans).prop_filter_map("sizes agree", |plan| plan.build(0).ok())
}

/// Sequences of `length` hierarchies of one shape, with a solution each: matrices stay, while
/// bounds and targets change at random.
pub fn hierarchy_sequences(sizes: Sizes, length: u64) -> impl Strategy<Value = Vec<Hierarchy>> {
    plans(sizes, level_plans).prop_filter_map("sizes agree", move |plan| {
        (0..length).map(|variation| plan.build(variation).ok()).collect()
    })
}

/// Hierarchies of least-squares equalities alone, without bounds or constraints.
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
    // Levels that hold at one common point can carry constraints that hold there too.
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
