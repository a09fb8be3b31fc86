//! Separation of a robot from people: their bodies from camera frames, distances and protective
//! distances, contact limits, and a supervisor that collects all faults.
//!
//! Speed and separation monitoring follows ISO/TS 15066, and contact limits follow ISO 10218-2.
//! **This is not safety-rated software.**
//!
//! [`Safety`] keeps the distances of any robot whose bodies are capsules. In this example a
//! carriage on a rail carries a lift, and a person stands ahead:
//!
//! ```
//! use ahqp_core::AugmentedState;
//! use hrsw_safety::nalgebra::{Matrix6xX, Point3, Vector3};
//! use hrsw_safety::{
//!     Age, Capsule, JointMotion, LinkCapsule, RobotBody, Safety, SafetyInput, SafetySettings, SafetyState,
//! };
//! use vision_models::{Body, Body25, Confidence, Keypoint, Percept};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let state = AugmentedState { joints: 2, task: 6, slack: 6 };
//! let carriage = Capsule::sphere(Vector3::new(0.0, 0.0, 0.2), 0.2)?;
//! let lift = Capsule::new(Vector3::new(0.0, 0.0, 0.4), Vector3::new(0.0, 0.0, 1.0), 0.1)?;
//! let bodies = [("lift", lift), ("carriage", carriage)]
//!     .map(|(link, capsule)| LinkCapsule { link: link.to_owned(), capsule });
//! let settings = SafetySettings { bodies: bodies.to_vec(), ..SafetySettings::default() };
//! let (accelerations, speed, period) = ([2.0, 2.0], 1.0, 1e-3); // m/s², m/s, s
//! let mut safety = Safety::new(state, settings, &accelerations, speed, period)?;
//!
//! // A camera frame: the trunk of somebody 2 m ahead.
//! let confidence = Confidence::new(0.9)?;
//! let mut body = Body::default();
//! for (joint, height) in [(Body25::Neck, 1.45), (Body25::MidHip, 0.95)] {
//!     body.set(joint, Some(Keypoint { position: Point3::new(2.0, 0.0, height), confidence }));
//! }
//! safety.observe(&Percept { time: 0.0, body: Some(body), action: None, surface: None })?;
//!
//! // Each tick: where the robot's two bodies are, and how its joints move them.
//! let bodies = [RobotBody { capsule: lift, joints: 2 }, RobotBody { capsule: carriage, joints: 1 }];
//! let mut jacobian = Matrix6xX::zeros(2);
//! (jacobian[(0, 0)], jacobian[(2, 1)]) = (1.0, 1.0); // along x, and up
//! let motion = JointMotion {
//!     jacobian: &jacobian,
//!     origin: Vector3::zeros(),
//!     velocity: &[0.1, 0.0],
//!     braking: Some(&[0.098, 0.0]), // the velocities of the next tick, if the robot brakes at 2 m/s²
//!     change: None,
//!     inverse_inertia: None,
//! };
//! let age = Age::new(0.05)?;
//! let input = SafetyInput { now: 0.05, elapsed: 1e-3, age, together: false, measures_force: false };
//! safety.measure(&motion, &bodies, &input)?;
//! safety.decide(&bodies, &input);
//! assert!(safety.nearest().is_none_or(|pair| pair.room() > 0.0));
//! assert_eq!(safety.supervisor().state(), SafetyState::Normal);
//! let mut rows = safety.separation().rows(); // made once, for a level of a stack of tasks
//! // Rows of an objective need not admit braking.
//! let motion = JointMotion { braking: None, ..motion };
//! safety.separation().write_rows(&motion, &mut rows)?;
//! assert_eq!(rows.len(), 40); // the most pairs that have a row
//!
//! // Without frames the robot stops.
//! let late = SafetyInput { now: 1.0, age: Age::new(1.0)?, ..input };
//! safety.measure(&motion, &bodies, &late)?;
//! safety.decide(&bodies, &late);
//! assert_eq!(safety.supervisor().state(), SafetyState::ProtectiveStop);
//! # Ok(())
//! # }
//! ```

mod age;
mod approach;
mod body_parts;
mod body_region;
mod clock;
mod contact;
mod distance;
mod distance_bounds;
mod error;
mod fault;
mod following_distance;
mod joint_velocity;
mod link_capsule;
mod measured_velocity;
mod people;
mod person_bodies;
mod safety;
mod safety_state;
mod separation;
mod settings;
mod speed_cap;
mod supervisor;

pub use age::Age;
pub use approach::{ApproachRows, JointMotion, Nearest, PersonBody, RobotBody};
pub use body_region::{BodyRegion, ContactKind, ContactLimits, RegionLimits};
pub use clock::{LoopClock, Tick};
pub use contact::{Contact, ContactLimit};
pub use distance::{Proximity, proximity};
pub use error::Error;
pub use fault::{ClockFault, Fault, FrameFault};
pub use following_distance::FollowingDistance;
pub use hrsw::Capsule;
pub use link_capsule::LinkCapsule;
pub use measured_velocity::MeasuredVelocity;
pub use nalgebra;
pub use people::MOST as MOST_OTHERS;
pub use person_bodies::{FORGET_AFTER, LEAST_CONFIDENCE};
pub use safety::{Safety, SafetyInput};
pub use safety_state::SafetyState;
pub use separation::{BaseBraking, SeparationSettings};
pub use settings::SafetySettings;
pub use speed_cap::SpeedCap;
pub use supervisor::{Cause, Observation, Supervisor, SupervisorSettings};

/// Compiles the program of the crate's README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
