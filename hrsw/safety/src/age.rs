//! How old something that was seen is.

use crate::error::{Error, not_negative};

/// How long ago something was seen \[s\]: never negative and never NaN.
///
/// ```
/// use hrsw_safety::Age;
///
/// let age = Age::new(0.05)?;
/// assert!(age < Age::NEVER);
/// assert!(Age::new(-1e9).is_err() && Age::new(f64::NAN).is_err());
/// # Ok::<(), hrsw_safety::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd)]
pub struct Age(f64);

impl Age {
    /// The age of what was not seen yet: older than everything.
    pub const NEVER: Self = Self(f64::INFINITY);

    /// An age in seconds.
    ///
    /// # Errors
    /// [`Error::Value`] for one that is negative, infinite or NaN.
    pub fn new(seconds: f64) -> Result<Self, Error> {
        Ok(Self(not_negative("an age", seconds)?))
    }

    /// At the time `now` of what was stamped `stamp`, both on one clock \[s\]; zero where the stamp
    /// is ahead, [`NEVER`](Self::NEVER) where either is no finite number.
    pub(crate) fn since(stamp: f64, now: f64) -> Self {
        let age = now - stamp;
        if age.is_finite() { Self(age.max(0.0)) } else { Self::NEVER }
    }

    /// In seconds; infinite for [`NEVER`](Self::NEVER).
    pub fn seconds(self) -> f64 {
        self.0
    }
}
