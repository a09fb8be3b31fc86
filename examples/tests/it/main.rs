//! The integration tests, one module a topic.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::print_stderr,
    missing_docs
)]

mod actions;
mod calibrate;
mod chain;
mod convert;
mod drive;
mod ergo_map;
mod experiment;
mod experiment_recordings;
mod files;
mod film;
mod follow;
mod hqp;
mod ik;
mod infer_arrays;
mod infer_clips;
mod infer_images;
mod lockstep;
#[cfg(feature = "mcap")]
mod mcap_files;
mod measured_posture;
mod page;
mod perceive;
mod perceive_networks;
mod programs;
mod reba;
mod record;
mod robot_packets;
mod robot_side;
#[cfg(feature = "ros2")]
mod ros2;
mod settings;
mod settings_ranges;
mod shards;
mod support;
mod surface;
mod tlx;
mod unfinished;
mod vision_programs;
