//! Residual backbones: the rows of the papers' tables.
//!
//! K. He, X. Zhang, S. Ren and J. Sun, "Deep residual learning for image recognition", CVPR 2016,
//! Table 1, the stride on the 3×3 convolution of a bottleneck as in torchvision. C. Feichtenhofer,
//! H. Fan, J. Malik and K. He, "SlowFast networks for video recognition", ICCV 2019, Table 1.

use crate::kernels::Window;
use crate::layout::Extent;

use super::graph::{Graph, Layer, Names, Value};
use super::naming::Naming;

/// How many layers a residual network has.
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
    /// Blocks of each stage.
    fn blocks(self) -> [usize; 4] {
        match self {
            Self::Eighteen => [2, 2, 2, 2],
            Self::ThirtyFour | Self::Fifty => [3, 4, 6, 3],
            Self::OneHundredOne => [3, 4, 23, 3],
            Self::OneHundredFiftyTwo => [3, 8, 36, 3],
        }
    }

    fn has_bottlenecks(self) -> bool {
        !matches!(self, Self::Eighteen | Self::ThirtyFour)
    }
}

/// A residual backbone: the stem and four stages.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Backbone {
    pub(crate) depth: ResNetDepth,
    pub(crate) naming: Naming,
    /// Channels of the stem.
    pub(crate) width: usize,
    /// Frames that the stem's kernel sees.
    pub(crate) stem_frames: usize,
    /// Frames that the first kernel of each block sees, by stage.
    pub(crate) frames: [usize; 4],
}

impl Backbone {
    /// How many axes the checkpoint's kernels have.
    fn axes(&self) -> usize {
        if self.naming == Naming::Torchvision { 2 } else { 3 }
    }

    /// Channels behind a stage, counted from one; behind the stem for zero.
    pub(crate) fn channels(&self, stage: usize) -> usize {
        match stage {
            0 => self.width,
            _ if self.depth.has_bottlenecks() => self.width << (stage + 1),
            _ => self.width << (stage - 1),
        }
    }

    /// 7×7, stride 2; max pool 3×3, stride 2. The last channels of the output, `spare` of them, are
    /// left for others to write.
    pub(crate) fn stem(&self, graph: &mut Graph, image: Value, spare: usize) -> Value {
        let kernel = window([self.stem_frames, 7, 7], 2);
        let x = self.layer(graph, image, self.naming.stem(), [3, self.width], kernel);
        let pooled = graph.value(self.width + spare);
        graph.max_pool(x, pooled, window([1, 3, 3], 2));
        pooled
    }

    /// The blocks of a stage, counted from one, with `spare` channels as above.
    pub(crate) fn stage(
        &self,
        graph: &mut Graph,
        stage: usize,
        mut x: Value,
        spare: usize,
    ) -> Value {
        let outputs = self.channels(stage);
        for block in 0..self.depth.blocks()[stage - 1] {
            let first = block == 0;
            let inputs = if first { graph.channels[x.0] } else { outputs };
            let stride = if first && stage > 1 { 2 } else { 1 };
            let at = Block { stage, index: block, inputs, outputs, stride };
            let (y, last) = if self.depth.has_bottlenecks() {
                self.bottleneck(graph, at, x)
            } else {
                self.basic(graph, at, x)
            };
            // The identity shortcut adds to the block's input where it lies.
            if inputs != outputs || stride > 1 {
                let out = graph.value(outputs + spare);
                let names = self.naming.shortcut(stage, block);
                let project = self.describe(names, [inputs, outputs], window([1, 1, 1], stride));
                graph.convolve_into(x, project, out, 0, false);
                x = out;
            }
            graph.convolve_add(y, last, x);
        }
        x
    }

    /// t×1×1 to a quarter of the channels, 1×3×3, and last 1×1×1, for the caller to add.
    fn bottleneck(&self, graph: &mut Graph, at: Block, x: Value) -> (Value, Layer) {
        let Block { stage, index, inputs, outputs, stride } = at;
        let names = |number| self.naming.convolution(stage, index, number);
        let width = outputs / 4;
        let frames = self.frames[stage - 1];
        let y = self.layer(graph, x, names(1), [inputs, width], window([frames, 1, 1], 1));
        let y = self.layer(graph, y, names(2), [width, width], window([1, 3, 3], stride));
        (y, self.describe(names(3), [width, outputs], window([1, 1, 1], 1)))
    }

    /// t×3×3, and last t×3×3, for the caller to add.
    fn basic(&self, graph: &mut Graph, at: Block, x: Value) -> (Value, Layer) {
        let Block { stage, index, inputs, outputs, stride } = at;
        let names = |number| self.naming.convolution(stage, index, number);
        let frames = self.frames[stage - 1];
        let y = self.layer(graph, x, names(1), [inputs, outputs], window([frames, 3, 3], stride));
        (y, self.describe(names(2), [outputs, outputs], window([frames, 3, 3], 1)))
    }

    /// A convolution with its ReLU.
    fn layer(
        &self,
        graph: &mut Graph,
        input: Value,
        names: Names,
        channels: [usize; 2],
        window: Window,
    ) -> Value {
        graph.convolve(input, self.describe(names, channels, window), true)
    }

    fn describe(&self, names: Names, [inputs, outputs]: [usize; 2], window: Window) -> Layer {
        Layer { names, inputs, outputs, window, axes: self.axes() }
    }
}

/// A block's place and shape.
#[derive(Clone, Copy)]
struct Block {
    stage: usize,
    index: usize,
    inputs: usize,
    outputs: usize,
    stride: usize,
}

/// A window that keeps the size but for its spatial stride.
fn window(kernel: Extent, stride: usize) -> Window {
    Window { kernel, stride: [1, stride, stride], padding: kernel.map(|taps| taps / 2) }
}
