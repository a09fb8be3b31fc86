//! The integration tests, one module a topic.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::print_stdout,
    missing_docs
)]

mod bystanders;
mod calm;
mod calmness;
mod experiment;
mod experiment_recordings;
mod limits;
mod run;
mod silence;
mod soak;
mod stillness;
mod support;
mod walker;
mod wanderer;
mod workcell;
