//! The integration tests, one module a topic.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::print_stdout,
    missing_docs
)]

mod allocation;
mod body;
mod continuous;
mod map;
mod measured;
mod measured_people;
mod measured_posture;
mod measured_singularities;
mod predict;
mod quadratic;
mod ranking;
mod reba;
mod rula;
mod support;
