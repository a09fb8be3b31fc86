//! Warnings about a URDF that is usable nevertheless.

use std::fmt;

/// A warning about a URDF; see [`Model::warnings`](crate::Model::warnings).
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Warning {
    /// No rigid body has this inertia.
    NotAnInertia {
        /// The link.
        link: String,
        /// Line on which its `<inertial>` begins.
        line: usize,
        /// Reason why not.
        fault: InertiaFault,
    },
    /// A joint moves no inertia, so that forward dynamics are not defined.
    NothingToMove {
        /// The joint.
        joint: String,
    },
    /// A limit that cannot be meant counts as unlimited
    /// ([`UnusableLimits::Ignore`](crate::robot::UnusableLimits::Ignore)).
    LimitIgnored {
        /// The joint.
        joint: String,
        /// Line on which it begins.
        line: usize,
        /// Name of the limit.
        limit: &'static str,
    },
    /// A limit of a mimic joint is narrower than that of the joint that it follows, and in force.
    FollowerLimit {
        /// The mimic joint.
        joint: String,
        /// The joint that it follows, which takes over the limit.
        follows: String,
        /// Name of the limit.
        limit: &'static str,
    },
    /// The range of a mimic joint excludes the whole range of the joint that it follows, and is not kept.
    FollowerRange {
        /// The mimic joint.
        joint: String,
        /// The joint that it follows.
        follows: String,
        /// Line on which it begins.
        line: usize,
    },
}

/// Reason why no rigid body has an inertia.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum InertiaFault {
    /// A principal moment is negative \[kg m²\].
    NegativeMoment(f64),
    /// One principal moment is larger than the sum of the others \[kg m²\].
    Triangle([f64; 3]),
    /// Moments without a mass.
    NoMass,
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotAnInertia { link, line, fault } => {
                write!(f, "line {line}: the inertia of link `{link}` is that of no body: ")?;
                match fault {
                    InertiaFault::NegativeMoment(moment) => {
                        write!(f, "a principal moment is {moment:e} kg m²")
                    }
                    InertiaFault::Triangle([a, b, c]) => write!(
                        f,
                        "of its principal moments {a:e}, {b:e}, {c:e} kg m² one is larger than the \
                         others together"
                    ),
                    InertiaFault::NoMass => write!(f, "it has moments and no mass"),
                }
            }
            Self::NothingToMove { joint } => write!(
                f,
                "what joint `{joint}` moves has no inertia, so that forces have no definite effect"
            ),
            Self::FollowerLimit { joint, follows, limit } => write!(
                f,
                "the {limit} of joint `{follows}` is limited by joint `{joint}`, which follows it"
            ),
            Self::FollowerRange { joint, follows, line } => write!(
                f,
                "line {line}: the range of joint `{joint}` leaves joint `{follows}`, which it follows, no \
                 position of its own range, and is not kept"
            ),
            Self::LimitIgnored { joint, line, limit } => {
                write!(
                    f,
                    "line {line}: joint `{joint}` has no usable {limit} and counts as unlimited"
                )
            }
        }
    }
}
