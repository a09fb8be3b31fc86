//! The integration tests, one module a topic.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, missing_docs)]

mod allocation;
mod bad_input;
mod budgets;
mod certificate;
mod exact;
mod extended;
mod feasibility;
mod fuzz;
mod hard_cases;
mod holding;
mod infeasible;
mod jerk_limits;
mod names;
mod near_ticks;
mod properties;
mod random_comparison;
mod rows;
mod scales;
mod settings;
mod small_terms;
mod stacking;
mod support;
mod weights;
mod written;
