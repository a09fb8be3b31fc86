//! The integration tests, one module a topic.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, missing_docs)]

mod allocation;
mod closed_loop;
mod held_frame;
mod motion;
mod properties;
mod shapes;
mod softening;
mod support;
