//! The integration tests, one module a topic.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, missing_docs)]

mod allocation;
mod clock;
mod closed_loop;
mod contact;
mod culling;
mod following_distance;
mod nearness;
mod safety;
mod supervisor;
mod support;
