//! Tests of the C interface, called as C does.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, missing_docs, unsafe_code)]

mod allocation;
mod errors;
