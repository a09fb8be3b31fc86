//! Parts of the program `surface`: the paper's classification of surfaces (Experiment 1).

pub mod cut;
pub mod evaluate;
pub mod generate;
pub mod options;
pub mod train;
