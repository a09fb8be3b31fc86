//! What the program `actions` is made of: the paper's recognition of actions (Experiment 2).

pub mod clips;
pub mod cut;
pub mod evaluate;
pub mod evaluated;
pub mod features;
pub mod live;
pub mod model;
pub mod network;
pub mod recognise;
pub mod train;
