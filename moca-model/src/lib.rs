//! The mobile manipulator MOCA: its model, stack of tasks and controller.
//!
//! ```
//! use moca_model::{MOCA_HOME, RobotData, RobotModel, forward_kinematics, gravity, jacobian};
//!
//! let model = RobotModel::moca()?;
//! let mut data = RobotData::new(&model);
//! forward_kinematics(&model, &mut data, &MOCA_HOME)?;
//! jacobian(&model, &mut data)?;
//! gravity(&model, &mut data)?;
//!
//! assert_eq!(data.jacobian().shape(), (6, 10));
//! assert!((data.gravity()[6] - 22.0).abs() < 0.5); // Nm on the elbow
//! # Ok::<(), moca_model::Error>(())
//! ```

mod command;
mod controller;
mod error;
mod impedance;
mod intention;
mod leash;
mod motion_limits;
mod robot;
mod safety;
mod settings;
mod shared_space;
mod simulation;
mod stack;

pub use command::{Command, Outcome};
pub use controller::Controller;
pub use error::Error;
pub use impedance::{ImpedanceSettings, JointImpedance, JointState};
pub use intention::{Intention, IntentionFilter, IntentionSettings};
pub use leash::LeashSettings;
pub use motion_limits::MecanumBase;
pub use robot::{
    CartesianLimits, Joint, JointKind, JointLimits, LimitOverride, LinkId, MOCA_AXIS_SPEED,
    MOCA_BASE_JOINTS, MOCA_HOME, MOCA_JOINTS, MOCA_URDF, MOCA_WHEEL_LEVER, MOCA_WHEEL_SPEED,
    PANDA_CARTESIAN_LIMITS, RobotData, RobotDescription, RobotModel, forward_kinematics, gravity,
    jacobian, potential_energy, world_from_link,
};
pub use safety::{
    LinkCapsule, PersonBodySettings, Safety, SafetyInput, SafetyRows, SafetySettings,
};
pub use settings::{ControllerSettings, DesiredMotion, Goal, SpaceSettings, StaleSettings};
pub use shared_space::SharedSpace;
pub use simulation::SimulatedRobot;
pub use stack::{GoalTerms, PostureTask, StackInput, StackSettings, TaskStack};
