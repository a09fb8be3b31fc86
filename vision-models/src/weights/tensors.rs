//! Tensors of a checkpoint, independent of the file format.

use std::collections::BTreeMap;

use super::shape::elements;
use crate::error::Error;
use crate::excerpt::Excerpt;

/// An f32 tensor in row-major (C) order. A scalar has the empty shape.
#[derive(Clone, Debug, PartialEq)]
pub struct Tensor {
    shape: Vec<usize>,
    data: Vec<f32>,
}

impl Tensor {
    /// Creates a tensor of this shape from its elements, the last axis running fastest.
    ///
    /// # Errors
    /// [`Error::Size`] if the number of elements is not the shape's, or an axis of an empty tensor
    /// exceeds the size of memory.
    pub fn new(shape: Vec<usize>, data: Vec<f32>) -> Result<Self, Error> {
        if elements(&shape) == Some(data.len()) {
            Ok(Self { shape, data })
        } else {
            Err(unfilled(&shape, data.len()))
        }
    }

    /// Returns the length of each axis.
    pub fn shape(&self) -> &[usize] {
        &self.shape
    }

    /// Returns the elements, the last axis running fastest.
    pub fn data(&self) -> &[f32] {
        &self.data
    }

    /// Returns the elements and consumes the tensor.
    pub fn into_data(self) -> Vec<f32> {
        self.data
    }
}

/// The named f32 tensors of a checkpoint, in the order of their names.
///
/// ```
/// use vision_models::{Tensor, Tensors};
///
/// let mut tensors = Tensors::new();
/// tensors.insert("fc.bias", Tensor::new(vec![2], vec![0.5, -0.5])?)?;
/// assert_eq!(tensors.get("fc.bias").map(Tensor::shape), Some([2].as_slice()));
/// # Ok::<(), vision_models::Error>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tensors {
    tensors: BTreeMap<String, Tensor>,
}

impl Tensors {
    /// Creates an empty set of tensors.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a tensor.
    ///
    /// # Errors
    /// [`Error::Value`] if a tensor has this name already.
    pub fn insert(&mut self, name: impl Into<String>, tensor: Tensor) -> Result<(), Error> {
        let name = name.into();
        if self.tensors.contains_key(&name) {
            let tensor = format!("tensor \"{}\"", Excerpt(&name));
            return Err(Error::value(&tensor, "given twice", "each name of a checkpoint once"));
        }
        self.tensors.insert(name, tensor);
        Ok(())
    }

    /// Returns the tensor with this name.
    pub fn get(&self, name: &str) -> Option<&Tensor> {
        self.tensors.get(name)
    }

    /// Removes and returns the tensor with this name. Its memory is released when the caller drops
    /// it.
    pub fn remove(&mut self, name: &str) -> Option<Tensor> {
        self.tensors.remove(name)
    }

    /// Returns the names, sorted.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.tensors.keys().map(String::as_str)
    }

    /// Returns the number of tensors.
    pub fn len(&self) -> usize {
        self.tensors.len()
    }

    /// Returns true if there are no tensors.
    pub fn is_empty(&self) -> bool {
        self.tensors.is_empty()
    }
}

/// Returns the error for a number of elements that differs from the shape's.
pub(crate) fn unfilled(shape: &[usize], elements: usize) -> Error {
    let tensor = format!("a tensor of shape {shape:?}");
    Error::size(&tensor, &[elements], "elements", "one for each place")
}
