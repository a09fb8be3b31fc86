//! Errors of bodies, people and settings.

use hrsw::Capsule;
pub(crate) use hrsw::checks::{check_all, check_size, not_negative, positive};

use crate::fault::FrameFault;

/// Misuse of the crate, or observations of people that are impossible.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A number is not finite or out of its range.
    #[error("{what} is {got}; it must be {wanted}")]
    Value {
        /// Name of the parameter or of the item that contains the number.
        what: &'static str,
        /// The number.
        got: f64,
        /// The allowed range.
        wanted: &'static str,
    },

    /// A matrix, vector, buffer or index does not fit.
    #[error("{what} has size {got}, but {wanted} was expected")]
    Size {
        /// The offending item.
        what: &'static str,
        /// Size it has.
        got: usize,
        /// The size that fits.
        wanted: usize,
    },

    /// There is no room to track all people in view.
    #[error(
        "{got} people are in view, {left_out} more than there is room for with those of the frames before: \
         {most} beside the one who may work with the robot"
    )]
    TooManyPeople {
        /// Number of bodies that were given.
        got: usize,
        /// Number of bodies for which there was no room.
        left_out: usize,
        /// Number of people that there is room for.
        most: usize,
    },

    /// The camera frame counts as no data, since nobody can have moved so far since the frame
    /// before.
    #[error(
        "{}: they would have moved at {speed:.1} m/s or more since the frame before; give metres and seconds",
        FrameFault::ImpossibleSpeed
    )]
    BodySpeed {
        /// The smallest speed that explains it \[m/s\].
        speed: f64,
    },

    /// The shape of a body was refused.
    #[error(transparent)]
    Shape(Box<hrsw::Error>),

    /// The rows were refused by `ahqp-core`.
    #[error(transparent)]
    Hierarchy(#[from] ahqp_core::Error),
}

impl From<hrsw::Error> for Error {
    fn from(error: hrsw::Error) -> Self {
        match error {
            hrsw::Error::Value { what, got, wanted } => Self::Value { what, got, wanted },
            hrsw::Error::Size { what, got, wanted } => Self::Size { what, got, wanted },
            hrsw::Error::Hierarchy(error) => Self::Hierarchy(error),
            error => Self::Shape(Box::new(error)),
        }
    }
}

/// Checks numbers in one slice, faster than [`check_all`].
pub(crate) fn check_slice(what: &'static str, values: &[f64]) -> Result<(), Error> {
    let fine = values.iter().fold(true, |fine, value| fine & value.is_finite());
    if fine { Ok(()) } else { Ok(check_all(what, values.iter())?) }
}

/// Checks that a capsule is finite. A capsule that is placed by a pose that is not finite is not
/// finite either.
pub(crate) fn check_capsule(what: &'static str, capsule: &Capsule) -> Result<(), Error> {
    let (start, end) = (capsule.start(), capsule.end());
    // The sum can overflow if finite numbers are very large. These are checked one by one.
    if (start + end).sum().is_finite() {
        return Ok(());
    }
    Ok(check_all(what, start.iter().chain(end))?)
}
