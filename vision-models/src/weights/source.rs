//! Where a network takes its weights from.

use crate::error::Error;
use crate::weights::tensors::{Tensor, Tensors};

/// Named tensors that are given out one at a time: all in memory ([`Tensors`]), or read from their
/// file as they are asked for ([`Checkpoint`](crate::Checkpoint)), so that a network that packs its
/// weights never holds them twice.
pub trait TensorSource {
    /// The names, sorted.
    fn names(&self) -> Vec<&str>;

    /// The shape of the tensor of this name.
    fn shape(&self, name: &str) -> Option<&[usize]>;

    /// Returns true if the file holds whole numbers or truth values: a counter or a mask, which no layer is made
    /// of. Of a source that does not know, false.
    fn is_counter(&self, _name: &str) -> bool {
        false
    }

    /// Gives the tensor of this name; it may be asked for only once.
    ///
    /// # Errors
    /// [`Error::Name`] if there is none of this name (left); whatever can be wrong in reading
    /// it.
    fn take(&mut self, name: &str) -> Result<Tensor, Error>;
}

/// The error of a name that no tensor has.
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
