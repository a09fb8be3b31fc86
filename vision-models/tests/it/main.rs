//! The integration tests, one module per topic.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::needless_pass_by_value,
    missing_docs
)]

mod actions;
mod allocation;
#[cfg(feature = "inference")]
mod blaze_pose;
#[cfg(feature = "inference")]
mod broken_weights;
#[cfg(feature = "inference")]
mod calibration;
#[cfg(feature = "inference")]
mod checkpoint_memory;
#[cfg(feature = "inference")]
mod checkpoints;
#[cfg(feature = "inference")]
mod engine;
#[cfg(feature = "inference")]
mod graphs;
#[cfg(feature = "inference")]
mod heads;
mod hidden;
#[cfg(feature = "inference")]
mod inflated;
#[cfg(feature = "inference")]
mod joint_files;
#[cfg(feature = "inference")]
mod jpegs;
mod jumps;
#[cfg(feature = "inference")]
mod labels;
mod lifting;
#[cfg(feature = "inference")]
mod malformed_checkpoints;
mod monocular;
#[cfg(feature = "inference")]
mod networks;
#[cfg(feature = "inference")]
mod part_grouping;
#[cfg(feature = "inference")]
mod placement;
mod pose;
#[cfg(feature = "inference")]
mod prefixes;
#[cfg(feature = "inference")]
mod preprocessing;
mod random;
mod real_motion;
#[cfg(feature = "inference")]
mod support;
#[cfg(feature = "inference")]
mod svm;
#[cfg(feature = "inference")]
mod tensorflow_lite;
mod tracker;
mod triangulation;
