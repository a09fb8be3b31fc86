//! The robot: its model, its state-dependent quantities, and the algorithms
//! over both.

mod assembly;
mod data;
mod description;
mod dynamics;
mod kinematics;
mod limits;
mod moca;
mod model;
mod urdf;

pub use data::RobotData;
pub use description::RobotDescription;
pub use dynamics::{gravity, potential_energy};
pub use kinematics::{forward_kinematics, jacobian, world_from_link};
pub use limits::{JointLimits, LimitOverride};
pub use moca::{
    CartesianLimits, MOCA_AXIS_SPEED, MOCA_BASE_JOINTS, MOCA_HOME, MOCA_JOINTS, MOCA_URDF,
    MOCA_WHEEL_LEVER, MOCA_WHEEL_SPEED, PANDA_CARTESIAN_LIMITS,
};
pub use model::{Joint, JointKind, LinkId, RobotModel};
