//! Slowing down near singular configurations.

use nalgebra::{Matrix6, Matrix6xX};

use crate::error::Error;

/// A posture with less manipulability is singular but for rounding.
pub(crate) const SINGULAR: f64 = 1e-6;

/// How the joints slow down near singular configurations, where a little motion of the tool takes much of theirs and
/// the arm would swing at its limits.
///
/// How near is said by [`manipulability`], as a share of that at the [posture](crate::PostureSettings): MOCA has
/// nearly none of it with a stretched arm. A robot that is singular at its
/// posture, as one with fewer than six joints is everywhere, is not slowed down.
///
/// ```
/// use moca_model::SingularitySettings;
///
/// let settings = SingularitySettings { share: 0.5, slowest: 0.1 };
/// assert_eq!(settings.speed_scale(0.8), 1.0);
/// assert_eq!(settings.speed_scale(0.25), 0.5);
/// assert_eq!(settings.speed_scale(0.01), 0.1);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize, schemars::JsonSchema))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct SingularitySettings {
    /// The share of the posture's manipulability below which the joints slow down, in proportion to it. Default 0.35.
    pub share: f64,
    /// The share of their speeds that they keep, above 0. Default 0.05.
    pub slowest: f64,
}

impl Default for SingularitySettings {
    fn default() -> Self {
        Self { share: 0.35, slowest: 0.05 }
    }
}

impl SingularitySettings {
    /// Checks the ranges.
    ///
    /// # Errors
    /// [`Error::Setting`] names the one that is out of range.
    pub fn validate(&self) -> Result<(), Error> {
        for (name, value) in
            [("singularity.share", self.share), ("singularity.slowest", self.slowest)]
        {
            if !(value > 0.0 && value <= 1.0) {
                return Err(Error::Setting { name, value, expected: "above 0, at most 1" });
            }
        }
        Ok(())
    }

    /// The share of their speeds that the joints may use at this share of the posture's manipulability. What is no
    /// number is as near as can be.
    pub fn speed_scale(&self, share: f64) -> f64 {
        if share > 0.0 { (share / self.share).clamp(self.slowest, 1.0) } else { self.slowest }
    }
}

/// Yoshikawa's measure of how far from singular a configuration is, w = √det(J Jᵀ) (Int. J. Robotics Research 4(2),
/// 1985), for the tool's Jacobian of all joints, 6 × n, linear then angular \[m/s, rad/s\]: 0 where it is singular but
/// for rounding.
pub fn manipulability(jacobian: &Matrix6xX<f64>) -> f64 {
    manipulability_behind(jacobian, 0)
}

/// The same of the joints behind the first ones alone.
pub(crate) fn manipulability_behind(jacobian: &Matrix6xX<f64>, first: usize) -> f64 {
    let mut gram = Matrix6::zeros();
    for column in jacobian.column_iter().skip(first) {
        gram.ger(1.0, &column, &column, 1.0);
    }
    gram.cholesky().map_or(0.0, |factor| factor.l_dirty().diagonal().product())
}
