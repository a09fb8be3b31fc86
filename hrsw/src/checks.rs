//! Checks of arguments, also for `hrsw-safety`.

use crate::error::Error;

/// Returns the number if it is positive and finite.
///
/// # Errors
/// [`Error::Value`] if not.
#[inline]
pub fn positive(what: &'static str, got: f64) -> Result<f64, Error> {
    if got > 0.0 && got.is_finite() {
        Ok(got)
    } else {
        Err(Error::Value { what, got, wanted: "positive and finite" })
    }
}

/// Returns the number if it is finite and not negative.
///
/// # Errors
/// [`Error::Value`] if not.
#[inline]
pub fn not_negative(what: &'static str, got: f64) -> Result<f64, Error> {
    if got >= 0.0 && got.is_finite() {
        Ok(got)
    } else {
        Err(Error::Value { what, got, wanted: "finite and not negative" })
    }
}

/// Checks a size.
///
/// # Errors
/// [`Error::Size`] if it is another.
#[inline]
pub fn check_size(what: &'static str, got: usize, wanted: usize) -> Result<(), Error> {
    if got == wanted { Ok(()) } else { Err(Error::Size { what, got, wanted }) }
}

/// Checks that all numbers are finite.
///
/// # Errors
/// [`Error::Value`] if not.
#[inline]
pub fn check_all<'a>(
    what: &'static str,
    mut values: impl Iterator<Item = &'a f64>,
) -> Result<(), Error> {
    match values.find(|value| !value.is_finite()) {
        Some(&got) => Err(Error::Value { what, got, wanted: "finite" }),
        None => Ok(()),
    }
}
