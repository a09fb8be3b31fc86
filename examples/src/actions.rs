//! Parts of the program `actions`: the paper's recognition of actions (Experiment 2).

pub mod cut;
pub mod evaluate;
pub mod options;
pub mod train;
