//! Errors of a connection to ROS 2.

/// Reason why a connection to ROS 2 cannot be made or has ended. A [`Refusal`](super::Refusal) says what is wrong with a
/// single message.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Ros2Error {
    /// `ROS_DOMAIN_ID` is no valid domain.
    #[error("ROS_DOMAIN_ID is {value:?}: give a number from 0 to 232")]
    Domain {
        /// Value of the variable.
        value: String,
    },
    /// An entity of the connection cannot be created.
    #[error("ROS 2 cannot make {what}: {reason}")]
    Create {
        /// Name of the entity.
        what: String,
        /// Reason that the library or the operating system gives.
        reason: String,
    },
    /// Reading from a topic failed.
    #[error("ROS 2 cannot read {topic}: {reason}")]
    Read {
        /// Name of the topic.
        topic: String,
        /// Reason that the library gives.
        reason: String,
    },
    /// A message was not taken for publication.
    #[error("ROS 2 does not publish: {reason}")]
    Publish {
        /// Reason that the library gives.
        reason: String,
    },
    /// A thread of the connection ended while the loop ran.
    #[error("the thread that {does} ROS 2 messages has ended")]
    Ended {
        /// Task of the thread.
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
