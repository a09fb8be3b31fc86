//! Networks from files of TensorFlow Lite.

use std::path::PathBuf;

use numpy::PyArray4;
use numpy::ndarray::{Array4, Axis, Ix4};
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use vision_models::engine::Network;

use super::arrays::floats;
use super::weights::{in_file, options};
use crate::failure::{Failure, Result, check_file};
use crate::shared::Shared;

/// Reads a file, or one in memory.
pub(super) fn open(name: &str, file: &Bound<'_, PyAny>) -> Result<vision_models::TensorFlowLite> {
    if let Ok(bytes) = file.cast::<PyBytes>() {
        return Ok(vision_models::TensorFlowLite::from_bytes(bytes.as_bytes().to_vec())?);
    }
    let path: PathBuf = file.extract().map_err(|_| {
        Failure::type_of_argument(format!("{name} must be a path, or the bytes of a file"))
    })?;
    check_file(&path)?;
    let read = file.py().detach(|| vision_models::TensorFlowLite::open(&path));
    Ok(read.map_err(|error| in_file(&path, error))?)
}

/// A network from a file of TensorFlow Lite.
///
/// `TensorFlowLite(file, *, outputs=None, threads=1)`
///
/// Parameters
/// ----------
/// file : path or bytes
/// outputs : sequence of int, optional
///     The outputs that are computed, by their numbers; all if not given.
/// threads : int
///     Threads that share the work.
///
/// Weights are float32 or float16, dense or sparse. The operators are CONV_2D, DEPTHWISE_CONV_2D, ADD, MAX_POOL_2D, PAD,
/// RESIZE_BILINEAR, RESHAPE, CONCATENATION, DEPTH_TO_SPACE, LOGISTIC, RELU, RELU6, PRELU, DEQUANTIZE and DENSIFY.
///
/// Arrays have the axes of TensorFlow Lite: images, rows, columns, channels. Tensors with fewer axes have the last ones.
///
/// >>> from ahqp.vision import TensorFlowLite
/// >>> TensorFlowLite(b"no network")
/// Traceback (most recent call last):
///     ...
/// ahqp.Error: not a file of TensorFlow Lite: bytes 4 to 7 are not "TFL3"
#[pyclass(frozen, module = "ahqp.vision")]
pub(crate) struct TensorFlowLite {
    network: Shared<Network>,
    input: [usize; 3],
    outputs: Vec<[usize; 3]>,
}

#[pymethods]
impl TensorFlowLite {
    #[new]
    #[pyo3(signature = (file, *, outputs=None, threads=1))]
    fn new(
        py: Python<'_>,
        file: &Bound<'_, PyAny>,
        outputs: Option<Vec<usize>>,
        threads: usize,
    ) -> Result<Self> {
        let mut file = open("file", file)?;
        if let Some(outputs) = outputs {
            if outputs.is_empty() {
                return Err(Failure::value("outputs is empty; give the numbers of one or more"));
            }
            file = file.keep(&outputs)?;
        }
        let (input, outputs) = (file.input(), file.outputs().collect());
        let network = py.detach(|| file.load(options(threads)))?;
        Ok(Self { network: Shared::new("TensorFlowLite", network), input, outputs })
    }

    /// Outputs for images, (N, rows, columns, channels): one array of float32 each, with the axes of the images.
    fn infer<'py>(
        &self,
        py: Python<'py>,
        images: &Bound<'py, PyAny>,
    ) -> Result<Vec<Bound<'py, PyArray4<f32>>>> {
        let images = floats::<Ix4>("images", images, "(N, rows, columns, channels)")?;
        let images = images.permuted_axes([0, 3, 1, 2]).insert_axis(Axis(2));
        let mut network = self.network.lock()?;
        let (network, count) = (&mut *network, self.outputs.len());
        let outputs =
            py.detach(|| -> std::result::Result<Vec<Array4<f32>>, vision_models::Error> {
                let inference = network.infer(images.view())?;
                let map = |index| {
                    let map = inference.map(index)?.index_axis_move(Axis(2), 0);
                    Some(map.permuted_axes([0, 2, 3, 1]).as_standard_layout().into_owned())
                };
                Ok((0..count).filter_map(map).collect())
            })?;
        Ok(outputs.into_iter().map(|output| PyArray4::from_owned_array(py, output)).collect())
    }

    /// Rows, columns and channels of an image.
    #[getter]
    fn input(&self) -> (usize, usize, usize) {
        channels_last(self.input)
    }

    /// Rows, columns and channels of each output.
    #[getter]
    fn outputs(&self) -> Vec<(usize, usize, usize)> {
        self.outputs.iter().copied().map(channels_last).collect()
    }

    /// Multiplications and additions for one image.
    #[getter]
    fn operations(&self) -> Result<u64> {
        Ok(self.network.lock()?.operations())
    }
}

fn channels_last([channels, rows, columns]: [usize; 3]) -> (usize, usize, usize) {
    (rows, columns, channels)
}
