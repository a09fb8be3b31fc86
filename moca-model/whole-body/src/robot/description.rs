//! Which part of a URDF is the robot, and what a URDF cannot say about it.

use nalgebra::{Isometry3, Vector3};

use super::friction::JointFriction;
use super::limits::{LimitOverride, MissingAcceleration, UnusableLimits};

/// Which part of a URDF is the robot, and what a URDF cannot say about it.
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
///     held: vec![("panda_finger_joint1".into(), 0.04)],
///     ..Description::default()
/// };
/// // Legs: the root link moves freely.
/// let humanoid = Description { base: Base::Floating, ..Description::default() };
/// # let _ = (arm, humanoid);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Description {
    /// How the root link moves in the world.
    pub base: Base,
    /// The link to start from: its frame is the world, or that of the moving base. `None` takes
    /// the URDF's root link. What does not hang below it is left out.
    pub root: Option<String>,
    /// The links that are to move. A joint that is not on the way to one of them stays where
    /// [`held`](Self::held) puts it, or at zero, and its links are part of what carries them.
    /// Empty: all joints move.
    pub tips: Vec<String>,
    /// The URDF's joints that make q, in their order, without the base's. Listing them makes sure
    /// that q is what the caller thinks it is; empty takes those that move.
    pub joints: Vec<String>,
    /// Joints that stay at a position \[rad or m\]: fingers, a lift.
    pub held: Vec<(String, f64)>,
    /// Joint origins (parent link to joint) that replace the URDF's: where an arm is mounted, how
    /// long a tool is.
    pub origins: Vec<(String, Isometry3<f64>)>,
    /// Limits that replace or complete the URDF's; those of a planar base have the names
    /// `base_x`, `base_y`, `base_yaw`.
    pub limits: Vec<(String, LimitOverride)>,
    /// The acceleration limit of joints that state none.
    pub missing_acceleration: MissingAcceleration,
    /// What becomes of limits that cannot be meant.
    pub unusable_limits: UnusableLimits,
    /// Friction of joints, for [`Moving::friction_into`](crate::Moving::friction_into).
    pub friction: Vec<(String, JointFriction)>,
    /// Frames beside the links.
    pub frames: Vec<AddedFrame>,
    /// Acceleration of free fall in the world frame \[m/s²\].
    pub gravity: Vector3<f64>,
}

impl Description {
    /// The whole URDF on a planar base with these limits along x and y, and of its yaw.
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
            held: Vec::new(),
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

/// How the root link moves in the world.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Base {
    /// Not at all.
    #[default]
    Fixed,
    /// On the plane z = 0: three joints x, y \[m\] and yaw \[rad\] along and about the world's axes,
    /// yaw a plain angle that is not wrapped. q̇ is their rate, so that its first two entries are
    /// the velocity in the world's axes, not in the base's own.
    Planar,
    /// Freely. q begins with the root link's position \[m\] and its orientation as a unit
    /// quaternion x, y, z, w; q̇ with the velocity of its origin \[m/s\] and its angular velocity
    /// \[rad/s\], **both in the world's axes**, as all twists of this crate are. (Pinocchio takes
    /// the base's own axes.) Forces on the base are a force and a moment about its origin in the
    /// same axes.
    Floating,
}

/// A frame beside the links: a tool, a sensor, a contact.
#[derive(Debug, Clone, PartialEq)]
pub struct AddedFrame {
    /// Its name, different from all links'.
    pub name: String,
    /// The link or frame that carries it; frames may stand on frames that are added before them.
    pub on: String,
    /// Its pose there.
    pub pose: Isometry3<f64>,
}
