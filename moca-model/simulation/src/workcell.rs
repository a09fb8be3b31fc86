//! A robot and people who are led, one control period after the other: the loop of a program that somebody steers.
//!
//! A [`Setup`] says with what robot, controller and person; a [`Workcell`] goes on by a period at a time, in simulated
//! or in real time. Between two periods people are [led](Workcell::lead), faults are switched on and off, and the goal
//! changes. Judges watch every period by where people truly are.
//!
//! ```
//! use ergo_map::{ErgonomicsMap, MapOptions, Person};
//! use moca_simulation::people::{Activity, Lead, Way};
//! use moca_simulation::workcell::{Setup, Who, Workcell};
//! use nalgebra::Point2;
//! use vision_models::Tool;
//!
//! let coarse = MapOptions { spacing: 0.1, ..MapOptions::default() };
//! let map = ErgonomicsMap::build(&Person::average(), &coarse, None)?;
//! let mut cell = Workcell::new(Setup::new(map)?)?;
//! let way = Way::To(Point2::new(1.4, 0.0));
//! cell.lead(Who::Worker, Lead { way, activity: Activity::Use(Tool::Drill), ..Lead::default() })?;
//! (0..500).try_for_each(|_| cell.advance())?;
//! assert_eq!(cell.counts().ticks, 500);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod cell;
mod eye;
mod faults;
mod guided;
mod judge;
mod memory;
mod setup;

pub use cell::{Who, Workcell};
pub use faults::Faults;
pub use judge::Counts;
pub use memory::{Memory, Remembered};
pub use setup::Setup;
