//! What the program `surface` is made of: the paper's classification of surfaces (Experiment 1).

pub mod cut;
pub mod evaluate;
pub mod features;
pub mod generate;
pub mod model;
pub mod options;
pub mod picture;
pub mod predict;
pub mod train;
