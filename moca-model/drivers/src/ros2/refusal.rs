//! Why messages are refused.

use crate::CommandRefusal;

/// Why a message is refused. The newest one before it stays in force, until it is too old.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Refusal {
    /// Somebody else has another type of message on the topic.
    #[error("somebody has the type {found} there, expected {expected}")]
    Type {
        /// Their type.
        found: String,
        /// That of the topic.
        expected: String,
    },
    /// Its bytes are no such message.
    #[error("bytes that are no such message: {reason}")]
    Bytes {
        /// What the decoder says.
        reason: String,
    },
    /// A list has another length than it should.
    #[error("{found} numbers of {what}, expected {expected}")]
    Size {
        /// What the list is of.
        what: &'static str,
        /// Its length.
        found: usize,
        /// What it should be.
        expected: usize,
    },
    /// A joint of the robot is not in it.
    #[error("no joint {joint:?} among {found:?}")]
    MissingJoint {
        /// The joint.
        joint: String,
        /// The joints that are.
        found: Vec<String>,
    },
    /// A joint of the robot is in it more than once.
    #[error("joint {joint:?} more than once")]
    RepeatedJoint {
        /// The joint.
        joint: String,
    },
    /// A number is NaN or infinite.
    #[error("{what}: a number that is not finite")]
    NotFinite {
        /// What the number is of.
        what: &'static str,
    },
    /// A quaternion that is no rotation.
    #[error("an orientation of norm {norm}, expected 1")]
    Orientation {
        /// Its norm.
        norm: f64,
    },
    /// It is in another frame.
    #[error("in the frame {found:?}, expected {expected:?}")]
    Frame {
        /// Its frame.
        found: String,
        /// What it should be.
        expected: &'static str,
    },
    /// Its stamp is zero, which publishers leave that do not stamp.
    #[error("no stamp; give it the time of the system clock")]
    NoStamp,
    /// Its stamp is no time.
    #[error("a stamp with {nanosec} ns, expected less than a second")]
    Stamp {
        /// Its nanoseconds.
        nanosec: u32,
    },
    /// It is too old, or stamped by another clock.
    #[error(
        "stamped {age:.3} s ago, expected at most {oldest} s: late, or by a clock that is behind this machine's"
    )]
    Old {
        /// By this machine's clock \[s\].
        age: f64,
        /// What it may be \[s\].
        oldest: f64,
    },
    /// It is from the future: stamped by another clock.
    #[error(
        "stamped {ahead:.3} s in the future, expected at most {most} s: by a clock that is ahead of this machine's"
    )]
    Future {
        /// By this machine's clock \[s\].
        ahead: f64,
        /// What it may be \[s\].
        most: f64,
    },
    /// A newer one has come before it.
    #[error("stamped no later than the message before")]
    Overtaken,
    /// There is no odometry to go with joint states.
    #[error("no odometry in the last {oldest} s; base and arm are measured together")]
    NoOdometry {
        /// How old it may be \[s\].
        oldest: f64,
    },
    /// A mode that is none.
    #[error("the mode {found:?}, expected one of running, stopped, reflex, user_stop")]
    Mode {
        /// What it is.
        found: String,
    },
    /// A confidence that is none.
    #[error("a confidence of {value}, expected 0 to 1")]
    Confidence {
        /// Its value.
        value: f64,
    },
    /// A command that the robot does not take.
    #[error(transparent)]
    Command(#[from] CommandRefusal),
    /// An action that is none of the thirty.
    #[error("{0}")]
    Action(String),
}
