//! The mobile manipulator MOCA: its model, stack of tasks and controller.
//!
//! The robot is a [`Model`](whole_body::Model) of the crate [`whole_body`], which has its kinematics
//! and dynamics; here is what is MOCA's and what collaboration with a person needs.
//!
//! ```
//! use moca_model::whole_body::Data;
//! use moca_model::{MOCA_HOME, moca};
//!
//! let model = moca()?;
//! let mut data = Data::new(&model);
//! let mut gravity = [0.0; 10];
//! data.pose(&model, &MOCA_HOME)?.gravity_into(&mut gravity)?;
//! assert!((gravity[6] - 22.0).abs() < 0.5); // Nm on the elbow
//! # Ok::<(), moca_model::Error>(())
//! ```

mod command;
mod controller;
mod dynamic_robot;
mod error;
mod held_object;
mod intention;
mod interaction;
mod leash;
mod loop_controller;
mod motion_limits;
mod robot;
mod safety;
#[cfg(feature = "serde")]
mod serial;
mod settings;
mod shared_space;
mod simulation;
mod stack;
mod torque;

pub use command::{Command, Outcome};
pub use controller::Controller;
pub use dynamic_robot::{DynamicRobot, DynamicRobotSettings};
pub use error::Error;
pub use held_object::{BoxSide, HandSettings, HeldObject, WorkFace};
pub use intention::{Intention, IntentionFilter, IntentionSettings};
pub use interaction::{Phase, Reason, Transition};
pub use leash::LeashSettings;
pub use loop_controller::LoopController;
pub use motion_limits::MecanumBase;
pub use robot::bodies::LinkCapsule;
pub use robot::kinematics::Kinematics;
pub use robot::moca::{
    CartesianLimits, MOCA_ARM_MOUNT, MOCA_AXIS_SPEED, MOCA_BASE_JOINTS, MOCA_HOME, MOCA_JOINTS,
    MOCA_TOOL, MOCA_URDF, MOCA_WHEEL_LEVER, MOCA_WHEEL_SPEED, PANDA_CARTESIAN_LIMITS, moca,
    moca_description,
};
pub use safety::{PersonBodySettings, Safety, SafetyInput, SafetyRows, SafetySettings};
pub use settings::{ControllerSettings, DesiredMotion, Goal, SpaceSettings, StaleSettings};
pub use shared_space::SharedSpace;
pub use simulation::SimulatedRobot;
pub use stack::{CollaborationStack, GoalTerms, PostureSettings, StackInput, StackSettings};
pub use torque::{Measured, TorqueController, TorqueLoopSettings};
pub use whole_body;
pub use whole_body::{ImpedanceSettings, JointImpedance, JointState};

/// The examples of the book's page on this crate.
#[cfg(doctest)]
#[doc = include_str!("../../docs/src/moca-model.md")]
struct BookPage;
