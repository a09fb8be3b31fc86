//! The networks of this crate, and recognition of their checkpoints.

use std::fmt;

use crate::engine::{Fit, Fitted, Graph, Misfit, Network, Options, Program, lower};
use crate::error::Error;
use crate::weights::TensorSource;

use super::architecture::{
    OpenPoseForm, ResNetDepth, ResNetForm, SimpleBaselineForm, SlowFastForm, SlowOnlyForm,
    open_pose, resnet, simple_baseline, slow_fast, slow_only,
};

/// A network, identified by its architecture and the names in its checkpoint.
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
/// assert_eq!(kind, Some(NetworkKind::ResNet(ResNetDepth::Eighteen.into())));
/// assert_eq!(kind.unwrap().to_string(), "ResNet-18");
/// # Ok::<(), vision_models::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum NetworkKind {
    /// [`ResNet`](crate::ResNet).
    ResNet(ResNetForm),
    /// [`SlowOnly`](crate::SlowOnly).
    SlowOnly(SlowOnlyForm),
    /// [`SlowFast`](crate::SlowFast).
    SlowFast(SlowFastForm),
    /// [`SimpleBaseline`](crate::SimpleBaseline).
    SimpleBaseline(SimpleBaselineForm),
    /// [`OpenPose`](crate::OpenPose).
    OpenPose(OpenPoseForm),
}

impl NetworkKind {
    /// Returns every network of this crate for which checkpoints exist.
    pub fn all() -> Vec<Self> {
        use ResNetDepth::{Eighteen, Fifty, OneHundredFiftyTwo, OneHundredOne, ThirtyFour};
        let depths = [Eighteen, ThirtyFour, Fifty, OneHundredOne, OneHundredFiftyTwo];
        let resnets = depths.map(ResNetForm::from).into_iter().chain([
            ResNetForm::RESNEXT_50_32X4D,
            ResNetForm::RESNEXT_101_32X8D,
            ResNetForm::RESNEXT_101_64X4D,
            ResNetForm::WIDE_50_2,
            ResNetForm::WIDE_101_2,
        ]);
        let slow_onlys = [
            SlowOnlyForm::MmAction2,
            SlowOnlyForm::MmAction2Depth18,
            SlowOnlyForm::MmAction2Depth101,
            SlowOnlyForm::PyTorchVideo,
        ];
        let slow_fasts = [
            SlowFastForm::PyTorchVideo,
            SlowFastForm::MmAction2EveryFourth(Fifty),
            SlowFastForm::MmAction2EveryFourth(OneHundredOne),
            SlowFastForm::MmAction2EveryEighth(Fifty),
            SlowFastForm::MmAction2EveryEighth(OneHundredOne),
        ];
        resnets
            .map(Self::ResNet)
            .chain(slow_onlys.map(Self::SlowOnly))
            .chain(slow_fasts.map(Self::SlowFast))
            .chain(SimpleBaselineForm::ALL.map(Self::SimpleBaseline))
            .chain(OpenPoseForm::ALL.map(Self::OpenPose))
            .collect()
    }

    /// Returns the network to which these tensors belong, with any number of classes or without a
    /// head. All names and shapes must match. `None` if no known network matches. Only names and
    /// shapes are read.
    ///
    /// All names may have a common prefix, such as `model.`. The checkpoint may also hold counters.
    /// Outside the prefix it may hold tensors that are no weights of a layer, such as the weights
    /// of classes in a loss. [`left_out`](Self::left_out) names them.
    pub fn of(tensors: &dyn TensorSource) -> Option<Self> {
        Self::all().into_iter().find(|kind| kind.left_out(tensors).is_some())
    }

    /// Returns the names of the tensors of a checkpoint that this network does not use. `None` if
    /// it is no checkpoint of this network.
    pub fn left_out(self, tensors: &dyn TensorSource) -> Option<Vec<String>> {
        let fit = self.program().ok()?.fit(tensors).ok()?;
        Some(fit.left_out)
    }

