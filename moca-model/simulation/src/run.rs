//! A run: a person's percepts, a controller at 1 kHz and the simulated robot, closed in a loop and judged.
//!
//! A [`Scenario`] describes the person and the robot, and a [`Run`] plays it. A [`Summary`] has the results, and a
//! [`Comparison`] sets two of them side by side.
//!
//! ```
//! use std::ops::ControlFlow;
//!
//! use ergo_map::{ErgonomicsMap, MapOptions, Person};
//! use moca_model::Goal;
//! use moca_simulation::people::{Walker, WalkerSettings};
//! use moca_simulation::run::{Run, Scenario};
//!
//! let person = Person::average();
//! let coarse = MapOptions { spacing: 0.1, ..MapOptions::default() };
//! let map = ErgonomicsMap::build(&person, &coarse, None)?;
//! let settings = WalkerSettings { duration: 0.5, ..WalkerSettings::default() };
//! let scenario = Scenario::new(Walker::new(settings)?.collect(), &person, map)?.kinematic();
//! let summary = Run::new(&scenario, Goal::Ergonomics)?.play(|_, _| ControlFlow::Continue(()))?;
//! assert!(summary.is_complete && summary.limit_violations == 0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod comparison;
mod encounter;
mod on_board;
mod play;
mod scenario;
mod scoring;
mod seen;
mod summary;
mod tally;
mod tick_row;
mod true_person;
mod work;
mod working_hand;

pub use comparison::Comparison;
pub use encounter::Encounter;
pub(crate) use on_board::OnBoardEye;
pub use on_board::RobotView;
pub use play::Run;
pub use scenario::{Delivery, Scenario};
pub use scoring::{HandScore, Scorer};
pub use summary::{MeasuredReba, Summary};
pub(crate) use tick_row::tick_row;
pub use true_person::TrueMotion;
pub(crate) use work::WorkForce;
