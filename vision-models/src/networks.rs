//! The paper's networks, and their kin.
// Views are small, and given by value as everywhere with ndarray.
#![allow(clippy::needless_pass_by_value)]

mod backbone;
mod clips;
mod kind;
mod naming;
mod open_pose;
mod resnet;
mod simple_baseline;
mod slow_fast;
mod slow_only;
mod stream;

pub use backbone::ResNetDepth;
pub use kind::NetworkKind;
pub use open_pose::OpenPoseForm;
pub use resnet::{ResNet, ResNetForm};
pub use simple_baseline::SimpleBaselineForm;
pub use slow_fast::{SlowFast, SlowFastForm};
pub use slow_only::{SlowOnly, SlowOnlyForm};
pub use stream::SlowOnlyStream;
