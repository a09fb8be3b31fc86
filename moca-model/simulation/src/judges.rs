//! Judges of a robot that share no code with its controller. They check limits of joints, torques and the desired pose,
//! and distances from the true people.
//!
//! ```
//! use moca_model::{ControllerSettings, DesiredMotion, MOCA_HOME, moca};
//! use moca_simulation::judges::LimitMonitor;
//!
//! let monitor = LimitMonitor::new(&moca()?, &ControllerSettings::default(), &MOCA_HOME);
//! assert_eq!(monitor.margins().worst(), 1.0);
//! # Ok::<(), moca_model::Error>(())
//! ```

mod calmness;
mod limits;
mod separation;
mod witness;

pub(crate) use calmness::StillnessMonitor;
pub use calmness::{Calmness, CalmnessMonitor, Following, Motion, Stillness};
pub(crate) use limits::is_unseen;
pub use limits::{Breaches, LimitMonitor, Margins, Return, TorqueMonitor};
pub(crate) use separation::body;
pub use separation::{Blame, Moment, Rod, Rods, SeparationMonitor, Terms, Verdict};
pub(crate) use witness::Witness;
