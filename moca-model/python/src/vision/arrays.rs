//! Images and batches from Python. They are copied, so that nobody changes them while a network runs.

use numpy::ndarray::{Array, Array3, Dimension, Ix2, Ix3};
use numpy::{
    Element, PyArray, PyArray1, PyArray2, PyArrayDescrMethods, PyArrayMethods, PyUntypedArray,
    PyUntypedArrayMethods, dtype,
};
use pyo3::prelude::*;
use vision_models::DepthImage;

use crate::arrays::{Matrix, real, to_array, to_vector, vector_of};
use crate::failure::{Failure, Result};

/// Reads an image, height × width × 3 bytes.
pub(super) fn image(name: &str, value: &Bound<'_, PyAny>) -> Result<Array3<u8>> {
    let array = real(name, value)?;
    if !is_of::<u8>(&array) {
        let kind = array.dtype();
        return Err(Failure::type_of_argument(format!(
            "{name} is an array of {kind}; it must be one of uint8: height × width × 3, red, green, blue"
        )));
    }
    copy::<u8, Ix3>(name, &array, "uint8", "(height, width, 3)")
}

/// Reads real numbers as f32.
pub(super) fn floats<D: Dimension>(
    name: &str,
    value: &Bound<'_, PyAny>,
    shape: &str,
) -> Result<Array<f32, D>> {
    copy(name, &real(name, value)?, "float32", shape)
}

/// Reads a depth image, height × width: integers of two bytes in units [m], or floats in metres.
pub(super) fn depth(value: &Bound<'_, PyAny>, unit: f64) -> Result<DepthImage> {
    const SHAPE: &str = "(height, width)";
    let array = real("depth", value)?;
    if is_of::<u16>(&array) {
        let units = copy::<u16, Ix2>("depth", &array, "uint16", SHAPE)?;
        let (rows, columns) = units.dim();
        return Ok(DepthImage::from_units([columns, rows], &flat(units), unit)?);
    }
    let kind = array.dtype();
    if kind.kind() != b'f' {
        return Err(Failure::type_of_argument(format!(
            "depth is an array of {kind}; give uint16 in units of `unit`, or floats in metres"
        )));
    }
    let metres = copy::<f32, Ix2>("depth", &array, "float32", SHAPE)?;
    let (rows, columns) = metres.dim();
    Ok(DepthImage::from_metres([columns, rows], flat(metres))?)
}

fn is_of<T: Element>(array: &Bound<'_, PyUntypedArray>) -> bool {
    array.dtype().is_equiv_to(&dtype::<T>(array.py()))
}

/// Converts an array. The copy belongs to nobody else.
fn copy<T: Element, D: Dimension>(
    name: &str,
    array: &Bound<'_, PyUntypedArray>,
    kind: &str,
    shape: &str,
) -> Result<Array<T, D>> {
    let array = array.call_method1("astype", (kind,))?;
    let Ok(array) = array.cast::<PyArray<T, D>>() else {
        let found = array.getattr("shape")?;
        return Err(Failure::value(format!("{name} has shape {found}; it must be {shape}")));
    };
    Ok(array.to_owned_array())
}

/// Returns the entries of an array, the last axis fastest.
pub(super) fn flat<T: Clone, D: Dimension>(array: Array<T, D>) -> Vec<T> {
    let array =
        if array.is_standard_layout() { array } else { array.as_standard_layout().into_owned() };
    let (entries, _) = array.into_raw_vec_and_offset();
    entries
}

/// Reads rows of N numbers each.
pub(super) fn rows<const N: usize>(name: &str, value: &Bound<'_, PyAny>) -> Result<Vec<[f64; N]>> {
    let matrix = Matrix::read(name, value)?.to_nalgebra();
    if matrix.ncols() != N {
        let (rows, columns) = matrix.shape();
        return Err(Failure::value(format!(
            "{name} has shape ({rows}, {columns}); it must have {N} columns"
        )));
    }
    Ok(matrix.row_iter().map(|row| std::array::from_fn(|column| row[column])).collect())
}

/// Reads a number for each of some things: one for all, or an array.
pub(super) fn each(
    name: &str,
    value: Option<&Bound<'_, PyAny>>,
    count: usize,
    default: f64,
) -> Result<Vec<f64>> {
    let Some(value) = value else { return Ok(vec![default; count]) };
    if let Ok(number) = value.extract::<f64>() {
        return Ok(vec![number; count]);
    }
    Ok(vector_of(name, value, count)?.as_array().to_vec())
}

/// Converts points to rows, NaN for those that are missing.
pub(super) fn points<const N: usize>(
    py: Python<'_>,
    points: impl IntoIterator<Item = Option<[f64; N]>>,
) -> Bound<'_, PyArray2<f64>> {
    let flat: Vec<f64> =
        points.into_iter().flat_map(|point| point.unwrap_or([f64::NAN; N])).collect();
    to_array(py, &nalgebra::DMatrix::from_row_iterator(flat.len() / N, N, flat))
}

/// Converts numbers, NaN for those that are missing.
pub(super) fn optional(
    py: Python<'_>,
    numbers: impl IntoIterator<Item = Option<f64>>,
) -> Bound<'_, PyArray1<f64>> {
    let numbers: Vec<f64> = numbers.into_iter().map(|number| number.unwrap_or(f64::NAN)).collect();
    to_vector(py, &numbers)
}
