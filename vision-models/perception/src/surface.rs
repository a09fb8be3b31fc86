//! The paper's surface classification (Experiment 1).

pub mod cut;
pub mod features;
pub mod model;
pub mod picture;
pub mod training;
