//! What the layers are called in each kind of checkpoint.

use super::graph::Names;

/// Whose names a checkpoint uses. Stages count from one, blocks from zero, a block's convolutions
/// from one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Naming {
    /// `layer1.0.conv1`
    Torchvision,
    /// `backbone.layer1.0.conv1.conv`
    MmAction2,
    /// `blocks.1.res_blocks.0.branch2.conv_a`
    PyTorchVideo,
    /// `blocks.1.multipathway_blocks.0.res_blocks.0.branch2.conv_a`: one pathway of several.
    PyTorchVideoPathway(usize),
}

fn names(prefix: &str, convolution: &str, norm: &str) -> Names {
    Names { convolution: format!("{prefix}{convolution}"), norm: format!("{prefix}{norm}") }
}

impl Naming {
    /// The first convolution.
    pub(crate) fn stem(self) -> Names {
        match self {
            Self::Torchvision => names("", "conv1", "bn1"),
            Self::MmAction2 => names("backbone.conv1.", "conv", "bn"),
            Self::PyTorchVideo | Self::PyTorchVideoPathway(_) => {
                names(&self.block(0), "conv", "norm")
            }
        }
    }

    /// The `number`-th convolution of a residual block.
    pub(crate) fn convolution(self, stage: usize, block: usize, number: usize) -> Names {
        match self {
            Self::Torchvision => names(
                &format!("layer{stage}.{block}."),
                &format!("conv{number}"),
                &format!("bn{number}"),
            ),
            Self::MmAction2 => {
                names(&format!("backbone.layer{stage}.{block}.conv{number}."), "conv", "bn")
            }
            Self::PyTorchVideo | Self::PyTorchVideoPathway(_) => {
                let letter = ["a", "b", "c"][(number - 1).min(2)];
                names(
                    &format!("{}res_blocks.{block}.branch2.", self.block(stage)),
                    &format!("conv_{letter}"),
                    &format!("norm_{letter}"),
                )
            }
        }
    }

    /// The projection of a residual block's shortcut.
    pub(crate) fn shortcut(self, stage: usize, block: usize) -> Names {
        match self {
            Self::Torchvision => names(&format!("layer{stage}.{block}.downsample."), "0", "1"),
            Self::MmAction2 => {
                names(&format!("backbone.layer{stage}.{block}.downsample."), "conv", "bn")
            }
            Self::PyTorchVideo | Self::PyTorchVideoPathway(_) => names(
                &format!("{}res_blocks.{block}.", self.block(stage)),
                "branch1_conv",
                "branch1_norm",
            ),
        }
    }

    /// The prefix of a PyTorchVideo block.
    fn block(self, block: usize) -> String {
        match self {
            Self::PyTorchVideoPathway(pathway) => {
                format!("blocks.{block}.multipathway_blocks.{pathway}.")
            }
            _ => format!("blocks.{block}."),
        }
    }
}
