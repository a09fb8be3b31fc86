//! Images and weights in files.

use std::path::PathBuf;

use numpy::ndarray::{Array2, ArrayD};
use numpy::{PyArray2, PyArray3, PyArrayDyn};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use vision_models::{Orientation, Tensors};

use super::weights::in_file;
use crate::failure::{Failure, Result, check_file};

/// Reads a JPEG or PNG file: (height, width, 3), uint8, red, green, blue.
///
/// `exif=True` turns the image as its EXIF data say. Depth images and joints belong to the pixels as they are stored.
#[pyfunction]
#[pyo3(signature = (path, *, exif=false))]
pub(crate) fn read_image(
    py: Python<'_>,
    path: PathBuf,
    exif: bool,
) -> Result<Bound<'_, PyArray3<u8>>> {
    check_file(&path)?;
    let orientation = if exif { Orientation::Exif } else { Orientation::Stored };
    let image = py.detach(|| vision_models::read_image_oriented(&path, orientation))?;
    Ok(PyArray3::from_owned_array(py, image))
}

/// Reads a grey PNG of 16 bits: depths [m], (height, width), float32; 0 where nothing was measured.
///
/// `unit` is the length of one unit [m].
#[pyfunction]
#[pyo3(signature = (path, *, unit=0.001))]
pub(crate) fn read_depth(
    py: Python<'_>,
    path: PathBuf,
    unit: f64,
) -> Result<Bound<'_, PyArray2<f32>>> {
    check_file(&path)?;
    let depth = py.detach(|| vision_models::read_depth(&path, unit))?;
    let [width, height] = depth.size();
    let depths = Array2::from_shape_vec((height, width), depth.depths().to_vec());
    let depths = depths.map_err(|error| Failure::runtime(error.to_string()))?;
    Ok(PyArray2::from_owned_array(py, depths))
}

/// Reads the tensors of a checkpoint as a dict of names to arrays of float32.
///
/// The file is one of `torch.save` (.pth, .pt, .pyth) or a .safetensors. Nothing in it is executed.
#[pyfunction]
pub(crate) fn read_weights(py: Python<'_>, path: PathBuf) -> Result<Bound<'_, PyDict>> {
    check_file(&path)?;
    let read = py.detach(|| Tensors::read(&path));
    let mut tensors = read.map_err(|error| in_file(&path, error))?;
    let names: Vec<String> = tensors.names().map(str::to_owned).collect();
    let dict = PyDict::new(py);
    for name in names {
        let Some(tensor) = tensors.remove(&name) else { continue };
        let shape = tensor.shape().to_vec();
        let array = ArrayD::from_shape_vec(shape, tensor.into_data());
        let array = array.map_err(|error| Failure::runtime(error.to_string()))?;
        dict.set_item(name, PyArrayDyn::from_owned_array(py, array))?;
    }
    Ok(dict)
}
