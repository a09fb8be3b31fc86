//! Residual networks in torchvision's form.

use crate::engine::{Graph, Pooling};
use crate::error::Error;

use super::backbone::{Backbone, ResNetDepth};
use super::naming::Naming;

/// The parameters of a residual network in torchvision's form: its depth, and the number and width
/// of its bottlenecks' groups.
///
/// ```
/// use vision_models::{NetworkKind, ResNetDepth, ResNetForm};
///
/// assert_eq!(ResNetForm::from(ResNetDepth::Fifty).groups(), 1);
/// assert_eq!(NetworkKind::ResNet(ResNetForm::RESNEXT_50_32X4D).to_string(), "ResNeXt-50 32x4d");
/// let form = ResNetForm::new(ResNetDepth::OneHundredFiftyTwo, 16, 8)?;
/// assert_eq!(NetworkKind::ResNet(form).to_string(), "ResNeXt-152 16x8d");
/// # Ok::<(), vision_models::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ResNetForm {
    depth: ResNetDepth,
    groups: u16,
    group_width: u16,
}

impl ResNetForm {
    /// `resnext50_32x4d`.
    pub const RESNEXT_50_32X4D: Self = Self::grouped(ResNetDepth::Fifty, 32, 4);
    /// `resnext101_32x8d`.
    pub const RESNEXT_101_32X8D: Self = Self::grouped(ResNetDepth::OneHundredOne, 32, 8);
    /// `resnext101_64x4d`.
    pub const RESNEXT_101_64X4D: Self = Self::grouped(ResNetDepth::OneHundredOne, 64, 4);
    /// `wide_resnet50_2`.
    pub const WIDE_50_2: Self = Self::grouped(ResNetDepth::Fifty, 1, 128);
    /// `wide_resnet101_2`.
    pub const WIDE_101_2: Self = Self::grouped(ResNetDepth::OneHundredOne, 1, 128);

    /// Creates a network whose bottlenecks have this many groups (the cardinality) of this width in
    /// the first stage: torchvision's `groups` and `width_per_group`. The plain network has 1 and
    /// 64.
    ///
    /// # Errors
    /// [`Error::Value`] if groups or width are zero or above 4096, or the network has basic blocks,
    /// which have neither.
    pub fn new(depth: ResNetDepth, groups: usize, group_width: usize) -> Result<Self, Error> {
        const MOST: u16 = 4096;
        let refuse = |name, value: usize, expected| Error::value(name, value, expected);
        let narrow = |name, value: usize| {
            let narrow = u16::try_from(value).ok().filter(|value| (1..=MOST).contains(value));
            narrow.ok_or_else(|| refuse(name, value, "a number from 1 to 4096"))
        };
        let (groups, group_width) =
            (narrow("groups", groups)?, narrow("group_width", group_width)?);
        if !depth.has_bottlenecks() && (groups, group_width) != (1, 64) {
            let expected = "1 group of width 64: basic blocks have no others";
            return Err(refuse("groups", groups.into(), expected));
        }
        Ok(Self::grouped(depth, groups, group_width))
    }

    const fn grouped(depth: ResNetDepth, groups: u16, group_width: u16) -> Self {
        Self { depth, groups, group_width }
    }

    /// Returns the depth.
    pub fn depth(self) -> ResNetDepth {
        self.depth
    }

    /// Returns the number of groups of the 3×3 convolution of each bottleneck.
    pub fn groups(self) -> usize {
        self.groups.into()
    }

    /// Returns the number of channels of such a group in the first stage. It doubles from stage to
    /// stage.
    pub fn group_width(self) -> usize {
        self.group_width.into()
    }
}

impl From<ResNetDepth> for ResNetForm {
    /// Returns the plain network.
    fn from(depth: ResNetDepth) -> Self {
        Self::grouped(depth, 1, 64)
    }
}

pub(in crate::networks) fn graph(form: ResNetForm) -> Graph {
    let plain = Backbone::of_images(form.depth, Naming::Torchvision(""));
    let backbone = Backbone { groups: form.groups(), group_width: form.group_width(), ..plain };
    let mut graph = Graph::new();
    let image = graph.input(3);
    let x = backbone.whole(&mut graph, image);
    graph.classify(&[(x, Pooling::Mean)], "fc");
    graph
}
