//! The paper's classification of surfaces (Experiment 1).

pub mod features;
pub mod model;
pub mod picture;
