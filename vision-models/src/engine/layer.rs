//! The layers with weights.

use crate::kernels::Window;

/// What comes behind a convolution.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Activation {
    /// Nothing.
    #[default]
    None,
    /// max(x, 0). What is not finite becomes NaN, so that no overflow looks like a score.
    Relu,
    /// min(max(x, 0), 6). What is not finite becomes NaN.
    Relu6,
    /// 1 / (1 + exp(-x)). What is not finite becomes NaN.
    Logistic,
    /// max(x, 0) + a min(x, 0), K. He, X. Zhang, S. Ren and J. Sun, "Delving deep into rectifiers", ICCV
    /// 2015, eq. 1. What is not finite becomes NaN.
    Prelu {
        /// What the slopes are called, without `.weight`.
        name: String,
        /// One slope for all channels, PyTorch's default, instead of one for each.
        shared: bool,
    },
}

/// A convolution: its shape, what its weights are called in a checkpoint, and what follows it.
///
/// Frames come first in every extent, then rows and columns; an image is a clip of one frame. A new
/// convolution has stride one, a padding that keeps the size, one group, no bias, no batch norm and no
/// activation, as the methods then say.
///
/// ```
/// use vision_models::engine::{Activation, Convolution};
///
/// // The stem of a residual network: tensors conv1.weight, bn1.weight, bn1.bias, bn1.running_mean and
/// // bn1.running_var.
/// let stem = Convolution::image("conv1", 64, [7, 7])
///     .stride([1, 2, 2])
///     .norm("bn1")
///     .activation(Activation::Relu);
/// // Each of 256 channels by itself, with a bias: tensors depthwise.weight and depthwise.bias.
/// let depthwise = Convolution::image("depthwise", 256, [3, 3]).groups(256).bias();
/// # let _ = (stem, depthwise);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Convolution {
    /// What its tensors are called, without `.weight` and `.bias`.
    pub(super) name: String,
    /// Output channels.
    pub(super) outputs: usize,
    pub(super) window: Window,
    pub(super) groups: usize,
    /// Whether it spreads its input over a larger output.
    pub(super) transposed: bool,
    pub(super) bias: bool,
    pub(super) norm: Option<Norm>,
    pub(super) activation: Activation,
    /// How many axes the checkpoint's kernel has: two for images, three for clips.
    pub(super) axes: usize,
}

/// A batch norm behind a convolution.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Norm {
    /// What its tensors are called, without `.weight`.
    pub(super) name: String,
    /// What is added to the variance.
    pub(super) epsilon: f64,
}

/// PyTorch's default.
const NORM_EPSILON: f64 = 1e-5;

impl Convolution {
    fn new(name: impl Into<String>, outputs: usize, window: Window, axes: usize) -> Self {
        Self {
            name: name.into(),
            outputs,
            window,
            groups: 1,
            transposed: false,
            bias: false,
            norm: None,
            activation: Activation::None,
            axes,
        }
    }

    /// PyTorch's `Conv2d`: a kernel of rows × columns on each frame, whose tensor is `name.weight`, outputs ×
    /// inputs per group × rows × columns.
    pub fn image(name: impl Into<String>, outputs: usize, [rows, columns]: [usize; 2]) -> Self {
        Self::new(name, outputs, Window::same([1, rows, columns]), 2)
    }

    /// PyTorch's `Conv3d`: a kernel of frames × rows × columns.
    pub fn clip(name: impl Into<String>, outputs: usize, kernel: [usize; 3]) -> Self {
        Self::new(name, outputs, Window::same(kernel), 3)
    }

    /// PyTorch's `ConvTranspose2d`, without padding: every input adds its kernel to the output, a stride
    /// apart. The tensor is inputs × outputs per group × rows × columns. A kernel must not be smaller than
    /// its stride.
    pub fn transposed_image(
        name: impl Into<String>,
        outputs: usize,
        [rows, columns]: [usize; 2],
    ) -> Self {
        let window = Window { padding: [0; 3], ..Window::same([1, rows, columns]) };
        Self { transposed: true, ..Self::new(name, outputs, window, 2) }
    }

    /// Steps along frames, rows and columns from one output to the next; of a transposed convolution, from
    /// one input to the next in the output.
    #[must_use]
    pub fn stride(mut self, stride: [usize; 3]) -> Self {
        self.window.stride = stride;
        self
    }

    /// Zeros around the input; of a transposed convolution, what is cut off around the output.
    #[must_use]
    pub fn padding(mut self, padding: [usize; 3]) -> Self {
        self.window.padding = padding;
        self
    }

    /// Zeros behind the input beyond the padding; see [`Window::extra`].
    #[must_use]
    pub fn extra_padding(mut self, extra: [isize; 3]) -> Self {
        self.window.extra = extra;
        self
    }

    /// Steps from one tap to the next. The padding grows with it, so that it still keeps the size; give
    /// another afterwards. A transposed convolution has none.
    #[must_use]
    pub fn dilation(mut self, dilation: [usize; 3]) -> Self {
        self.window.dilation = dilation;
        self.window.padding = std::array::from_fn(|axis| {
            (self.window.kernel[axis] / 2).saturating_mul(dilation[axis])
        });
        self
    }

    /// Parts of the channels that see each other alone: the g-th share of the outputs sees the g-th share of
    /// the inputs.
    #[must_use]
    pub fn groups(mut self, groups: usize) -> Self {
        self.groups = groups;
        self
    }

    /// A bias, `name.bias`.
    #[must_use]
    pub fn bias(mut self) -> Self {
        self.bias = true;
        self
    }

    /// A batch norm behind it, with PyTorch's ε of 1e-5.
    #[must_use]
    pub fn norm(self, name: impl Into<String>) -> Self {
        self.norm_with(name, NORM_EPSILON)
    }

    /// A batch norm behind it, with another ε.
    #[must_use]
    pub fn norm_with(mut self, name: impl Into<String>, epsilon: f64) -> Self {
        self.norm = Some(Norm { name: name.into(), epsilon });
        self
    }

    /// What comes behind the batch norm, and behind the addition of a residual connection.
    #[must_use]
    pub fn activation(mut self, activation: Activation) -> Self {
        self.activation = activation;
        self
    }

    /// Whether no function comes behind it.
    pub(crate) fn is_linear(&self) -> bool {
        self.activation == Activation::None
    }

    /// The output's frames, rows and columns for an input's.
    pub(super) fn output(&self, size: [usize; 3]) -> Option<[usize; 3]> {
        if self.transposed { self.window.transposed_output(size) } else { self.window.output(size) }
    }
}
