//! The paper's action recognition (Experiment 2).

pub mod clips;
pub mod cut;
pub mod evaluated;
pub mod features;
pub mod model;
pub mod training;
pub mod window;
