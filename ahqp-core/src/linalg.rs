//! Vectors, products and reflections of rows, and least squares.

pub(crate) mod kernels;
pub(crate) mod list;
pub(crate) mod vector;
