//! Where in a checkpoint a network's tensors are.

use crate::error::Error;
use crate::weights::{Tensor, TensorSource};

/// Where in a checkpoint a network's tensors are.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Fit {
    /// What stands before the name of every tensor.
    pub(crate) prefix: String,
    /// Tensors that are no part of the network, by their whole names.
    pub(crate) left_out: Vec<String>,
}

/// The names and shapes behind a prefix.
#[derive(Clone, Copy)]
pub(crate) struct Behind<'a> {
    tensors: &'a dyn TensorSource,
    prefix: &'a str,
}

impl<'a> Behind<'a> {
    pub(crate) fn new(tensors: &'a dyn TensorSource, prefix: &'a str) -> Self {
        Self { tensors, prefix }
    }

    /// The names without the prefix.
    pub(crate) fn names(self) -> impl Iterator<Item = &'a str> {
        let Self { tensors, prefix } = self;
        tensors.names().into_iter().filter_map(move |name| name.strip_prefix(prefix))
    }

    /// The whole names of the tensors that are not behind the prefix.
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

    /// Returns true for a tensor, by its whole name, that is no layer's: a counter.
    pub(crate) fn is_counter(self, name: &str) -> bool {
        self.tensors.is_counter(name)
    }

    /// Returns true for a tensor, by its whole name, that no layer multiplies with: a counter, a number, or a vector
    /// such as the weights of classes in a loss.
    pub(crate) fn is_buffer(self, name: &str) -> bool {
        let axes = |shape: &[usize]| shape.iter().filter(|&&axis| axis != 1).count();
        self.is_counter(name) || self.tensors.shape(name).is_none_or(|shape| axes(shape) < 2)
    }
}

/// The prefixes, each with its point, behind which a tensor of this name stands; none before any other.
pub(crate) fn prefixes(tensors: &dyn TensorSource, name: &str) -> Vec<String> {
    let mut prefixes = vec![String::new()];
    let behind = |whole: &str| {
        let prefix = whole.strip_suffix(name).filter(|prefix| prefix.ends_with('.'))?;
        Some(prefix.to_owned())
    };
    prefixes.extend(tensors.names().into_iter().filter_map(behind));
    prefixes
}

/// A checkpoint whose tensors are called as the network calls them.
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
