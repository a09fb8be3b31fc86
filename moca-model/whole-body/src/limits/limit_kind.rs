//! The limit that sets an end of a joint's velocity interval.

use ahqp_core::VelocityInterval;

/// A limit of one joint.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum LimitKind {
    /// The position limit, with room to brake in front of it.
    Position,
    /// The velocity limit.
    Velocity,
    /// The acceleration limit.
    Acceleration,
    /// The jerk limit.
    Jerk,
    /// A limit of the caller's beside those of the robot.
    Caller,
}

/// One end of an interval.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum End {
    /// The lower end.
    Lower,
    /// The upper end.
    Upper,
}

impl End {
    pub(crate) fn of(self, interval: &VelocityInterval) -> f64 {
        match self {
            Self::Lower => interval.lower,
            Self::Upper => interval.upper,
        }
    }
}
