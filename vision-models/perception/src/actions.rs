//! The paper's recognition of actions (Experiment 2).

pub mod clips;
pub mod evaluated;
pub mod features;
pub mod live;
pub mod model;
pub mod window;
