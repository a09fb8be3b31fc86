//! The paper's Experiments 3, 4 and 5 with simulated people, each with and without ergonomics.
//!
//! An [`Experiment`] is a list of independent cases. All random numbers of a case come from the seed and its number. So
//! any part of the list can be run anywhere and in any order.
//!
//! ```
//! use moca_simulation::experiment::following;
//!
//! let cases = following::cases(1, 3, 35.0);
//! assert_eq!(cases[..2].len(), following::cases(1, 2, 35.0).len());
//! assert!(cases.iter().all(|case| (1.58..=1.94).contains(&case.person.stature())));
//! ```

mod cases;
mod chart;
mod conditions;
mod distance;
pub mod following;
mod job;
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

pub use cases::{generator, play_all};
pub use conditions::Conditions;
pub use distance::{DistanceError, DistanceMonitor, FollowingDistance};
pub use job::{Experiment, Job};
pub use player::{Player, ShownRun};
pub use recorded::{Needs, Recorded};
pub use shown::Shown;
pub use sight::Sight;
pub use source::Source;
pub use spread::{Duel, Spread};
pub use versus::{Versus, VersusLine};
pub use walk::Walk;
