//! Age of an observation.

use crate::error::{Error, not_negative};

/// Time since something was seen \[s\]. It is never negative and never NaN.
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
    /// Age of something that was never seen. It is greater than every other age.
    pub const NEVER: Self = Self(f64::INFINITY);

    /// Creates an age from seconds.
    ///
    /// # Errors
    /// [`Error::Value`] if the age is negative, infinite or NaN.
    pub fn new(seconds: f64) -> Result<Self, Error> {
        Ok(Self(not_negative("an age", seconds)?))
    }

    /// Returns the age at the time `now` of an observation stamped `stamp`, both on one clock
    /// \[s\]. A stamp ahead of `now` gives zero. A time that is not finite gives
    /// [`NEVER`](Self::NEVER).
    pub(crate) fn since(stamp: f64, now: f64) -> Self {
        let age = now - stamp;
        if age.is_finite() { Self(age.max(0.0)) } else { Self::NEVER }
    }

    /// Returns the age in seconds, infinite for [`NEVER`](Self::NEVER).
    pub fn seconds(self) -> f64 {
        self.0
    }
}
