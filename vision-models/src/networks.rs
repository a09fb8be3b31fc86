//! The paper's networks.
// Views are small, and given by value as everywhere with ndarray.
#![allow(clippy::needless_pass_by_value)]

mod backbone;
mod graph;
mod head;
mod kind;
mod memory;
mod naming;
mod network;
mod parameters;
mod plan;
mod resnet;
mod session;
mod shapes;
mod slow_fast;
mod slow_only;
mod stream;
#[cfg(test)]
mod tests;

pub use backbone::ResNetDepth;
pub use kind::NetworkKind;
pub use network::{Options, Scores};
pub use resnet::ResNet;
pub use slow_fast::SlowFast;
pub use slow_only::{SlowOnly, SlowOnlyForm};
pub use stream::SlowOnlyStream;
