//! The layers with weights.

use crate::kernels::Window;

/// The function after a convolution.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Activation {
    /// Identity, the convolution's sum itself.
    #[default]
    None,
    /// max(x, 0). A value that is not finite becomes NaN, so that an overflow never looks like a
    /// score.
    Relu,
    /// min(max(x, 0), 6). A value that is not finite becomes NaN.
    Relu6,
    /// 1 / (1 + exp(-x)). A value that is not finite becomes NaN.
    Logistic,
    /// max(x, 0) + a min(x, 0), K. He, X. Zhang, S. Ren and J. Sun, "Delving deep into rectifiers",
    /// ICCV 2015, eq. 1. A value that is not finite becomes NaN.
    Prelu {
        /// The name of the slopes, without `.weight`.
        name: String,
        /// True for one slope for all channels, PyTorch's default, instead of one per channel.
        shared: bool,
    },
}

/// A convolution: its shape, the names of its weights in a checkpoint, and the functions after it.
///
/// Frames come first in every extent, then rows and columns. An image is a clip of one frame. A new
/// convolution has stride one, padding that keeps the size, and one group. It has no bias, no batch
/// norm and no activation.
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
    /// The name of its tensors, without `.weight` and `.bias`.
    pub(super) name: String,
    /// Number of output channels.
    pub(super) outputs: usize,
    pub(super) window: Window,
    pub(super) groups: usize,
    /// True if the convolution is transposed.
    pub(super) transposed: bool,
    pub(super) bias: bool,
    pub(super) norm: Option<Norm>,
    pub(super) activation: Activation,
    /// Number of axes of the kernel in the checkpoint: two for images, three for clips.
    pub(super) axes: usize,
}

/// A batch norm after a convolution.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Norm {
    /// The name of its tensors, without `.weight`.
    pub(super) name: String,
    /// Term added to the variance.
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

    /// Creates PyTorch's `Conv2d`: a kernel of rows × columns on each frame. The tensor is
    /// `name.weight`, outputs × inputs per group × rows × columns.
    pub fn image(name: impl Into<String>, outputs: usize, [rows, columns]: [usize; 2]) -> Self {
        Self::new(name, outputs, Window::same([1, rows, columns]), 2)
    }

    /// Creates PyTorch's `Conv3d`: a kernel of frames × rows × columns.
    pub fn clip(name: impl Into<String>, outputs: usize, kernel: [usize; 3]) -> Self {
        Self::new(name, outputs, Window::same(kernel), 3)
    }

    /// Creates PyTorch's `ConvTranspose2d`, without padding: every input adds its kernel to the
    /// output, at distances of the stride. The tensor is inputs × outputs per group × rows ×
    /// columns. A kernel must not be smaller than its stride.
    pub fn transposed_image(
        name: impl Into<String>,
        outputs: usize,
        [rows, columns]: [usize; 2],
    ) -> Self {
        let window = Window { padding: [0; 3], ..Window::same([1, rows, columns]) };
        Self { transposed: true, ..Self::new(name, outputs, window, 2) }
    }

    /// Sets the stride: the distance in the input from one output to the next. In a transposed
    /// convolution it is the distance in the output from one input to the next.
    #[must_use]
    pub fn stride(mut self, stride: [usize; 3]) -> Self {
        self.window.stride = stride;
        self
    }

    /// Sets the zeros around the input. A transposed convolution instead cuts this much off around
    /// the output.
    #[must_use]
    pub fn padding(mut self, padding: [usize; 3]) -> Self {
        self.window.padding = padding;
        self
    }

    /// Sets the zeros after the input beyond the padding; see [`Window::extra`].
    #[must_use]
    pub fn extra_padding(mut self, extra: [isize; 3]) -> Self {
        self.window.extra = extra;
        self
    }

    /// Sets the distance from one tap to the next. The padding grows with it, so that it still
    /// keeps the size. Set another padding afterwards if needed. A transposed convolution has no
    /// dilation.
    #[must_use]
    pub fn dilation(mut self, dilation: [usize; 3]) -> Self {
        self.window.dilation = dilation;
        self.window.padding = std::array::from_fn(|axis| {
            (self.window.kernel[axis] / 2).saturating_mul(dilation[axis])
        });
        self
    }

    /// Divides the channels into groups: the g-th share of the outputs sees only the g-th share of
    /// the inputs.
    #[must_use]
    pub fn groups(mut self, groups: usize) -> Self {
        self.groups = groups;
        self
    }

    /// Adds a bias, `name.bias`.
    #[must_use]
    pub fn bias(mut self) -> Self {
        self.bias = true;
        self
    }

    /// Adds a batch norm with PyTorch's ε of 1e-5.
    #[must_use]
    pub fn norm(self, name: impl Into<String>) -> Self {
        self.norm_with(name, NORM_EPSILON)
    }

    /// Adds a batch norm with another ε.
    #[must_use]
    pub fn norm_with(mut self, name: impl Into<String>, epsilon: f64) -> Self {
        self.norm = Some(Norm { name: name.into(), epsilon });
        self
    }

    /// Sets the function after the batch norm and after the addition of a residual connection.
    #[must_use]
    pub fn activation(mut self, activation: Activation) -> Self {
        self.activation = activation;
        self
    }

    /// Returns true if there is no function after the convolution.
    pub(crate) fn is_linear(&self) -> bool {
        self.activation == Activation::None
    }

    /// Returns the output's frames, rows and columns for an input's.
    pub(super) fn output(&self, size: [usize; 3]) -> Option<[usize; 3]> {
        if self.transposed { self.window.transposed_output(size) } else { self.window.output(size) }
    }
}
