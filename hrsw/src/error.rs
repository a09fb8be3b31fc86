//! Errors of shapes and workspaces.

use nalgebra::Isometry3;

pub(crate) use crate::checks::{check_all, check_size, not_negative, positive};

/// Misuse of the crate.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A number is not finite or out of its range, or a quaternion is not a rotation.
    #[error("{what} is {got}; it must be {wanted}")]
    Value {
        /// Name of the parameter or of the item that contains the number.
        what: &'static str,
        /// The number.
        got: f64,
        /// The allowed range.
        wanted: &'static str,
    },

    /// A matrix, vector, buffer or part of the augmented state does not fit.
    #[error("{what} has size {got}, but {wanted} was expected")]
    Size {
        /// The offending item.
        what: &'static str,
        /// Size it has.
        got: usize,
        /// The size that fits.
        wanted: usize,
    },

    /// There are more parts than there is room for.
    #[error("{what}: {got} are needed, there is room for {most}; simplify, or make more room")]
    TooMany {
        /// Name of the parts.
        what: &'static str,
        /// Number of parts.
        got: usize,
        /// Largest number of parts.
        most: usize,
    },

    /// A lower bound lies above its upper bound.
    #[error("{what}, axis {axis}: the minimum {min} lies above the maximum {max}; swap them")]
    EmptyRange {
        /// Name of the bounds.
        what: &'static str,
        /// The axis, 0 to 2.
        axis: usize,
        /// The lower bound.
        min: f64,
        /// The upper bound.
        max: f64,
    },

    /// The half-spaces or points enclose no volume.
    #[error("the {faces} half-spaces or points of the polytope enclose no volume; move them apart")]
    NoVolume {
        /// Number of given half-spaces or points.
        faces: usize,
    },

    /// The half-spaces do not bound a finite set.
    #[error("the polytope reaches farther than {limit} m; close it with more half-spaces")]
    Unbounded {
        /// The largest coordinate that a polytope may have \[m\].
        limit: f64,
    },

    /// The rows were refused by `ahqp-core`.
    #[error(transparent)]
    Hierarchy(#[from] ahqp_core::Error),
}

pub(crate) fn check_pose(pose: &Isometry3<f64>) -> Result<(), Error> {
    check_all("the translation of a frame", pose.translation.vector.iter())?;
    check_rotation("the rotation of a frame", &pose.rotation)
}

pub(crate) fn check_rotation(
    what: &'static str,
    rotation: &nalgebra::UnitQuaternion<f64>,
) -> Result<(), Error> {
    check_all(what, rotation.coords.iter())?;
    let got = rotation.coords.norm();
    let wanted = "1, the norm of a unit quaternion; normalise it";
    if (got - 1.0).abs() < 1e-6 { Ok(()) } else { Err(Error::Value { what, got, wanted }) }
}
