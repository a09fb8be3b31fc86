//! What the programs `surface` and `actions` share.

pub mod cutting;
pub mod head_options;
