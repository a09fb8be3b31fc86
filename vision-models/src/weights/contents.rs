//! The contents of a checkpoint file of any format.

use std::{collections::BTreeMap, fmt};

use super::budget::Budget;
use crate::error::Error;
use crate::weights::tensor_info::TensorInfo;

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

/// The contents that a format's reader finds.
#[derive(Debug)]
pub(super) struct Contents {
    pub(super) format: Format,
    pub(super) tensors: BTreeMap<String, TensorInfo>,
    pub(super) wrappers: Vec<&'static str>,
    pub(super) others: Vec<String>,
    /// Names of the other entries among the tensors.
    pub(super) unread: Vec<String>,
}

/// Prefixes that PyTorch's own wrappers add to every name: `DataParallel` and similar, and
/// `torch.compile`.
const WRAPPING: [&str; 2] = ["module.", "_orig_mod."];

impl Contents {
    /// Removes the prefixes that wrappers have added to every name, however many there are.
    pub(super) fn unwrap_names(&mut self, budget: &mut Budget) -> Result<(), Error> {
        while let Some(prefix) = WRAPPING.into_iter().find(|prefix| {
            let is_before = |name: &String| name.len() > prefix.len() && name.starts_with(prefix);
            !self.tensors.is_empty() && self.tensors.keys().all(is_before)
        }) {
            for (mut name, info) in std::mem::take(&mut self.tensors) {
                budget.take_entry::<String, TensorInfo>(0)?;
                name.drain(..prefix.len());
                self.tensors.insert(name, info);
            }
        }
        Ok(())
    }
}
