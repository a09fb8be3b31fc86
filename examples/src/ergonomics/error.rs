//! What can go wrong with a map's report and pictures.

/// Why a map cannot be shown.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ErgonomicsError {
    /// The map has no answer, or the person's measures make no person.
    #[error(transparent)]
    Map(#[from] ergo_map::Error),
    /// A threshold of `e_s` that no score can meet.
    #[error("acceptable = {0}: give a score e_s above 0 and up to 4.25")]
    Acceptable(f64),
    /// A picture cannot be drawn.
    #[error("cannot draw the picture: {0}")]
    Picture(String),
    /// The report cannot be written as JSON.
    #[error("cannot write the report: {0}")]
    Report(#[from] serde_json::Error),
}
