//! What is in a checkpoint file, whatever its format.

use std::{collections::BTreeMap, fmt};

use super::TensorInfo;

/// The format of a checkpoint file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// `torch.save` since PyTorch 1.6.
    TorchZip,
    /// `torch.save` before PyTorch 1.6.
    TorchStream,
    /// <https://github.com/huggingface/safetensors>
    Safetensors,
}

impl fmt::Display for Format {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.pad(match self {
            Self::TorchZip => "PyTorch (zip)",
            Self::TorchStream => "PyTorch (stream, before 1.6)",
            Self::Safetensors => "safetensors",
        })
    }
}

/// What the reader of a format finds.
#[derive(Debug)]
pub(super) struct Contents {
    pub(super) format: Format,
    pub(super) tensors: BTreeMap<String, TensorInfo>,
    pub(super) wrappers: Vec<&'static str>,
    pub(super) others: Vec<String>,
}
