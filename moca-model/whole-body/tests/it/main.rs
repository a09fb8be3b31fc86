//! The integration tests, one module a topic.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, missing_docs)]

mod allocation;
mod bad_input;
mod bad_urdf;
mod description;
mod dynamics;
mod golden;
mod kinematics;
mod parsed;
mod placement;
mod support;
