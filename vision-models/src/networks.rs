//! The paper's networks and related ones.
// Views are small. They are passed by value, as usual with ndarray.
#![allow(clippy::needless_pass_by_value)]

mod architecture;
mod clips;
mod inflated;
mod kind;
mod resnet;
mod slow_fast;
mod slow_only;
mod stream;
mod tensorflow_lite;

pub use architecture::{
    OpenPoseForm, ResNetDepth, ResNetForm, SimpleBaselineForm, SlowFastForm, SlowOnlyForm,
};
pub use inflated::InflatedResNet;
pub use kind::NetworkKind;
pub use resnet::ResNet;
pub use slow_fast::SlowFast;
pub use slow_only::SlowOnly;
pub use stream::SlowOnlyStream;
pub use tensorflow_lite::TensorFlowLite;
