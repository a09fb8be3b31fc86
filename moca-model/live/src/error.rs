//! Errors of a live workcell.

use std::io;

use moca_replay::recorded::ReplayError;

/// Reason why something is not done, or cannot be shown.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The port cannot be listened on.
    #[error("cannot listen on {address}: {source}")]
    Listen {
        /// Address of the port.
        address: String,
        /// Error of the system.
        source: io::Error,
    },
    /// A message that says nothing that can be done.
    #[error("this is no request: {reason}")]
    Request {
        /// Fault of the message.
        reason: String,
    },
    /// A word that is none of those that are known.
    #[error("{what} \"{got}\": give {wanted}")]
    Word {
        /// Purpose of the word.
        what: &'static str,
        /// Value given.
        got: String,
        /// Values that would be right.
        wanted: String,
    },
    /// A message from a page that only watches.
    #[error("another page steers; this one watches until that one leaves")]
    Watching,
    /// The loop takes no more orders.
    #[error("the loop is busy, or has ended: nothing was done")]
    Busy,
    /// Settings that cannot be used.
    #[error("settings: {0}")]
    Settings(String),
    /// The simulation refuses something.
    #[error(transparent)]
    Simulation(Box<moca_simulation::Error>),
    /// The page cannot be made.
    #[error(transparent)]
    Replay(#[from] ReplayError),
    /// Data that JSON does not hold.
    #[error(transparent)]
    Json(#[from] serde_json::Error),
}

impl From<moca_simulation::Error> for Error {
    fn from(error: moca_simulation::Error) -> Self {
        Self::Simulation(Box::new(error))
    }
}

impl From<moca_simulation::people::Error> for Error {
    fn from(error: moca_simulation::people::Error) -> Self {
        moca_simulation::Error::from(error).into()
    }
}
