//! The names of the layers in each kind of checkpoint.

use crate::engine::Convolution;

/// The names of a convolution and its batch norm.
#[derive(Clone, Debug)]
pub(super) struct Names {
    /// Name of the convolution, without `.weight`.
    convolution: String,
    /// Name of its batch norm, without `.weight`.
    norm: String,
}

impl Names {
    /// Creates names with a common prefix.
    pub(super) fn new(prefix: &str, convolution: &str, norm: &str) -> Self {
        Self { convolution: format!("{prefix}{convolution}"), norm: format!("{prefix}{norm}") }
    }

    /// Returns a convolution with these names: PyTorch's `Conv3d`, or `Conv2d` if kernels have two
    /// axes.
    pub(super) fn convolution(self, outputs: usize, kernel: [usize; 3], axes: Axes) -> Convolution {
        let [_, rows, columns] = kernel;
        match axes {
            Axes::Two => Convolution::image(self.convolution, outputs, [rows, columns]),
            Axes::Three => Convolution::clip(self.convolution, outputs, kernel),
        }
        .norm(self.norm)
    }
}

/// The number of axes of a checkpoint's kernels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Axes {
    /// Rows and columns.
    Two,
    /// Frames, rows and columns.
    Three,
}

/// The naming scheme of a checkpoint. Stages and a block's convolutions count from one, blocks from
/// zero.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Naming {
    /// `layer1.0.conv1`, with a prefix.
    Torchvision(&'static str),
    /// `backbone.layer1.0.conv1.conv`, where the prefix is `backbone.`
    MmAction2(&'static str),
    /// `blocks.1.res_blocks.0.branch2.conv_a`
    PyTorchVideo,
    /// `blocks.1.multipathway_blocks.0.res_blocks.0.branch2.conv_a`: one pathway of several.
    PyTorchVideoPathway(usize),
}

impl Naming {
    /// Returns the number of axes of the kernels.
    pub(super) fn axes(self) -> Axes {
        if matches!(self, Self::Torchvision(_)) { Axes::Two } else { Axes::Three }
    }

    /// Returns the names of the first convolution.
    pub(super) fn stem(self) -> Names {
        match self {
            Self::Torchvision(prefix) => Names::new(prefix, "conv1", "bn1"),
            Self::MmAction2(prefix) => Names::new(&format!("{prefix}conv1."), "conv", "bn"),
            Self::PyTorchVideo | Self::PyTorchVideoPathway(_) => {
                Names::new(&self.block(0), "conv", "norm")
            }
        }
    }

    /// Returns the names of the `number`-th convolution of a residual block.
    pub(super) fn convolution(self, stage: usize, block: usize, number: usize) -> Names {
        match self {
            Self::Torchvision(prefix) => Names::new(
                &format!("{prefix}layer{stage}.{block}."),
                &format!("conv{number}"),
                &format!("bn{number}"),
            ),
            Self::MmAction2(prefix) => {
                Names::new(&format!("{prefix}layer{stage}.{block}.conv{number}."), "conv", "bn")
            }
            Self::PyTorchVideo | Self::PyTorchVideoPathway(_) => {
                let letter = ["a", "b", "c"][(number - 1).min(2)];
                Names::new(
                    &format!("{}res_blocks.{block}.branch2.", self.block(stage)),
                    &format!("conv_{letter}"),
                    &format!("norm_{letter}"),
                )
            }
        }
    }

    /// Returns the names of the projection of a residual block's shortcut.
    pub(super) fn shortcut(self, stage: usize, block: usize) -> Names {
        match self {
            Self::Torchvision(prefix) => {
                Names::new(&format!("{prefix}layer{stage}.{block}.downsample."), "0", "1")
            }
            Self::MmAction2(prefix) => {
                Names::new(&format!("{prefix}layer{stage}.{block}.downsample."), "conv", "bn")
            }
            Self::PyTorchVideo | Self::PyTorchVideoPathway(_) => Names::new(
                &format!("{}res_blocks.{block}.", self.block(stage)),
                "branch1_conv",
                "branch1_norm",
            ),
        }
    }

    /// Returns the prefix of a PyTorchVideo block.
    fn block(self, block: usize) -> String {
        match self {
            Self::PyTorchVideoPathway(pathway) => {
                format!("blocks.{block}.multipathway_blocks.{pathway}.")
            }
            _ => format!("blocks.{block}."),
        }
    }
}
