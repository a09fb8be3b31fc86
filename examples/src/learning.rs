//! Parts that the programs `surface` and `actions` share.

pub mod cut_options;
pub mod head_options;
