//! What is known of the robot now: one thread's memory, and views that say what it holds.

mod attachment;
pub(crate) mod data;
pub(crate) mod moving;
pub(crate) mod payload;
pub(crate) mod posed;

pub use crate::dynamics::external::ExternalWrench;
pub use payload::{Payload, PayloadId};
