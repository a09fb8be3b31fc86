//! The networks of this crate, and which of them a checkpoint holds.

use std::fmt;

use crate::TensorSource;

use super::backbone::ResNetDepth;
use super::graph::Architecture;
use super::slow_only::SlowOnlyForm;
use super::{resnet, slow_fast, slow_only};

/// A network by its architecture and the names of its checkpoint.
///
/// ```
/// use vision_models::{NetworkKind, ResNet, ResNetDepth, Tensor, Tensors};
///
/// let mut checkpoint = Tensors::new();
/// for (name, shape) in ResNet::parameters(ResNetDepth::Eighteen, 10) {
///     let elements = vec![0.0; shape.iter().product()];
///     checkpoint.insert(name, Tensor::new(shape, elements)?)?;
/// }
/// let kind = NetworkKind::of(&checkpoint);
/// assert_eq!(kind, Some(NetworkKind::ResNet(ResNetDepth::Eighteen)));
/// assert_eq!(kind.unwrap().to_string(), "ResNet-18");
/// # Ok::<(), vision_models::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NetworkKind {
    /// [`ResNet`](crate::ResNet).
    ResNet(ResNetDepth),
    /// [`SlowOnly`](crate::SlowOnly).
    SlowOnly(SlowOnlyForm),
    /// [`SlowFast`](crate::SlowFast).
    SlowFast,
}

impl NetworkKind {
    /// Every network of this crate.
    pub const ALL: [Self; 9] = [
        Self::ResNet(ResNetDepth::Eighteen),
        Self::ResNet(ResNetDepth::ThirtyFour),
        Self::ResNet(ResNetDepth::Fifty),
        Self::ResNet(ResNetDepth::OneHundredOne),
        Self::ResNet(ResNetDepth::OneHundredFiftyTwo),
        Self::SlowOnly(SlowOnlyForm::MmAction2),
        Self::SlowOnly(SlowOnlyForm::MmAction2Depth18),
        Self::SlowOnly(SlowOnlyForm::PyTorchVideo),
        Self::SlowFast,
    ];

    /// The network whose tensors these are, all of them and with their shapes, for any number of
    /// classes; `None` if they are no known one's. Nothing but names and shapes is read.
    pub fn of(tensors: &dyn TensorSource) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.architecture().check(tensors).is_ok())
    }

    pub(super) fn architecture(self) -> Architecture {
        match self {
            Self::ResNet(depth) => resnet::architecture(depth),
            Self::SlowOnly(form) => slow_only::architecture(form),
            Self::SlowFast => slow_fast::architecture(),
        }
    }
}

impl fmt::Display for NetworkKind {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.pad(match self {
            Self::ResNet(ResNetDepth::Eighteen) => "ResNet-18",
            Self::ResNet(ResNetDepth::ThirtyFour) => "ResNet-34",
            Self::ResNet(ResNetDepth::Fifty) => "ResNet-50",
            Self::ResNet(ResNetDepth::OneHundredOne) => "ResNet-101",
            Self::ResNet(ResNetDepth::OneHundredFiftyTwo) => "ResNet-152",
            Self::SlowOnly(SlowOnlyForm::MmAction2) => "SlowOnly-R50 of mmaction2",
            Self::SlowOnly(SlowOnlyForm::MmAction2Depth18) => "SlowOnly-R18 of mmaction2",
            Self::SlowOnly(SlowOnlyForm::PyTorchVideo) => "SlowOnly-R50 of PyTorchVideo",
            Self::SlowFast => "SlowFast-R50 of PyTorchVideo",
        })
    }
}
