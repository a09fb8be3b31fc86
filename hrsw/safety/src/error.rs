//! What can be wrong with bodies, people and settings.

use hrsw::Capsule;

use crate::fault::FrameFault;

/// Misuse of the crate, or people as they cannot be.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A number is not finite or out of its range.
    #[error("{what} is {got}; it must be {wanted}")]
    Value {
        /// The parameter or the item that holds the number.
        what: &'static str,
        /// The number.
        got: f64,
        /// The range it must lie in.
        wanted: &'static str,
    },

    /// A matrix, vector, buffer or index does not fit.
    #[error("{what} has size {got}, but {wanted} was expected")]
    Size {
        /// The offending item.
        what: &'static str,
        /// Its size.
        got: usize,
        /// The size that fits.
        wanted: usize,
    },

    /// More people are in view than are kept apart.
    #[error(
        "{got} people are in view beside the one who may work with the robot, {left_out} more than are kept \
         apart with those of the frames before: there is room for {most}"
    )]
    TooManyPeople {
        /// How many were given.
        got: usize,
        /// How many of them there was no room for.
        left_out: usize,
        /// How many there is room for.
        most: usize,
    },

    /// A camera frame counts as no data: nobody can have come so far since the frame before.
    #[error(
        "{}: they would have moved at {speed:.1} m/s or more since the frame before; give metres and seconds",
        FrameFault::ImpossibleSpeed
    )]
    BodySpeed {
        /// The least speed that explains it \[m/s\].
        speed: f64,
    },

    /// The solver's crate refused the rows.
    #[error(transparent)]
    Hierarchy(#[from] ahqp_core::Error),
}

/// More rows of one kind than a hierarchy is solved with in time.
const MOST_ROWS: usize = 1000;

pub(crate) fn positive(what: &'static str, got: f64) -> Result<f64, Error> {
    if got > 0.0 && got.is_finite() {
        Ok(got)
    } else {
        Err(Error::Value { what, got, wanted: "positive and finite" })
    }
}

pub(crate) fn not_negative(what: &'static str, got: f64) -> Result<f64, Error> {
    if got >= 0.0 && got.is_finite() {
        Ok(got)
    } else {
        Err(Error::Value { what, got, wanted: "finite and not negative" })
    }
}

/// Checks a number of rows, before memory is taken for them.
pub(crate) fn check_count(what: &'static str, count: usize) -> Result<(), Error> {
    if count > MOST_ROWS {
        #[expect(clippy::cast_precision_loss, reason = "it is shown")]
        let got = count as f64;
        return Err(Error::Value { what, got, wanted: "at most 1000" });
    }
    Ok(())
}

pub(crate) fn check_size(what: &'static str, got: usize, wanted: usize) -> Result<(), Error> {
    if got == wanted { Ok(()) } else { Err(Error::Size { what, got, wanted }) }
}

pub(crate) fn check_all<'a>(
    what: &'static str,
    mut values: impl Iterator<Item = &'a f64>,
) -> Result<(), Error> {
    match values.find(|value| !value.is_finite()) {
        Some(&got) => Err(Error::Value { what, got, wanted: "finite" }),
        None => Ok(()),
    }
}

/// The same of numbers in one piece, quicker.
pub(crate) fn check_slice(what: &'static str, values: &[f64]) -> Result<(), Error> {
    let fine = values.iter().fold(true, |fine, value| fine & value.is_finite());
    if fine { Ok(()) } else { check_all(what, values.iter()) }
}

/// Placed by a pose that is not finite, a capsule is not either.
pub(crate) fn check_capsule(what: &'static str, capsule: &Capsule) -> Result<(), Error> {
    let (start, end) = (capsule.start(), capsule.end());
    // The sum of finite numbers is not finite at most where they are very large.
    if (start + end).sum().is_finite() {
        return Ok(());
    }
    check_all(what, start.iter().chain(end))
}
