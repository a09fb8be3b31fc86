//! The location of a network's tensors in a checkpoint.

use crate::error::Error;
use crate::weights::{Tensor, TensorSource};

/// The location of a network's tensors in a checkpoint.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Fit {
    /// The prefix of every tensor's name.
    pub(crate) prefix: String,
    /// Full names of the tensors that are not part of the network.
    pub(crate) left_out: Vec<String>,
}

/// The names and shapes of tensors with a prefix.
#[derive(Clone, Copy)]
pub(crate) struct Behind<'a> {
    tensors: &'a dyn TensorSource,
    prefix: &'a str,
}

impl<'a> Behind<'a> {
    pub(crate) fn new(tensors: &'a dyn TensorSource, prefix: &'a str) -> Self {
        Self { tensors, prefix }
    }

    /// Returns the names without the prefix.
    pub(crate) fn names(self) -> impl Iterator<Item = &'a str> {
        let Self { tensors, prefix } = self;
        tensors.names().into_iter().filter_map(move |name| name.strip_prefix(prefix))
    }

    /// Returns the full names of the tensors without the prefix.
    pub(crate) fn outside(self) -> impl Iterator<Item = &'a str> {
        let Self { tensors, prefix } = self;
        tensors.names().into_iter().filter(move |name| !name.starts_with(prefix))
    }

    pub(crate) fn shape(self, name: &str) -> Option<&'a [usize]> {
        if self.prefix.is_empty() {
            return self.tensors.shape(name);
        }
        self.tensors.shape(&self.whole(name))
    }

    pub(crate) fn whole(self, name: &str) -> String {
        format!("{}{name}", self.prefix)
    }

    /// Returns true if the tensor with this full name is a counter, which belongs to no layer.
    pub(crate) fn is_counter(self, name: &str) -> bool {
        self.tensors.is_counter(name)
    }

    /// Returns true if the tensor with this full name is no weight of a layer: a counter, a scalar,
    /// or a vector such as the weights of classes in a loss.
    pub(crate) fn is_buffer(self, name: &str) -> bool {
        let axes = |shape: &[usize]| shape.iter().filter(|&&axis| axis != 1).count();
        self.is_counter(name) || self.tensors.shape(name).is_none_or(|shape| axes(shape) < 2)
    }
}

/// Returns the possible prefixes of a tensor with this name: the empty one, and each prefix that
/// ends in a point.
pub(crate) fn prefixes(tensors: &dyn TensorSource, name: &str) -> Vec<String> {
    let mut prefixes = vec![String::new()];
    let behind = |whole: &str| {
        let prefix = whole.strip_suffix(name).filter(|prefix| prefix.ends_with('.'))?;
        Some(prefix.to_owned())
    };
    prefixes.extend(tensors.names().into_iter().filter_map(behind));
    prefixes
}

/// A checkpoint whose tensors have the network's names.
pub(crate) struct Fitted<'a> {
    tensors: Box<dyn TensorSource + 'a>,
    prefix: String,
}

impl<'a> Fitted<'a> {
    pub(crate) fn new(tensors: Box<dyn TensorSource + 'a>, fit: Fit) -> Self {
        Self { tensors, prefix: fit.prefix }
    }

    fn whole(&self, name: &str) -> String {
        format!("{}{name}", self.prefix)
    }
}

impl TensorSource for Fitted<'_> {
    fn names(&self) -> Vec<&str> {
        Behind::new(&*self.tensors, &self.prefix).names().collect()
    }

    fn shape(&self, name: &str) -> Option<&[usize]> {
        self.tensors.shape(&self.whole(name))
    }

    fn is_counter(&self, name: &str) -> bool {
        self.tensors.is_counter(&self.whole(name))
    }

    fn take(&mut self, name: &str) -> Result<Tensor, Error> {
        let whole = self.whole(name);
        self.tensors.take(&whole)
    }
}
