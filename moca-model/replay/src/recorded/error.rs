//! Errors of a recorded run.

/// Reason why a run cannot be recorded or shown.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReplayError {
    /// The robot's description has no shapes to draw.
    #[error("the robot's description cannot be read for its shapes: {0}")]
    Urdf(#[from] urdf_rs::UrdfError),
    /// The description has a link that the model does not have.
    #[error(transparent)]
    Robot(#[from] moca_model::whole_body::Error),
    /// A frame was added after the first sample.
    #[error("frame {name:?} comes too late: add all frames before the first sample")]
    LateFrame {
        /// Name of the frame.
        name: String,
    },
    /// The frame belongs to another recorder.
    #[error("there is no frame {slot}: the recorder has {count} that can be placed")]
    UnknownFrame {
        /// Index of the given frame.
        slot: usize,
        /// Number of frames.
        count: usize,
    },
    /// There is nothing to draw.
    #[error("nothing to show: give at least one run, each with at least one sample")]
    Nothing,
    /// The data cannot be written as JSON.
    #[error("cannot write the data of the page: {0}")]
    Json(#[from] serde_json::Error),
    /// A run cannot be written in MCAP.
    #[cfg(feature = "mcap")]
    #[error(transparent)]
    Mcap(#[from] percept_recording::mcap::McapError),
}
