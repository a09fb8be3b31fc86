//! Residual backbones: the rows of the papers' tables.
//!
//! - K. He, X. Zhang, S. Ren and J. Sun, "Deep residual learning for image recognition", CVPR 2016,
//!   Table 1. The stride is on the 3×3 convolution of a bottleneck, as in torchvision.
//! - S. Xie, R. Girshick, P. Dollár, Z. Tu and K. He, "Aggregated residual transformations for deep
//!   neural networks", CVPR 2017, Table 1.
//! - S. Zagoruyko and N. Komodakis, "Wide residual networks", BMVC 2016.
//! - C. Feichtenhofer, H. Fan, J. Malik and K. He, "SlowFast networks for video recognition", ICCV
//!   2019, Table 1.

use crate::engine::{Activation, Convolution, Graph, Value, Window};

use super::naming::{Names, Naming};

/// The number of layers of a residual network.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ResNetDepth {
    /// 18 layers of basic blocks.
    Eighteen,
    /// 34 layers of basic blocks.
    ThirtyFour,
    /// 50 layers of bottlenecks.
    Fifty,
    /// 101 layers of bottlenecks.
    OneHundredOne,
    /// 152 layers of bottlenecks.
    OneHundredFiftyTwo,
}

impl ResNetDepth {
    /// Returns the number of layers.
    pub fn layers(self) -> usize {
        match self {
            Self::Eighteen => 18,
            Self::ThirtyFour => 34,
            Self::Fifty => 50,
            Self::OneHundredOne => 101,
            Self::OneHundredFiftyTwo => 152,
        }
    }

    /// Returns the number of blocks of each stage.
    fn blocks(self) -> [usize; 4] {
        match self {
            Self::Eighteen => [2, 2, 2, 2],
            Self::ThirtyFour | Self::Fifty => [3, 4, 6, 3],
            Self::OneHundredOne => [3, 4, 23, 3],
            Self::OneHundredFiftyTwo => [3, 8, 36, 3],
        }
    }

    pub(super) fn has_bottlenecks(self) -> bool {
        !matches!(self, Self::Eighteen | Self::ThirtyFour)
    }
}

/// A residual backbone: the stem and four stages.
#[derive(Clone, Copy, Debug)]
pub(super) struct Backbone {
    pub(super) depth: ResNetDepth,
    pub(super) naming: Naming,
    /// Number of channels of the stem.
    pub(super) width: usize,
    /// Number of groups of the 3×3 convolution of a bottleneck.
    pub(super) groups: usize,
    /// Number of channels of such a group in the first stage, if the stem has 64 channels.
    pub(super) group_width: usize,
    /// Number of frames that the stem's kernel sees.
    pub(super) stem_frames: usize,
    /// Number of frames that the first kernel of each block sees, by stage.
    pub(super) frames: [usize; 4],
}

impl Backbone {
    /// Returns the plain form for images.
    pub(super) fn of_images(depth: ResNetDepth, naming: Naming) -> Self {
        let frames = [1; 4];
        Self { depth, naming, width: 64, groups: 1, group_width: 64, stem_frames: 1, frames }
    }

    /// Returns the slow path of SlowFast, with kernels of three frames in the last two stages.
    pub(super) fn slow(depth: ResNetDepth, naming: Naming) -> Self {
        Self { frames: [1, 1, 3, 3], ..Self::of_images(depth, naming) }
    }

    /// Returns the number of channels after a stage, counted from one. Zero is the stem.
    pub(super) fn channels(&self, stage: usize) -> usize {
        match stage {
            0 => self.width,
            _ if self.depth.has_bottlenecks() => self.width << (stage + 1),
            _ => self.width << (stage - 1),
        }
    }

    /// Adds the stem and all stages.
    pub(super) fn whole(&self, graph: &mut Graph, image: Value) -> Value {
        let stem = self.stem(graph, image);
        (1..=4).fold(stem, |x, stage| self.stage(graph, stage, x))
    }

    /// Adds the stem: 7×7, stride 2, then max pool 3×3, stride 2.
    pub(super) fn stem(&self, graph: &mut Graph, image: Value) -> Value {
        let kernel = [self.stem_frames, 7, 7];
        let stem = self.layer(self.naming.stem(), self.width, kernel).stride([1, 2, 2]);
        let x = graph.convolution(image, stem);
        graph.max_pool(x, Window { stride: [1, 2, 2], ..Window::same([1, 3, 3]) })
    }

    /// Adds the blocks of a stage, counted from one.
    pub(super) fn stage(&self, graph: &mut Graph, stage: usize, mut x: Value) -> Value {
        let outputs = self.channels(stage);
        for block in 0..self.depth.blocks()[stage - 1] {
            let stride = if block == 0 && stage > 1 { 2 } else { 1 };
            let at = Block { stage, index: block, outputs, stride: [1, stride, stride] };
            let (y, last) = if self.depth.has_bottlenecks() {
                self.bottleneck(graph, at, x)
            } else {
                self.basic(graph, at, x)
            };
            let shortcut = if graph.channels(x) == outputs && stride == 1 {
                x
            } else {
                let project = self
                    .layer(self.naming.shortcut(stage, block), outputs, [1, 1, 1])
                    .stride(at.stride)
                    .activation(Activation::None);
                graph.convolution(x, project)
            };
            x = graph.residual(y, last, shortcut);
        }
        x
    }

    /// Adds a bottleneck: t×1×1, 1×3×3 and 1×1×1. The first has a quarter of the channels, or the
    /// number given by groups and their width. The last convolution is returned for the caller to
    /// add.
    fn bottleneck(&self, graph: &mut Graph, at: Block, x: Value) -> (Value, Convolution) {
        let Block { stage, index, outputs, stride } = at;
        let names = |number| self.naming.convolution(stage, index, number);
        let width = outputs / 4 * self.group_width / 64 * self.groups;
        let frames = self.frames[stage - 1];
        let y = graph.convolution(x, self.layer(names(1), width, [frames, 1, 1]));
        let spatial = self.layer(names(2), width, [1, 3, 3]).stride(stride).groups(self.groups);
        let y = graph.convolution(y, spatial);
        (y, self.layer(names(3), outputs, [1, 1, 1]))
    }

    /// Adds a basic block: t×3×3, and t×3×3. The last convolution is returned for the caller to
    /// add.
    fn basic(&self, graph: &mut Graph, at: Block, x: Value) -> (Value, Convolution) {
        let Block { stage, index, outputs, stride } = at;
        let names = |number| self.naming.convolution(stage, index, number);
        let kernel = [self.frames[stage - 1], 3, 3];
        let y = graph.convolution(x, self.layer(names(1), outputs, kernel).stride(stride));
        (y, self.layer(names(2), outputs, kernel))
    }

    /// Returns a convolution with its ReLU.
    fn layer(&self, names: Names, outputs: usize, kernel: [usize; 3]) -> Convolution {
        names.convolution(outputs, kernel, self.naming.axes()).activation(Activation::Relu)
    }
}

/// A block's position and shape.
#[derive(Clone, Copy)]
struct Block {
    stage: usize,
    index: usize,
    outputs: usize,
    stride: [usize; 3],
}
