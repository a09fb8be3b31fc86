//! What can go wrong with a map, its report and its pictures.

/// Why a map cannot be made or shown.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MapError {
    /// A hand position that the map does not hold.
    #[error(
        "the hand at ({x:.3}, {y:.3}, {z:.3}) m is outside the map: give a place that the person \
         reaches, x forward, y left, z up from the floor below the pelvis"
    )]
    OutsideMap {
        /// Forward \[m\].
        x: f64,
        /// Left \[m\].
        y: f64,
        /// Up \[m\].
        z: f64,
    },
    /// A map or a table that holds too little.
    #[error(
        "{what} needs at least {needed} postures and has {found}: give a smaller spacing, or more \
         recorded postures there"
    )]
    TooFewPostures {
        /// What was to be computed.
        what: &'static str,
        /// Smallest workable number.
        needed: usize,
        /// Number there.
        found: usize,
    },
    /// The map has no answer, or the person's measures make no person.
    #[error(transparent)]
    Map(ergo_map::Error),
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

impl From<ergo_map::Error> for MapError {
    fn from(error: ergo_map::Error) -> Self {
        match error {
            ergo_map::Error::OutOfDomain { x, y, z } => Self::OutsideMap { x, y, z },
            ergo_map::Error::TooFewSamples { what, got, wanted } => {
                Self::TooFewPostures { what, needed: wanted, found: got }
            }
            other => Self::Map(other),
        }
    }
}
