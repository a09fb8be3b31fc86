//! From the text of a URDF to the chain that a description names.

use std::collections::BTreeMap;

use urdf_rs::{JointType, Robot};

use super::assembly::assemble;
use super::description::RobotDescription;
use super::limits::{JointLimits, LimitOverride};
use super::model::{JointKind, RobotModel};
use crate::error::{Error, check_finite};

/// Reads `text` and assembles the chain of `description`.
pub(super) fn read(text: &str, description: &RobotDescription) -> Result<RobotModel, Error> {
    let robot = urdf_rs::read_from_string(text)
        .map_err(|error| Error::Urdf { reason: error.to_string() })?;
    let tree = Tree::new(&robot)?;
    check_names(&robot, description)?;
    check_numbers(description)?;
    let path = tree.path(description)?;
    let moving = moving_joints(&path, description)?;
    let limits = moving
        .iter()
        .map(|(joint, kind)| joint_limits(joint, *kind, description))
        .collect::<Result<_, _>>()?;
    assemble(&tree, &path, &moving, limits, description)
}

/// A URDF whose names are unique and whose joints join links that exist.
pub(super) struct Tree<'a> {
    pub(super) robot: &'a Robot,
    links: BTreeMap<&'a str, &'a urdf_rs::Link>,
    /// By the name of the link that it carries.
    parents: BTreeMap<&'a str, &'a urdf_rs::Joint>,
}

/// The way from the root to the tool.
pub(super) struct Path<'a> {
    pub(super) root: &'a urdf_rs::Link,
    pub(super) tool: &'a str,
    /// From the root down.
    joints: Vec<&'a urdf_rs::Joint>,
}

impl<'a> Tree<'a> {
    fn new(robot: &'a Robot) -> Result<Self, Error> {
        let links = unique("link", robot.links.iter().map(|link| (&*link.name, link)))?;
        unique("joint", robot.joints.iter().map(|joint| (&*joint.name, ())))?;
        let mut parents = BTreeMap::new();
        for joint in &robot.joints {
            for (link, role) in [
                (&joint.parent.link, "the parent that a joint names"),
                (&joint.child.link, "the child that a joint names"),
            ] {
                if !links.contains_key(&**link) {
                    return Err(unknown_link(robot, link, role));
                }
            }
            let other: Option<&urdf_rs::Joint> = parents.insert(&*joint.child.link, joint);
            if let Some(other) = other {
                return Err(Error::TwoParents {
                    link: joint.child.link.clone(),
                    first: other.name.clone(),
                    second: joint.name.clone(),
                });
            }
        }
        let tree = Self { robot, links, parents };
        tree.check_loops()?;
        Ok(tree)
    }

    /// Going up from any link must end.
    fn check_loops(&self) -> Result<(), Error> {
        for link in self.links.keys() {
            let steps = std::iter::successors(Some(*link), |name| {
                self.parents.get(name).map(|joint| &*joint.parent.link)
            });
            if steps.take(self.links.len() + 1).count() > self.links.len() {
                return Err(Error::Loop { link: (*link).to_owned() });
            }
        }
        Ok(())
    }

    pub(super) fn link(&self, name: &str, role: &'static str) -> Result<&'a urdf_rs::Link, Error> {
        self.links.get(name).copied().ok_or_else(|| unknown_link(self.robot, name, role))
    }

    /// The joints that hang on the link `name`, in the order of the URDF.
    pub(super) fn joints_on(&self, name: &str) -> impl Iterator<Item = &'a urdf_rs::Joint> {
        self.robot.joints.iter().filter(move |joint| joint.parent.link == name)
    }

    /// Goes up from the tool until the root; without a named root, to the top.
    fn path(&self, description: &RobotDescription) -> Result<Path<'a>, Error> {
        let tool = self.link(&description.tool, "the tool")?;
        let root = match &description.root {
            Some(name) => Some(self.link(name, "the root")?),
            None => None,
        };
        let mut joints = Vec::new();
        let mut reached = tool;
        let found = loop {
            if root.is_some_and(|root| root.name == reached.name) {
                break true;
            }
            let Some(joint) = self.parents.get(&*reached.name) else {
                break root.is_none();
            };
            joints.push(*joint);
            reached = self.link(&joint.parent.link, "the parent that a joint names")?;
        };
        if !found {
            return Err(Error::NoPath {
                root: root.map_or("(top of the URDF)", |root| &root.name).to_owned(),
                tool: tool.name.clone(),
                reached: reached.name.clone(),
            });
        }
        joints.reverse();
        Ok(Path { root: reached, tool: &tool.name, joints })
    }
}

fn unique<'a, T>(
    element: &'static str,
    named: impl Iterator<Item = (&'a str, T)>,
) -> Result<BTreeMap<&'a str, T>, Error> {
    let mut map = BTreeMap::new();
    for (name, value) in named {
        if map.insert(name, value).is_some() {
            return Err(Error::DuplicateName { element, name: name.to_owned() });
        }
    }
    Ok(map)
}

