//! The model of a robot, which does not change while the robot moves.

mod additions;
mod assembly;
pub(crate) mod bodies;
mod checks;
pub(crate) mod configuration;
pub(crate) mod description;
mod followers;
pub(crate) mod frame;
pub(crate) mod friction;
mod inertia;
pub(crate) mod joint;
mod limit_rules;
mod limit_sources;
pub(crate) mod limits;
pub(crate) mod model;
mod reading;
mod selection;
mod units;
pub(crate) mod warning;

pub use crate::error::urdf::UrdfError;
pub use description::AddedFrame;
pub use friction::JointFriction;
pub use joint::{Joint, JointKind, MimicJoint};
pub use limits::{JointLimits, LimitOverride, MissingAcceleration, UnusableLimits};
pub use warning::{InertiaFault, Warning};
