//! Sources of a network's weights.

use crate::error::Error;
use crate::weights::tensors::{Tensor, Tensors};

/// Named tensors that are returned one at a time. They are all in memory ([`Tensors`]), or read
/// from their file on demand ([`Checkpoint`](crate::Checkpoint)). A network that packs its weights
/// therefore never holds them twice.
pub trait TensorSource {
    /// Returns the names, sorted.
    fn names(&self) -> Vec<&str>;

    /// Returns the shape of the tensor with this name.
    fn shape(&self, name: &str) -> Option<&[usize]>;

    /// Returns true if the file holds integers or booleans: a counter or a mask, which no layer
    /// has. A source that does not know returns false.
    fn is_counter(&self, _name: &str) -> bool {
        false
    }

    /// Returns the tensor with this name. Each tensor can be taken only once.
    ///
    /// # Errors
    /// [`Error::Name`] if no tensor has this name, or it was taken already, and the errors of
    /// reading it.
    fn take(&mut self, name: &str) -> Result<Tensor, Error>;
}

/// Returns the error for a name that no tensor has.
pub(crate) fn no_tensor(name: &str) -> Error {
    Error::unknown("tensor", name, "the name of a tensor that is among the weights")
}

impl TensorSource for Tensors {
    fn names(&self) -> Vec<&str> {
        self.names().collect()
    }

    fn shape(&self, name: &str) -> Option<&[usize]> {
        self.get(name).map(Tensor::shape)
    }

    fn take(&mut self, name: &str) -> Result<Tensor, Error> {
        self.remove(name).ok_or_else(|| no_tensor(name))
    }
}
