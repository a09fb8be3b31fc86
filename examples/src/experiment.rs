//! The paper's Experiments 3, 4 and 5 with simulated people, each with ergonomics and without: what the
//! program `experiment` plays.
//!
//! An experiment is a list of independent cases. Everything random in a case comes from the seed and
//! the number of the case, so that any part of the list may be played anywhere, in any order.

mod cases;
mod chart;
mod distance;
pub mod following;
mod job;
mod options;
mod player;
mod recorded;
pub mod reorientation;
mod shown;
mod sight;
mod source;
mod spread;
pub mod subjects;
mod versus;
mod walk;

pub use cases::generator;
pub use distance::{DistanceError, DistanceMonitor, FollowingDistance};
pub use job::{Experiment, Job, merge};
pub use options::{Common, Conditions, make_folder};
pub use player::{Player, ShownRun};
pub use recorded::{Needs, Recorded, UnfitRecording};
pub use sight::Sight;
pub use source::Source;
pub use spread::{Duel, Spread};
pub use versus::{Versus, VersusLine};
pub use walk::Walk;
