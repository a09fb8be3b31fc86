//! Networks from files of TensorFlow Lite.

mod lowering;
mod operators;
mod values;
mod weights;

use std::fs::File;
use std::io::Read;
use std::path::Path;

use crate::engine::{Graph, Network, Options};
use crate::error::Error;
use crate::file::{in_file, read_bytes};
use crate::weights::tensorflow_lite::is_tensorflow_lite;

use lowering::Lowering;
use operators::operate;
use values::Shape;
use weights::Weights;

/// Largest file that is read (bytes).
const LARGEST: u64 = 1 << 30;

/// A network from a file of TensorFlow Lite: its layers and its weights.
///
/// Weights are float32 or float16, dense or sparse. The operators are CONV_2D, DEPTHWISE_CONV_2D, ADD, MAX_POOL_2D,
/// PAD, RESIZE_BILINEAR, RESHAPE, CONCATENATION, DEPTH_TO_SPACE, LOGISTIC, RELU, RELU6, PRELU, DEQUANTIZE and
/// DENSIFY. Reading a file takes at most four times its size and 256 KiB of memory. The weights are read
/// when the network is loaded: in float32 they take at most six times the file's size and 256 KiB.
///
/// Tensors of TensorFlow Lite with fewer than four axes have the last ones: 1 × 195 values are 195
/// channels of one pixel.
///
/// ```
/// use vision_models::{Options, TensorFlowLite, ndarray::Array5};
///
/// let file = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/operators.tflite");
/// let network = TensorFlowLite::open(file)?;
/// let [channels, rows, columns] = network.input();
/// let image = Array5::zeros((1, channels, 1, rows, columns));
/// let mut network = network.load(Options::default())?;
/// let inference = network.infer(image.view())?;
/// assert!(inference.map(0).is_some());
/// # Ok::<(), vision_models::Error>(())
/// ```
#[derive(Debug)]
pub struct TensorFlowLite {
    graph: Graph,
    weights: Weights,
    input: Shape,
    outputs: Vec<Shape>,
}

impl TensorFlowLite {
    /// Returns true if a file begins like a file of TensorFlow Lite. False if it cannot be read.
    pub fn is_in(path: impl AsRef<Path>) -> bool {
        let mut start = [0; 8];
        let read = File::open(path).and_then(|mut file| file.read_exact(&mut start));
        read.is_ok() && is_tensorflow_lite(&start)
    }

    /// Reads a file.
    ///
    /// # Errors
    /// [`Error::File`] if it cannot be read, [`Error::Checkpoint`] if it is rejected.
    pub fn open(path: impl AsRef<Path>) -> Result<Self, Error> {
        let path = path.as_ref();
        Self::from_bytes(read_bytes(path, LARGEST).map_err(in_file(path))?)
    }

    /// Reads a file in memory.
    ///
    /// # Errors
    /// [`Error::Checkpoint`] if the bytes are no such file, are inconsistent, hold unsupported
    /// operators or numbers, or need too much memory.
    pub fn from_bytes(file: Vec<u8>) -> Result<Self, Error> {
        Self::of(file, &[])
    }

    /// Returns the network with only these outputs, by their numbers and in this order. Layers that
    /// they do not need are not computed.
    ///
    /// # Errors
    /// [`Error::Checkpoint`] if an output does not exist.
    pub fn keep(self, outputs: &[usize]) -> Result<Self, Error> {
        Self::of(self.weights.into_file(), outputs)
    }

    fn of(file: Vec<u8>, kept: &[usize]) -> Result<Self, Error> {
        let (mut lowering, needed) = Lowering::begin(&file, kept)?;
        for (operator, _) in needed.into_iter().enumerate().filter(|(_, needed)| *needed) {
            operate(&mut lowering, operator)?;
        }
        let Lowering { graph, weights, input, outputs, .. } = lowering.finish()?;
        Ok(Self { graph, weights: Weights::new(file, weights), input, outputs })
    }

    /// Returns channels, rows and columns of the input images.
    pub fn input(&self) -> [usize; 3] {
        self.input.image()
    }

    /// Returns channels, rows and columns of each output, in order.
    pub fn outputs(&self) -> impl Iterator<Item = [usize; 3]> {
        self.outputs.iter().map(Shape::image)
    }

    /// Packs the weights and plans the pass.
    ///
    /// # Errors
    /// Those of [`Network::load`].
    pub fn load(self, options: Options) -> Result<Network, Error> {
        Network::load(&self.graph, self.weights, self.input.size, options)
    }
}