/// Every joint that the description names must exist.
fn check_names(robot: &Robot, description: &RobotDescription) -> Result<(), Error> {
    let lists = [
        ("joints", description.joints.iter().collect::<Vec<_>>()),
        ("held", description.held.iter().map(|(name, _)| name).collect()),
        ("origins", description.origins.iter().map(|(name, _)| name).collect()),
        ("limits", description.limits.iter().map(|(name, _)| name).collect()),
    ];
    for (list_name, names) in lists {
        for name in names {
            if !robot.joints.iter().any(|joint| joint.name == *name) {
                return Err(Error::UnknownJoint {
                    joint: name.clone(),
                    list: list_name,
                    robot: robot.name.clone(),
                    known: list(robot.joints.iter().map(|joint| joint.name.as_str())),
                });
            }
        }
    }
    Ok(())
}

/// Every number in the description but the limits must be finite.
fn check_numbers(description: &RobotDescription) -> Result<(), Error> {
    for value in &description.gravity {
        check_finite(*value, || "a component of gravity".to_owned())?;
    }
    for (joint, position) in &description.held {
        check_finite(*position, || format!("the position that holds joint `{joint}`"))?;
    }
    for (joint, pose) in &description.origins {
        for value in pose.translation.vector.iter().chain(&pose.rotation.coords) {
            check_finite(*value, || format!("the description's origin of joint `{joint}`"))?;
        }
    }
    Ok(())
}

/// The movable joints of the path that nothing holds, as the description lists them.
fn moving_joints<'a>(
    path: &Path<'a>,
    description: &RobotDescription,
) -> Result<Vec<(&'a urdf_rs::Joint, JointKind)>, Error> {
    let is_held = |name: &str| description.held.iter().any(|(held, _)| held == name);
    if let Some(joint) = description.joints.iter().find(|name| is_held(name)) {
        return Err(Error::HeldAndMoving { joint: joint.clone() });
    }
    let mut moving = Vec::new();
    for joint in path.joints.iter().filter(|joint| !is_held(&joint.name)) {
        let Some(kind) = joint_kind(joint)? else {
            continue;
        };
        if joint.mimic.is_some() {
            return Err(Error::UnsupportedJoint {
                joint: joint.name.clone(),
                kind: "a mimic of another on the way to the tool",
            });
        }
        moving.push((*joint, kind));
    }
    if moving.is_empty() {
        return Err(Error::NoJoints { root: path.root.name.clone(), tool: path.tool.to_owned() });
    }
    let expected = moving.iter().map(|(joint, _)| joint.name.as_str());
    if !description.joints.is_empty() && !expected.clone().eq(&description.joints) {
        return Err(Error::JointOrder {
            expected: list(expected),
            given: list(description.joints.iter().map(String::as_str)),
        });
    }
    Ok(moving)
}

/// How a joint moves; `None` if it is fixed.
pub(super) fn joint_kind(joint: &urdf_rs::Joint) -> Result<Option<JointKind>, Error> {
    let kind = match joint.joint_type {
        JointType::Fixed => return Ok(None),
        JointType::Prismatic => JointKind::Prismatic,
        JointType::Revolute => JointKind::Revolute,
        JointType::Continuous => JointKind::Continuous,
        JointType::Floating => return unsupported(joint, "floating"),
        JointType::Planar => return unsupported(joint, "planar"),
        JointType::Spherical => return unsupported(joint, "spherical"),
    };
    Ok(Some(kind))
}

fn unsupported<T>(joint: &urdf_rs::Joint, kind: &'static str) -> Result<T, Error> {
    Err(Error::UnsupportedJoint { joint: joint.name.clone(), kind })
}

/// The URDF's limits with what the description knows, checked.
fn joint_limits(
    joint: &urdf_rs::Joint,
    kind: JointKind,
    description: &RobotDescription,
) -> Result<JointLimits, Error> {
    let known = description
        .limits
        .iter()
        .find(|(name, _)| *name == joint.name)
        .map_or_else(LimitOverride::default, |(_, known)| *known);
    // A URDF without <limit> reads as zeros.
    let is_missing = joint.limit == urdf_rs::JointLimit::default();
    let from_urdf = JointLimits {
        lower: joint.limit.lower,
        upper: joint.limit.upper,
        velocity: joint.limit.velocity,
        acceleration: joint.limit.acceleration,
        jerk: joint.limit.jerk,
        effort: joint.limit.effort,
    };
    let limits = match kind {
        JointKind::Continuous if is_missing => JointLimits::UNLIMITED,
        JointKind::Continuous => {
            JointLimits { lower: f64::NEG_INFINITY, upper: f64::INFINITY, ..from_urdf }
        }
        _ => from_urdf,
    };
    let has_own = known.position.is_some() && known.velocity.is_some() && known.effort.is_some();
    if is_missing && kind != JointKind::Continuous && !has_own {
        return Err(Error::LimitsMissing { joint: joint.name.clone() });
    }
    let limits = limits.with(&known);
    limits.validate(&joint.name)?;
    Ok(limits)
}

fn unknown_link(robot: &Robot, link: &str, role: &'static str) -> Error {
    Error::UnknownLink {
        link: link.to_owned(),
        role,
        robot: robot.name.clone(),
        known: list(robot.links.iter().map(|link| link.name.as_str())),
    }
}

/// Names as an error shows them.
pub(super) fn list<'a>(names: impl Iterator<Item = &'a str>) -> String {
    let names: Vec<_> = names.collect();
    if names.is_empty() { "(none)".to_owned() } else { names.join(", ") }
}
