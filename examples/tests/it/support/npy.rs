//! Arrays in files.

use std::{fs::File, path::Path};

use human_perception::npy::{read_array, write_array};
use ndarray::{Array, ArrayD, Dimension};

/// Writes an array, or panics.
pub(crate) fn write_npy<D: Dimension>(path: impl AsRef<Path>, array: &Array<f32, D>) {
    write_array(&mut File::create(path).unwrap(), array).unwrap();
}

/// Reads an array, or panics.
pub(crate) fn read_npy(path: impl AsRef<Path>) -> ArrayD<f32> {
    read_array(path.as_ref()).unwrap()
}
