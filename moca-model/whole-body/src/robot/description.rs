//! The description: which part of a URDF is the robot, and what a URDF cannot say about it.

use nalgebra::{Isometry3, Vector3};

use super::friction::JointFriction;
use super::limits::{LimitOverride, MissingAcceleration, UnusableLimits};

/// A description of the robot: which part of a URDF it is, and what a URDF cannot say about it.
///
/// The default is the whole URDF on a fixed base.
///
/// ```
/// use whole_body::{Base, Description};
///
/// // An arm of a larger robot, its fingers open.
/// let arm = Description {
///     root: Some("panda_link0".into()),
///     tips: vec!["panda_tcp".into()],
///     locked: vec![("panda_finger_joint1".into(), 0.04)],
///     ..Description::default()
/// };
/// // Legs: the root link moves freely.
/// let humanoid = Description { base: Base::Floating, ..Description::default() };
/// # let _ = (arm, humanoid);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Description {
    /// Motion of the root link in the world.
    pub base: Base,
    /// The link to start from, whose frame is the world or the moving base. `None` takes the URDF's root link. Links
    /// that are not below it are left out.
    pub root: Option<String>,
    /// Links that are to move; all joints move if there are none. Joints that move none of these links stay at
    /// [`locked`](Self::locked) or at zero, and their links merge with the link that carries them.
    pub tips: Vec<String>,
    /// The URDF's joints of q in their order, without the base's. The list ensures that q is what the caller expects.
    /// An empty list takes the joints that move.
    pub joints: Vec<String>,
    /// Joints that stay at a position \[rad or m\], such as fingers or a lift.
    pub locked: Vec<(String, f64)>,
    /// Joint origins (parent link to joint, \[m\]) that replace the URDF's, such as the mount of an arm or the length
    /// of a tool.
    pub origins: Vec<(String, Isometry3<f64>)>,
    /// Limits that replace or complete the URDF's. A planar base has `base_x`, `base_y` and `base_yaw`.
    pub limits: Vec<(String, LimitOverride)>,
    /// Acceleration limit of joints that state none.
    pub missing_acceleration: MissingAcceleration,
    /// Treatment of limits that cannot be meant.
    pub unusable_limits: UnusableLimits,
    /// Friction of joints, for [`Moving::friction_into`](crate::Moving::friction_into).
    pub friction: Vec<(String, JointFriction)>,
    /// Frames besides the links.
    pub frames: Vec<AddedFrame>,
    /// Acceleration of gravity in the world frame \[m/s²\].
    pub gravity: Vector3<f64>,
}

impl Description {
    /// Describes the whole URDF on a planar base with these limits along x and y, and of its yaw.
    ///
    /// ```
    /// use whole_body::robot::LimitOverride;
    /// use whole_body::Description;
    ///
    /// let linear = LimitOverride::of_speed(1.0, 0.6); // m/s, m/s²
    /// let angular = LimitOverride::of_speed(2.0, 1.5); // rad/s, rad/s²
    /// let description = Description::on_planar_base(linear, angular);
    /// assert_eq!(description.limits[2].0, "base_yaw");
    /// ```
    pub fn on_planar_base(linear: LimitOverride, angular: LimitOverride) -> Self {
        let limits = [("base_x", linear), ("base_y", linear), ("base_yaw", angular)];
        let limits = limits.map(|(joint, limit)| (joint.to_owned(), limit)).to_vec();
        Self { base: Base::Planar, limits, ..Self::default() }
    }
}

impl Default for Description {
    fn default() -> Self {
        Self {
            base: Base::Fixed,
            root: None,
            tips: Vec::new(),
            joints: Vec::new(),
            locked: Vec::new(),
            origins: Vec::new(),
            limits: Vec::new(),
            missing_acceleration: MissingAcceleration::default(),
            unusable_limits: UnusableLimits::default(),
            friction: Vec::new(),
            frames: Vec::new(),
            gravity: Vector3::new(0.0, 0.0, -9.81),
        }
    }
}

/// Motion of the root link in the world.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Base {
    /// The root link is fixed in the world.
    #[default]
    Fixed,
    /// The root link moves on the plane z = 0 by three joints: x, y \[m\] and yaw \[rad\] along and about the world's
    /// axes. Yaw is a plain angle that is not wrapped. The first two entries of q̇ are the velocity in the world's
    /// axes, not in the base's own.
    Planar,
    /// The root link moves freely. q begins with its position \[m\] and its orientation as a unit quaternion x, y, z,
    /// w. q̇ begins with the velocity of its origin \[m/s\] and its angular velocity \[rad/s\]. Both are **in the
    /// world's axes**, as all twists of this crate are. (Pinocchio takes the base's own axes.) Forces on the base are a
    /// force and a moment about its origin in the same axes.
    Floating,
}

/// A frame besides the links, such as a tool, a sensor or a contact.
#[derive(Debug, Clone, PartialEq)]
pub struct AddedFrame {
    /// Name, different from all links'.
    pub name: String,
    /// The link, or an earlier added frame, that carries it.
    pub on: String,
    /// Pose on that link or frame \[m\].
    pub pose: Isometry3<f64>,
}
