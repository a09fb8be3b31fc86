//! The probability that a recognition is right.

use serde::{Deserialize, Serialize};

use crate::error::Error;

/// A confidence in [0, 1]; never NaN.
///
/// ```
/// use vision_models::Confidence;
///
/// assert_eq!(Confidence::new(0.8)?.value(), 0.8);
/// assert!(Confidence::new(f64::NAN).is_err());
/// assert!(Confidence::new(1.2).is_err());
/// # Ok::<(), vision_models::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd, Serialize, Deserialize)]
#[serde(try_from = "f64", into = "f64")]
pub struct Confidence(f64);

impl Confidence {
    /// Certainty.
    pub const ONE: Self = Self(1.0);
    /// Probability zero: no evidence.
    pub const ZERO: Self = Self(0.0);

    /// Creates a confidence from a probability.
    ///
    /// # Errors
    /// [`Error::Value`] if `value` is NaN or outside [0, 1].
    pub fn new(value: f64) -> Result<Self, Error> {
        if (0.0..=1.0).contains(&value) {
            Ok(Self(value))
        } else {
            Err(Error::value("confidence", value, "a probability in [0, 1]"))
        }
    }

    /// Returns the probability, in [0, 1].
    pub fn value(self) -> f64 {
        self.0
    }
}

impl TryFrom<f64> for Confidence {
    type Error = Error;

    fn try_from(value: f64) -> Result<Self, Error> {
        Self::new(value)
    }
}

impl From<Confidence> for f64 {
    fn from(confidence: Confidence) -> Self {
        confidence.value()
    }
}
