//! C interface of `ahqp-core` and of `whole-body`'s inverse kinematics. `include/ahqp.h` declares it, and
//! `include/ahqp.hpp` is a C++17 layer over it.
//!
//! Every function checks its pointers for null and its sizes, returns an [`AhqpStatus`] and keeps the
//! text of an error for [`ahqp_last_error`](failure::ahqp_last_error). A panic becomes
//! [`AhqpStatus::Panic`]. Handles are made by `ahqp_…_new` and freed by `ahqp_…_free`; a handle is used
//! by one thread at a time.

// A foreign interface needs unsafe code: each block says why it is sound.
#![allow(unsafe_code)]

pub mod failure;
mod handle;
pub mod hierarchy;
pub mod ik;
pub mod model;
pub mod solver;
pub mod views;

pub use failure::AhqpStatus;
