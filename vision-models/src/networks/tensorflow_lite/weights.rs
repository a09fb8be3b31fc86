//! The weights of a file of TensorFlow Lite, in the order of the engine's kernels.

use std::collections::BTreeMap;
use std::fmt;

use crate::error::Error;
use crate::weights::tensorflow_lite::{Constant, Model};
use crate::weights::{Tensor, TensorSource, no_tensor};

/// A weight and the source of its elements.
#[derive(Clone, Debug)]
pub(super) struct Weight {
    /// Shape in the engine.
    pub(super) shape: Vec<usize>,
    pub(super) source: Source,
}

/// The source of a weight's elements.
#[derive(Clone, Debug)]
pub(super) enum Source {
    /// Elements in their order, repeated until the shape is full.
    InOrder(Constant),
    /// Outputs × rows × columns × inputs, reordered to outputs × inputs × rows × columns.
    Kernel(Constant),
    /// Rows × columns × outputs, reordered to outputs × rows × columns.
    Depthwise(Constant),
    /// One everywhere.
    Ones,
    /// Outputs × inputs: one where the output's number is the input's plus this offset.
    Ahead(usize),
    /// Inputs × outputs × rows × columns: one where an input goes to a pixel of the square.
    DepthToSpace,
}

impl Weight {
    /// Returns the number of elements. Saturates beyond the size of memory.
    pub(super) fn elements(&self) -> usize {
        self.shape.iter().fold(1, |product: usize, &axis| product.saturating_mul(axis))
    }

    fn read(&self, model: &Model<'_>) -> Result<Vec<f32>, Error> {
        let Self { shape, source } = self;
        let count = self.elements();
        let inner = |from: usize| shape.get(from..).unwrap_or_default().iter().product::<usize>();
        Ok(match source {
            Source::InOrder(constant) => {
                constant.read(model)?.into_iter().cycle().take(count).collect()
            }
            Source::Kernel(constant) => transposed(&constant.read(model)?, inner(2), shape[1]),
            Source::Depthwise(constant) => transposed(&constant.read(model)?, inner(1), shape[0]),
            Source::Ones => vec![1.0; count],
            Source::Ahead(ahead) => {
                let inputs = shape[1];
                let one = |index: usize| index / inputs == index % inputs + ahead;
                (0..count).map(|index| if one(index) { 1.0 } else { 0.0 }).collect()
            }
            Source::DepthToSpace => {
                let (outputs, pixels) = (shape[1], inner(2));
                let one = |index: usize| {
                    let (input, output, pixel) =
                        (index / (outputs * pixels), index / pixels % outputs, index % pixels);
                    input == pixel * outputs + output
                };
                (0..count).map(|index| if one(index) { 1.0 } else { 0.0 }).collect()
            }
        })
    }
}

/// Returns matrices of rows × columns, each transposed.
fn transposed(values: &[f32], rows: usize, columns: usize) -> Vec<f32> {
    let mut turned = Vec::with_capacity(values.len());
    for matrix in values.chunks_exact((rows * columns).max(1)) {
        for column in 0..columns {
            turned.extend(matrix.iter().skip(column).step_by(columns));
        }
    }
    turned
}

/// Weights that are read from the file on demand.
pub(super) struct Weights {
    file: Vec<u8>,
    weights: BTreeMap<String, Weight>,
}

impl Weights {
    pub(super) fn new(file: Vec<u8>, weights: BTreeMap<String, Weight>) -> Self {
        Self { file, weights }
    }

    /// Returns the file from which they are read.
    pub(super) fn into_file(self) -> Vec<u8> {
        self.file
    }
}

impl fmt::Debug for Weights {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let names = self.weights.keys();
        formatter.debug_struct("Weights").field("names", &names).finish_non_exhaustive()
    }
}

impl TensorSource for Weights {
    fn names(&self) -> Vec<&str> {
        self.weights.keys().map(String::as_str).collect()
    }

    fn shape(&self, name: &str) -> Option<&[usize]> {
        self.weights.get(name).map(|weight| weight.shape.as_slice())
    }

    fn take(&mut self, name: &str) -> Result<Tensor, Error> {
        let weight = self.weights.get(name).ok_or_else(|| no_tensor(name))?;
        Tensor::new(weight.shape.clone(), weight.read(&Model::of(&self.file)?)?)
    }
}
