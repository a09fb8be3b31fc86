//! The closed loop under everything that can go wrong. Random people walk, jump, vanish and come back. Workspaces move,
//! turn and change their shape. Joints start outside their limits. Percepts are late, noisy and incomplete. Cameras,
//! clocks and measurements fail.
//!
//! A soak is a row of episodes, each with a new robot, person and controller. [`Monitor`] checks all promises in every
//! tick. It uses the commands, the robot's configuration and the true person, with formulas of its own.
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
mod episode_result;
mod monitor;
mod movements;
mod run;
mod summary;
mod task;
mod tick_times;
mod witnessed;

pub use disturbance::{Disturbance, Endings, StateCounts};
pub use episode_result::EpisodeResult;
pub use monitor::{Counts, Monitor, Tick};
pub use movements::{MovementResult, MovementResults, Movements};
pub use run::{EpisodePlan, Soak};
pub use summary::Summary;
pub use tick_times::TickTimes;