    /// Returns the names and shapes of the tensors that a checkpoint with this many classes must
    /// hold.
    pub fn parameters(self, classes: usize) -> Vec<(String, Vec<usize>)> {
        self.program().map(|program| program.expected(classes).into_tensors()).unwrap_or_default()
    }

    /// Loads the network.
    pub(crate) fn load(
        self,
        tensors: Box<dyn TensorSource + '_>,
        size: [usize; 3],
        options: Options,
    ) -> Result<Network, Error> {
        options.validate()?;
        let fit = self.fit(&*tensors)?;
        Network::of_program(self.program()?, Box::new(Fitted::new(tensors, fit)), size, options)
    }

    /// Finds the network's tensors in a checkpoint.
    pub(super) fn fit(self, tensors: &dyn TensorSource) -> Result<Fit, Error> {
        self.program()?.fit(tensors).map_err(|misfit| {
            let Misfit { missing, surplus, misshapen } = misfit;
            let [network, found] =
                [Some(self), Self::of(tensors)].map(|kind| Some(kind?.to_string().into()));
            Error::Weights { network, found, missing, surplus, misshapen }
        })
    }

    fn program(self) -> Result<Program, Error> {
        lower(&self.graph())
    }

    fn graph(self) -> Graph {
        match self {
            Self::ResNet(form) => resnet::graph(form),
            Self::SlowOnly(form) => slow_only::graph(form),
            Self::SlowFast(form) => slow_fast::graph(form),
            Self::SimpleBaseline(form) => simple_baseline::graph(form),
            Self::OpenPose(form) => open_pose::graph(form),
        }
    }
}

impl fmt::Display for NetworkKind {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = match *self {
            Self::ResNet(form) => {
                let (layers, groups, width) =
                    (form.depth().layers(), form.groups(), form.group_width());
                match (groups, width) {
                    (1, 64) => format!("ResNet-{layers}"),
                    (1, 128) => format!("Wide ResNet-{layers}-2"),
                    _ => format!("ResNeXt-{layers} {groups}x{width}d"),
                }
            }
            Self::SlowOnly(SlowOnlyForm::MmAction2) => "SlowOnly-R50 of mmaction2".into(),
            Self::SlowOnly(SlowOnlyForm::MmAction2Depth18) => "SlowOnly-R18 of mmaction2".into(),
            Self::SlowOnly(SlowOnlyForm::MmAction2Depth101) => "SlowOnly-R101 of mmaction2".into(),
            Self::SlowOnly(SlowOnlyForm::PyTorchVideo) => "SlowOnly-R50 of PyTorchVideo".into(),
            Self::SlowFast(SlowFastForm::PyTorchVideo) => "SlowFast-R50 of PyTorchVideo".into(),
            Self::SlowFast(SlowFastForm::MmAction2EveryFourth(depth)) => {
                format!("SlowFast-R{} 8x8 of mmaction2", depth.layers())
            }
            Self::SlowFast(SlowFastForm::MmAction2EveryEighth(depth)) => {
                format!("SlowFast-R{} 4x16 of mmaction2", depth.layers())
            }
            Self::SimpleBaseline(SimpleBaselineForm::Microsoft) => {
                "simple baseline of Microsoft".into()
            }
            Self::SimpleBaseline(SimpleBaselineForm::MmPose0) => {
                "simple baseline of mmpose 0.x".into()
            }
            Self::SimpleBaseline(SimpleBaselineForm::MmPose1) => {
                "simple baseline of mmpose 1.x".into()
            }
            Self::OpenPose(OpenPoseForm::Caffe) => "OpenPose body network (COCO)".into(),
            Self::OpenPose(OpenPoseForm::Modules) => {
                "OpenPose body network (COCO) of PyTorch".into()
            }
        };
        formatter.pad(&name)
    }
}
