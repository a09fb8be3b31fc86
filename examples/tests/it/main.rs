//! The integration tests, one module a topic.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, missing_docs)]

mod convert;
mod ergo_map;
mod follow;
mod hqp;
mod programs;
mod reba;
mod record;
mod recording;
mod soak;
mod support;
mod walker;
