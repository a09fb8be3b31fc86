//! The mobile manipulator MOCA: model, stack of tasks and controller.
//!
//! The crate [`whole_body`] has the robot's [`Model`](whole_body::Model), kinematics and dynamics. This crate adds the
//! data of MOCA and the collaboration with a person.
//!
//! A [`Controller`] takes percepts 20 times a second and the measured configuration a thousand times a second. It
//! returns [`Command`]s:
//!
//! ```
//! use ergo_map::{ErgonomicsMap, FitOptions, MapOptions, Person};
//! use moca_model::nalgebra::Point3;
//! use moca_model::{Controller, ControllerSettings, MOCA_HOME, SimulatedRobot, SpaceSettings, moca};
//! use vision_models::{Action, Body, Body25, Confidence, Keypoint, Percept, RecognisedAction, Tool};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! // Once for each person.
//! let person = Person::new(1.75)?;
//! let map = ErgonomicsMap::build(&person, &MapOptions { spacing: 0.08, ..MapOptions::default() }, None)?;
//! let (ergonomics, _report) = map.fit(&FitOptions::default())?;
//! let space = SpaceSettings::default().for_person(&person, map.side());
//! let settings = ControllerSettings { space, ..ControllerSettings::default() };
//! let mut controller = Controller::new(moca()?, ergonomics, settings, &MOCA_HOME)?;
//! let mut robot = SimulatedRobot::new(&moca()?, &MOCA_HOME)?;
//!
//! // A person who stands 1.7 m ahead, faces the robot and drills.
//! let confidence = Confidence::new(0.9)?;
//! let mut body = Body::default();
//! for (joint, y, z) in [
//!     (Body25::LeftShoulder, -0.2, 1.4),
//!     (Body25::RightShoulder, 0.2, 1.4),
//!     (Body25::MidHip, 0.0, 0.9),
//! ] {
//!     body.set(joint, Some(Keypoint { position: Point3::new(1.7, y, z), confidence }));
//! }
//! let action = Some(RecognisedAction { action: Action::Using(Tool::Drill), confidence });
//! for tick in 1..=2000 {
//!     let time = 1e-3 * f64::from(tick);
//!     if tick % 50 == 0 {
//!         let body = Some(body.clone());
//!         controller.observe(&Percept { time, body, action, surface: None })?;
//!     }
//!     let command = controller.step(time, robot.position())?;
//!     assert!(command.outcome.is_optimal());
//!     robot.step(&command.joint_velocity, 1e-3)?; // MOCA takes base_twist and joint_position[3..]
//! }
//! # Ok(())
//! # }
//! ```
//!
//! - **Your robot** is any [`Model`](whole_body::Model) without a floating base, with
//!   [`ControllerSettings::of_robot`]`(&model, tool, &start)`. Add a [`hrsw_safety::LinkCapsule`] for each body to
//!   `settings.safety.bodies`. A robot without capsules keeps no distance from people.
//! - **Your task** needs a change of this crate: a level in `src/stack.rs`. The book in the repository,
//!   `docs/src/contributing.md`, has the steps. A stack of your own is an [`Ik`](whole_body::Ik).
//! - **What holds:** limits of the arm's joints, and protective distances to people whom the camera shows. Obstacles and
//!   people outside its view are not covered. `docs/src/guarantees.md` in the repository has all conditions.
//!
//! This is not safety-rated software.

mod box_side;
mod command;
mod controller;
mod dynamic_robot;
mod error;
mod following_error;
mod grasped_object;
mod gripping;
mod intention;
mod interaction;
mod loop_controller;
mod motion_limits;
mod robot;
mod scene;
#[cfg(feature = "serde")]
mod serial;
mod settings;
mod shared_space;
mod simulation;
mod situation;
mod stack;
mod torque;

pub use box_side::BoxSide;
pub use command::{BaseMotion, Command, DriveReason, Outcome};
pub use controller::Controller;
pub use dynamic_robot::{DynamicRobot, DynamicRobotSettings};
pub use error::Error;
pub use grasped_object::{GraspedObject, HandSettings, WorkFace};
pub use gripping::GripTime;
pub use intention::IntentionFilter;
pub use interaction::{Phase, Reason, Transition};
pub use loop_controller::{Acknowledgement, LoopController};
pub use nalgebra;
pub use robot::kinematics::Kinematics;
pub use robot::moca::{
    MOCA_ARM_MOUNT, MOCA_AXIS_SPEED, MOCA_BASE_JOINTS, MOCA_HOME, MOCA_JOINTS, MOCA_TOOL,
    MOCA_URDF, MOCA_WHEEL_LEVER, MOCA_WHEEL_SPEED, moca, moca_description,
};
pub use robot::moca_safety::moca_safety;
pub use robot::self_collision::SelfCollisionLimit;
pub use scene::Scene;
pub use settings::{
    ControllerSettings, DesiredMotion, Goal, Levels, MecanumBase, PostureSettings, SpaceSettings,
};
pub use shared_space::SharedSpace;
pub use simulation::SimulatedRobot;
pub use situation::Situation;
pub use stack::CollaborationStack;
pub use torque::{AnswerDelay, TorqueController, TorqueLoopSettings};
pub use vision_models::Intention;
pub use whole_body;
pub use whole_body::torque::{FollowingErrorSettings, ImpedanceSettings};

/// The program of the crate's README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
