//! The closed loop under everything that can go wrong, random people who
//! walk, jump, vanish and come back; workspaces that move, turn and change their shape; starts
//! outside the joint limits; percepts that are late, noisy and incomplete; cameras, clocks and measurements
//! that fail.
//!
//! A soak is a row of episodes, each with a new robot, person and controller. What is promised is
//! checked in every tick by [`Monitor`], from the commands, the robot's configuration and where
//! the person truly is, with formulas of its own.
//!
//! ```
//! use std::ops::ControlFlow;
//!
//! use moca_simulation::soak::Soak;
//!
//! let summary = Soak::new(1, 500)?.run(|_| ControlFlow::Continue(()))?;
//! assert_eq!(summary.counts.infeasible, 0);
//! assert_eq!(summary.ticks, 500);
//! # Ok::<(), moca_simulation::Error>(())
//! ```

mod disturbance;
mod episode;
mod monitor;
mod movements;
mod run;
mod summary;
mod task;
mod tick_times;
mod witnessed;

pub use disturbance::{Disturbance, Endings, StateCounts};
pub use monitor::{Counts, Monitor, Tick};
pub use movements::{MovementResult, MovementResults, Movements};
pub use run::{EpisodePlan, EpisodeResult, Soak};
pub use summary::Summary;
pub use tick_times::TickTimes;
