//! The integration tests, one module a topic.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::needless_pass_by_value,
    missing_docs
)]

mod actions;
mod allocation;
mod broken_weights;
mod checkpoint_memory;
mod checkpoints;
mod labels;
mod malformed_checkpoints;
mod networks;
mod preprocessing;
mod support;
mod svm;
mod tracker;
