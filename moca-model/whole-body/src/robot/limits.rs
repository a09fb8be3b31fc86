//! Limits of a joint.

use crate::error::Error;

/// Limits of one degree of freedom, in radians for rotation and metres for translation. Infinity means no limit.
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
    /// Largest torque or force \[Nm or N\]; [`UNKNOWN_EFFORT`](Self::UNKNOWN_EFFORT) if it is not known.
    pub effort: f64,
}

impl JointLimits {
    /// The effort limit of a joint whose URDF states 0 or none. Features that use torques require a known limit.
    pub const UNKNOWN_EFFORT: f64 = 0.0;

    /// Limits of a joint without any: all infinite.
    pub const UNLIMITED: Self = Self {
        lower: f64::NEG_INFINITY,
        upper: f64::INFINITY,
        velocity: f64::INFINITY,
        acceleration: f64::INFINITY,
        jerk: f64::INFINITY,
        effort: f64::INFINITY,
    };

    /// The time constant T with which any acceleration a can fade at the jerk limit, ȧ = −a/T \[s\]. It applies while v
    /// and v + T a are within the velocity limit. Then |a| is at most its limit, and at most twice the velocity limit
    /// over T. Zero without a jerk limit.
    pub(crate) fn fading_time(&self) -> f64 {
        let time = (self.acceleration / self.jerk).min((2.0 * self.velocity / self.jerk).sqrt());
        if self.jerk.is_finite() && time.is_finite() { time } else { 0.0 }
    }

    /// Returns an error unless the range is not empty, velocity, acceleration and jerk are positive, and the effort is
    /// not negative.
    pub(crate) fn validate(&self, joint: &str, line: Option<usize>) -> Result<(), Error> {
        if self.lower.is_nan() || self.upper.is_nan() || self.lower >= self.upper {
            return Err(empty_range(joint.to_owned(), line, self.lower, self.upper));
        }
        let positive = [
            ("velocity", self.velocity),
            ("acceleration", self.acceleration),
            ("jerk", self.jerk),
            ("effort", if self.effort == Self::UNKNOWN_EFFORT { 1.0 } else { self.effort }),
        ];
        match positive.into_iter().find(|(_, value)| value.is_nan() || *value <= 0.0) {
            None => Ok(()),
            Some((limit, value)) => Err(not_positive(joint.to_owned(), line, limit, value)),
        }
    }
}

/// Returns the error for a range of positions in which nothing lies.
pub(super) fn empty_range(joint: String, line: Option<usize>, lower: f64, upper: f64) -> Error {
    let wanted =
        format!("above the lower limit {lower} (a joint that does not move is fixed or held)");
    Error::Limit { line, joint, what: "upper", got: upper, wanted: wanted.into() }
}

/// Returns the error for a limit that is not positive.
pub(super) fn not_positive(
    joint: String,
    line: Option<usize>,
    what: &'static str,
    got: f64,
) -> Error {
    Error::Limit { line, joint, what, got, wanted: "positive".into() }
}

/// Limits of a joint beyond its URDF; `None` keeps the URDF's.
///
/// Most URDFs state no acceleration and no jerk, and few readers take an infinity.
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

impl LimitOverride {
    /// Creates limits of the speed \[rad/s or m/s\] and the acceleration \[rad/s² or m/s²\].
    pub fn of_speed(velocity: f64, acceleration: f64) -> Self {
        let (velocity, acceleration) = (Some(velocity), Some(acceleration));
        Self { velocity, acceleration, ..Self::default() }
    }
}

/// Treatment of limits of a URDF that cannot be meant: an empty range, a speed that is not positive, a negative effort,
/// or no limits at all. An effort of zero or none counts as unknown: see [`JointLimits::UNKNOWN_EFFORT`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum UnusableLimits {
    /// Returns an error that names joint and line.
    #[default]
    Refuse,
    /// Treats the quantity as unlimited, with a [`Warning`](crate::robot::Warning). This suits computations of poses
    /// and forces. A robot that is to move should state its limits.
    Ignore,
}

/// The acceleration limit of a joint that states none.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum MissingAcceleration {
    /// The joint reaches its velocity limit in this time \[s\]. A joint without a velocity limit
    /// stays unlimited.
    TimeToFullSpeed(f64),
    /// No limit.
    Unlimited,
}

impl Default for MissingAcceleration {
    /// The default is a quarter of a second. It gives 8.7 rad/s² for the 2.175 rad/s of a Franka Emika Panda's first
    /// joints, for which the manufacturer allows 7.5 to 15 rad/s².
    fn default() -> Self {
        Self::TimeToFullSpeed(0.25)
    }
}
