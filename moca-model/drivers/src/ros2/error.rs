//! What can go wrong with a connection to ROS 2.

use super::topic::Topic;

/// Why there is no connection to ROS 2, or none any more. What is wrong with single messages is a
/// [`Refusal`](super::Refusal).
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Ros2Error {
    /// `ROS_DOMAIN_ID` is no domain.
    #[error("ROS_DOMAIN_ID is {value:?}: give a number from 0 to 232")]
    Domain {
        /// What it is.
        value: String,
    },
    /// Something cannot be made.
    #[error("ROS 2 cannot make {what}: {reason}")]
    Create {
        /// What it is.
        what: String,
        /// What the library or the system says.
        reason: String,
    },
    /// A topic cannot be read any more.
    #[error("ROS 2 cannot read {}: {reason}", topic.name())]
    Read {
        /// The topic.
        topic: Topic,
        /// What the library says.
        reason: String,
    },
    /// A thread that speaks ROS 2 has ended while the loop ran.
    #[error("the thread that {does} ROS 2 messages has ended")]
    Ended {
        /// What it did.
        does: &'static str,
    },
    /// The simulated robot refuses a command.
    #[error(transparent)]
    Simulation(#[from] moca_model::Error),
}

impl Ros2Error {
    pub(super) fn create(what: impl Into<String>, reason: &impl ToString) -> Self {
        Self::Create { what: what.into(), reason: reason.to_string() }
    }
}
