//! Which chain of a URDF is the robot.

use nalgebra::{Isometry3, Vector3};

use super::limits::LimitOverride;

/// Which chain of a URDF is the robot, and what a URDF cannot say about it.
///
/// ```
/// use moca_model::RobotDescription;
///
/// let arm = RobotDescription {
///     root: Some("panda_link0".into()),
///     held: vec![("panda_finger_joint1".into(), 0.02)],
///     ..RobotDescription::new("panda_tcp")
/// };
/// assert!(arm.joints.is_empty()); // take every movable joint from root to tool
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct RobotDescription {
    /// The link whose frame is the world; `None` takes the URDF's root link.
    pub root: Option<String>,
    /// The link whose frame is the tool, the robot's end effector.
    pub tool: String,
    /// The joints that make q, from root to tool. Listing them makes sure that
    /// q is what the caller thinks it is; empty takes every movable joint on
    /// the way that is not held.
    pub joints: Vec<String>,
    /// Movable joints that stay at a position \[rad or m\]: fingers, a lift.
    /// A movable joint off the way to the tool that is not named here stays at
    /// zero. `mimic` is not followed.
    pub held: Vec<(String, f64)>,
    /// Joint origins (parent link to joint) that replace the URDF's: where an
    /// arm is mounted, how long a tool is.
    pub origins: Vec<(String, Isometry3<f64>)>,
    /// Limits that replace or complete the URDF's.
    pub limits: Vec<(String, LimitOverride)>,
    /// Acceleration of free fall in the world frame \[m/s²\].
    pub gravity: Vector3<f64>,
}

impl RobotDescription {
    /// The chain from the URDF's root link to `tool`, as the URDF has it, with
    /// gravity 9.81 m/s² downwards.
    pub fn new(tool: impl Into<String>) -> Self {
        Self {
            root: None,
            tool: tool.into(),
            joints: Vec::new(),
            held: Vec::new(),
            origins: Vec::new(),
            limits: Vec::new(),
            gravity: Vector3::new(0.0, 0.0, -9.81),
        }
    }
}
