//! Slowdown near singular configurations.

use nalgebra::{Matrix6, Matrix6xX};

use crate::error::Error;

/// Manipulability below which a posture counts as singular; it is then rounding.
pub(crate) const SINGULAR: f64 = 1e-6;

/// Slowdown of joints near singular configurations. There a small motion of the tool needs large joint motions, and the
/// arm would oscillate at its limits.
///
/// The measure is [`manipulability`] over its value at the [posture](crate::PostureSettings). MOCA has hardly any with
/// a stretched arm. A robot that is singular at its posture is not slowed down, such as one with fewer than six joints.
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
    /// Share of the posture's manipulability below which the joints slow down in proportion to it. Default 0.35.
    pub share: f64,
    /// Least share of their speeds that the joints keep, above 0. Default 0.05.
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

    /// The share of their speeds that the joints may use at this share of the posture's manipulability. NaN counts as
    /// singular.
    pub fn speed_scale(&self, share: f64) -> f64 {
        if share > 0.0 { (share / self.share).clamp(self.slowest, 1.0) } else { self.slowest }
    }
}

/// Yoshikawa's manipulability w = √det(J Jᵀ), 0 in singular configurations up to rounding (Int. J. Robotics Research
/// 4(2), 1985).
///
/// The Jacobian is that of the tool for all joints, 6 × n, linear, then angular \[m/s, rad/s\].
pub fn manipulability(jacobian: &Matrix6xX<f64>) -> f64 {
    manipulability_behind(jacobian, 0)
}

/// The manipulability of the joints behind the first ones alone.
pub(crate) fn manipulability_behind(jacobian: &Matrix6xX<f64>, first: usize) -> f64 {
    let mut gram = Matrix6::zeros();
    for column in jacobian.column_iter().skip(first) {
        gram.ger(1.0, &column, &column, 1.0);
    }
    gram.cholesky().map_or(0.0, |factor| factor.l_dirty().diagonal().product())
}
