//! The robot: what does not change while it moves.

use nalgebra::{Isometry3, Matrix3, Vector3};

use super::description::RobotDescription;
use super::limits::JointLimits;
use super::urdf;
use crate::error::Error;

/// A serial chain of prismatic and revolute joints from the world to a tool.
///
/// Fixed joints are folded into the links they join. The model is immutable;
/// what changes with the configuration lives in [`RobotData`](crate::RobotData).
///
/// ```
/// use moca_model::{RobotData, RobotModel, MOCA_HOME, forward_kinematics};
///
/// let model = RobotModel::moca()?;
/// assert_eq!(model.joint_count(), 10); // base x, y, yaw, then the arm's seven
///
/// let mut data = RobotData::new(&model);
/// forward_kinematics(&model, &mut data, &MOCA_HOME)?;
/// let tool = data.world_from_tool().translation.vector;
/// assert!((tool.z - 0.9959).abs() < 1e-4); // metres above the floor
/// # Ok::<(), moca_model::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct RobotModel {
    pub(super) name: String,
    pub(super) joints: Vec<Joint>,
    pub(super) limits: Vec<JointLimits>,
    pub(super) links: Vec<PlacedLink>,
    pub(super) segments: Vec<Segment>,
    pub(super) tool_from_last_joint: Frame,
    pub(super) gravity: Vector3<f64>,
}

/// A joint of the chain.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Joint {
    /// Name in the URDF.
    pub name: String,
    /// How it moves.
    pub kind: JointKind,
    /// The link that it carries; its frame is the joint's frame.
    pub child: LinkId,
}

/// How a joint moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum JointKind {
    /// Along its axis \[m\].
    Prismatic,
    /// About its axis, between limits \[rad\].
    Revolute,
    /// About its axis without position limits; a plain angle, not wrapped \[rad\].
    Continuous,
}

/// A link of one [`RobotModel`]; see [`RobotModel::link`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct LinkId(pub(super) usize);

#[derive(Debug, Clone)]
pub(super) struct PlacedLink {
    pub(super) name: String,
    /// The joint that moves it; `None` for what stands still in the world.
    pub(super) joint: Option<usize>,
    /// Its frame in the frame of that joint, or in the world.
    pub(super) joint_from_link: Isometry3<f64>,
}

/// A rotation and a position: the pose of one frame in another.
#[derive(Debug, Clone, Copy)]
pub(super) struct Frame {
    pub(super) rotation: Matrix3<f64>,
    pub(super) position: Vector3<f64>,
}

impl Frame {
    pub(super) fn identity() -> Self {
        Self { rotation: Matrix3::identity(), position: Vector3::zeros() }
    }

    pub(super) fn from_isometry(pose: &Isometry3<f64>) -> Self {
        Self {
            rotation: *pose.rotation.to_rotation_matrix().matrix(),
            position: pose.translation.vector,
        }
    }
}

/// One joint and the rigid body it carries.
///
/// The frame of a joint is here turned so that its axis is z: a rotation by q
/// then mixes two columns, whatever axis the URDF gives.
#[derive(Debug, Clone)]
pub(super) struct Segment {
    pub(super) slides: bool,
    /// From the previous joint's frame to this one's at q = 0.
    pub(super) placement: Frame,
    /// Mass of everything from this joint on \[kg\].
    pub(super) distal_mass: f64,
    /// Σ m c of the body, in the joint's frame \[kg m\].
    pub(super) first_moment: Vector3<f64>,
}

impl RobotModel {
    /// Reads the chain that `description` names from the text of a URDF.
    ///
    /// # Errors
    /// Each of [`Error`]'s variants about a URDF: text that is none, names that
    /// are missing or double, no way from root to tool, floating, planar or
    /// spherical joints, zero axes, numbers that are not finite, negative
    /// masses, missing or contradictory limits.
    pub fn from_urdf(text: &str, description: &RobotDescription) -> Result<Self, Error> {
        urdf::read(text, description)
    }

    /// The robot's name in the URDF.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// n, the number of joints.
    pub fn joint_count(&self) -> usize {
        self.joints.len()
    }

    /// The joints from root to tool, in the order of q.
    pub fn joints(&self) -> &[Joint] {
        &self.joints
    }

    /// The limits of the joints, in the order of q.
    pub fn limits(&self) -> &[JointLimits] {
        &self.limits
    }

    /// Acceleration of free fall in the world frame \[m/s²\].
    pub fn gravity(&self) -> Vector3<f64> {
        self.gravity
    }

    /// The link named `name`, for [`world_from_link`](crate::world_from_link).
    ///
    /// # Errors
    /// [`Error::UnknownLink`] if the chain and its side branches have no such link.
    pub fn link(&self, name: &str) -> Result<LinkId, Error> {
        self.links.iter().position(|link| link.name == name).map(LinkId).ok_or_else(|| {
            Error::UnknownLink {
                link: name.to_owned(),
                role: "the link asked for",
                robot: self.name.clone(),
                known: urdf::list(self.links.iter().map(|link| link.name.as_str())),
            }
        })
    }

    /// How many of the joints, from the first, move the link.
    ///
    /// # Errors
    /// [`Error::ForeignLink`] if `link` is of another model.
    pub fn joints_moving(&self, link: LinkId) -> Result<usize, Error> {
        let foreign = Error::ForeignLink { index: link.0, count: self.links.len() };
        let found = self.links.get(link.0).ok_or(foreign)?;
        Ok(found.joint.map_or(0, |joint| joint + 1))
    }

    /// All links at or below the root, with their names.
    pub fn links(&self) -> impl Iterator<Item = (LinkId, &str)> {
        self.links.iter().enumerate().map(|(index, link)| (LinkId(index), link.name.as_str()))
    }
}
