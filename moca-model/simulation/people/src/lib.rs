#![doc = include_str!("../README.md")]
//!
//! A simulated person, and the reports of a simulated camera and recogniser. `record` writes them, `follow` plays them,
//! and `soak` moves them into the robot's way.
//!
//! [`Person`] is the body. It goes to goals within the limits of a [`Gait`], turns, steps and moves its hands. Three behaviours move it:
//!
//! - [`LedPerson`] does what somebody outside says.
//! - [`Walker`] acts out the paper's Experiments 3 and 4. It brings the object to the robot, picks a tool up, leads the
//!   robot along a path while it works, and leaves.
//! - [`Wanderer`] walks up to the robot and into it, jumps, goes out of sight and comes back.
//!
//! A person may also repeat the motion of a real one, [`CapturedMotion`].
//!
//! [`Perception`] is the camera, which adds noise and loses joints and frames. Its recogniser is late and sometimes
//! wrong.
//!
//! ```
//! use simulated_people::{Walker, WalkerSettings};
//!
//! let settings = WalkerSettings { duration: 10.0, ..WalkerSettings::default() };
//! let percepts: Vec<_> = Walker::new(settings)?.collect();
//! assert!(percepts.iter().any(|percept| percept.action.is_some_and(|seen| seen.action.is_collaborative())));
//! # Ok::<(), simulated_people::Error>(())
//! ```

mod activity;
mod arm;
mod built_in;
mod camera;
mod captured;
mod error;
mod generator;
mod joints;
mod led;
mod motion;
mod movement;
mod path;
mod perception;
mod person;
mod recogniser;
mod script;
mod settings;
mod skeleton;
mod transport;
mod walker;
mod wanderer;

pub use activity::Activity;
pub use arm::Arm;
pub use camera::CameraSettings;
pub use captured::CapturedMotion;
pub use error::{Error, in_range};
pub use generator::generator;
pub use joints::Joints;
pub use led::{Facing, Lead, LedPerson, Reach, Way, Workplace};
pub use motion::Gait;
pub use movement::Movement;
pub use path::WalkingPath;
pub use perception::{FRAME_RATE, Perception};
pub use person::Person;
pub use settings::{Occupation, WalkerSettings};
pub use transport::Transport;
pub use walker::{Truth, Walker};
pub use wanderer::Wanderer;
// Crates of the types in the public interface.
pub use {rand_chacha, vision_models};
