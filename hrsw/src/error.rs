//! What can be wrong with a workspace, a body or a safety setting.

use nalgebra::Isometry3;

/// Misuse of the crate.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A number is NaN or infinite.
    #[error("{what} holds {value}, which is not finite; check where it comes from")]
    NotFinite {
        /// The offending item.
        what: &'static str,
        /// The value.
        value: f64,
    },

    /// A quaternion is no rotation.
    #[error("{what} has a quaternion of norm {norm}; normalise it")]
    NotUnit {
        /// The offending item.
        what: &'static str,
        /// The norm of its quaternion.
        norm: f64,
    },

    /// A lower bound lies above its upper bound.
    #[error("{what}, axis {axis}: the minimum {min} lies above the maximum {max}; swap them")]
    Empty {
        /// The bounds.
        what: &'static str,
        /// The axis, 0 to 2.
        axis: usize,
        /// The lower bound.
        min: f64,
        /// The upper bound.
        max: f64,
    },

    /// Half-spaces or points that enclose no volume.
    #[error("the {faces} half-spaces or points of the polytope enclose no volume; move them apart")]
    NoVolume {
        /// How many half-spaces or points were given.
        faces: usize,
    },

    /// Half-spaces that leave a way to infinity.
    #[error("the polytope reaches farther than {limit} m; close it with more half-spaces")]
    Unbounded {
        /// The largest coordinate that a polytope may have \[m\].
        limit: f64,
    },

    /// More parts than there is room for.
    #[error("{what}: {found} are needed, there is room for {limit}; simplify, or make more room")]
    TooMany {
        /// What there are too many of.
        what: &'static str,
        /// How many.
        found: usize,
        /// How many there may be.
        limit: usize,
    },

    /// Orientation bounds reach rotations by half a turn, where rotation vectors jump.
    #[error(
        "the orientation bounds reach an angle of {angle:.3} rad; keep their corners within {limit:.3} rad and turn the reference frame instead"
    )]
    AngleTooLarge {
        /// The angle of the farthest corner \[rad\].
        angle: f64,
        /// The largest angle allowed \[rad\].
        limit: f64,
    },

    /// A parameter is out of its range.
    #[error("{name} is {value}; it must be {expected}")]
    Parameter {
        /// The parameter.
        name: &'static str,
        /// Its value.
        value: f64,
        /// The range it must lie in.
        expected: &'static str,
    },

    /// A measurement is older than the newest one.
    #[error(
        "a measurement that is {age} s old comes after one that is {newest} s old; give them in \
         the order in which they were taken"
    )]
    OutOfOrder {
        /// Its age \[s\].
        age: f64,
        /// The age of the newest one \[s\].
        newest: f64,
    },

    /// The augmented state has no room for the slack, or no 6-dimensional task.
    #[error("the augmented state has {found} {what}; the softened workspace needs {expected}")]
    State {
        /// The part of the state.
        what: &'static str,
        /// How many it has.
        found: usize,
        /// How many are needed.
        expected: usize,
    },

    /// A matrix, vector or buffer does not fit.
    #[error("{what} has size {found}, but {expected} was expected")]
    Size {
        /// The offending item.
        what: &'static str,
        /// Its size.
        found: usize,
        /// The size that fits.
        expected: usize,
    },

    /// The solver's crate refused the rows.
    #[error(transparent)]
    Hierarchy(#[from] ahqp_core::Error),
}

pub(crate) fn positive(name: &'static str, value: f64) -> Result<f64, Error> {
    if value > 0.0 && value.is_finite() {
        Ok(value)
    } else {
        Err(Error::Parameter { name, value, expected: "positive and finite" })
    }
}

pub(crate) fn not_negative(name: &'static str, value: f64) -> Result<f64, Error> {
    if value >= 0.0 && value.is_finite() {
        Ok(value)
    } else {
        Err(Error::Parameter { name, value, expected: "finite and not negative" })
    }
}

pub(crate) fn check_size(what: &'static str, found: usize, expected: usize) -> Result<(), Error> {
    if found == expected { Ok(()) } else { Err(Error::Size { what, found, expected }) }
}

pub(crate) fn check_all<'a>(
    what: &'static str,
    mut values: impl Iterator<Item = &'a f64>,
) -> Result<(), Error> {
    match values.find(|value| !value.is_finite()) {
        Some(&value) => Err(Error::NotFinite { what, value }),
        None => Ok(()),
    }
}

/// The same of numbers in one piece, quicker.
pub(crate) fn check_slice(what: &'static str, values: &[f64]) -> Result<(), Error> {
    let fine = values.iter().fold(true, |fine, value| fine & value.is_finite());
    if fine { Ok(()) } else { check_all(what, values.iter()) }
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
    let norm = rotation.coords.norm();
    if (norm - 1.0).abs() < 1e-6 { Ok(()) } else { Err(Error::NotUnit { what, norm }) }
}
