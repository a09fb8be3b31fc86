//! Rapid Entire Body Assessment: the integer score, and two continuous scores from the same core.

mod conditions;
mod continuous;
mod curve;
mod mode;
mod score;
mod smooth;
mod table;
mod tables;
mod worksheet;

pub use conditions::{Conditions, Coupling, LegSupport};
pub use continuous::{ContinuousReba, Contributions, ergonomics_score, ergonomics_score_gradient};
pub use mode::Mode;
pub use score::{ActionLevel, Reba, RebaSubScores};
pub use worksheet::Worksheet;
