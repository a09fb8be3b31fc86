//! The layers of the networks, for each form of checkpoint.

mod backbone;
mod naming;
pub(super) mod open_pose;
pub(super) mod resnet;
pub(super) mod simple_baseline;
pub(super) mod slow_fast;
pub(super) mod slow_only;

pub use backbone::ResNetDepth;
pub use open_pose::OpenPoseForm;
pub use resnet::ResNetForm;
pub use simple_baseline::SimpleBaselineForm;
pub use slow_fast::SlowFastForm;
pub use slow_only::SlowOnlyForm;
