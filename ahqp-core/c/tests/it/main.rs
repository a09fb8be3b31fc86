//! What must be true of the C interface, called as C does.

#![allow(unsafe_code)]

mod allocation;
mod errors;
