//! Vectors, products and reflections of rows, least squares: what the solver computes with.

pub(crate) mod kernels;
pub(crate) mod list;
pub(crate) mod vector;
