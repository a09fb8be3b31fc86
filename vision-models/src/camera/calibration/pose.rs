//! Poses in calibrations, and the error of a file that is refused.

use nalgebra::{Isometry3, Matrix3, Rotation3, Vector3};

use crate::error::Error;

/// Rows of a rotation are of length one and square to each other to this.
const ROTATION: f64 = 1e-3;

pub(super) fn refuse(problem: impl Into<String>) -> Error {
    Error::malformed("no calibration of cameras", problem)
}

/// A pose from a rotation's rows and the camera's place.
pub(super) fn pose(rotation: Matrix3<f64>, place: Vector3<f64>) -> Result<Isometry3<f64>, Error> {
    let off = (rotation * rotation.transpose() - Matrix3::identity()).abs().max();
    let is_rotation = off < ROTATION && rotation.determinant() > 0.0;
    if !(is_rotation && place.iter().all(|value| value.abs() < 1e6)) {
        return Err(refuse("a pose that is no rigid motion"));
    }
    Ok(Isometry3::from_parts(place.into(), Rotation3::from_matrix(&rotation).into()))
}
