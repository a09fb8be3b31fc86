//! Limits of one joint.

use crate::error::Error;

/// Limits of one joint: radians for a revolute one, metres for a prismatic one.
///
/// A limit that is not known is infinite: an unlimited position, or an
/// acceleration that neither the URDF nor the description gives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointLimits {
    /// Lowest position \[rad or m\].
    pub lower: f64,
    /// Highest position \[rad or m\].
    pub upper: f64,
    /// Largest speed \[rad/s or m/s\].
    pub velocity: f64,
    /// Largest acceleration \[rad/s² or m/s²\].
    pub acceleration: f64,
    /// Largest jerk \[rad/s³ or m/s³\].
    pub jerk: f64,
    /// Largest torque or force \[Nm or N\].
    pub effort: f64,
}

impl JointLimits {
    /// No limit at all.
    pub const UNLIMITED: Self = Self {
        lower: f64::NEG_INFINITY,
        upper: f64::INFINITY,
        velocity: f64::INFINITY,
        acceleration: f64::INFINITY,
        jerk: f64::INFINITY,
        effort: f64::INFINITY,
    };

    /// The same limits with what `known` says in place.
    #[must_use]
    pub fn with(self, known: &LimitOverride) -> Self {
        let (lower, upper) = known.position.unwrap_or((self.lower, self.upper));
        Self {
            lower,
            upper,
            velocity: known.velocity.unwrap_or(self.velocity),
            acceleration: known.acceleration.unwrap_or(self.acceleration),
            jerk: known.jerk.unwrap_or(self.jerk),
            effort: known.effort.unwrap_or(self.effort),
        }
    }

    /// An error unless the range is not empty, velocity, acceleration and jerk
    /// are positive, and the effort is not negative.
    pub(crate) fn validate(&self, joint: &str) -> Result<(), Error> {
        if self.lower.is_nan() || self.upper.is_nan() || self.lower >= self.upper {
            return Err(Error::PositionLimits {
                joint: joint.to_owned(),
                lower: self.lower,
                upper: self.upper,
            });
        }
        let positive =
            [("velocity", self.velocity), ("acceleration", self.acceleration), ("jerk", self.jerk)];
        for (name, value) in positive {
            if value.is_nan() || value <= 0.0 {
                return Err(Error::NotPositive {
                    what: format!("the {name} limit of joint `{joint}`"),
                    value,
                });
            }
        }
        if self.effort.is_nan() || self.effort < 0.0 {
            return Err(Error::Negative {
                what: format!("the effort limit of joint `{joint}`"),
                value: self.effort,
            });
        }
        Ok(())
    }
}

/// What is known of a joint's limits beyond its URDF; `None` leaves the URDF's.
///
/// URDF before 1.2 has no acceleration and no jerk, and none can write infinity.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct LimitOverride {
    /// Lowest and highest position \[rad or m\].
    pub position: Option<(f64, f64)>,
    /// Largest speed \[rad/s or m/s\].
    pub velocity: Option<f64>,
    /// Largest acceleration \[rad/s² or m/s²\].
    pub acceleration: Option<f64>,
    /// Largest jerk \[rad/s³ or m/s³\].
    pub jerk: Option<f64>,
    /// Largest torque or force \[Nm or N\].
    pub effort: Option<f64>,
}
