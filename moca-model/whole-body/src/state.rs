//! The present state of the robot: the memory of one thread, and views of what it holds.

mod attachment;
pub(crate) mod data;
pub(crate) mod moving;
pub(crate) mod payload;
pub(crate) mod posed;

pub use crate::dynamics::external::ExternalWrench;
pub use payload::{Payload, PayloadId};
