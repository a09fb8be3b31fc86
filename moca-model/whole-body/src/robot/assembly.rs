//! Assembly of a model from the selected joints of a URDF. Fixed and locked joints are merged into bodies.

use std::collections::HashMap;

use nalgebra::{Isometry3, Translation3, UnitQuaternion, UnitVector3, Vector3};

use super::bodies::Mover;
use super::checks::{check_names, check_numbers};
use super::description::{Base, Description};
use super::frame::{Frame, FrameId};
use super::inertia;
use super::joint::{Joint, JointId, JointKind, MimicJoint};
use super::limit_rules::{self, Resolved};
use super::limit_sources::LimitSources;
use super::limits::JointLimits;
use super::model::{Model, next_tag};
use super::selection::{Role, Selection, select};
use crate::error::{Error, urdf::UrdfError};
use crate::inertia::body::BodyInertia;
use crate::spatial::{Motion, Pose};
use crate::urdf::document::{self, Document, Kind, Origin};
use crate::urdf::tree::Tree;

/// Assembles the part of `document` that `description` selects.
pub(super) fn assemble(document: &Document, description: &Description) -> Result<Model, Error> {
    check_numbers(description)?;
    let tree = Tree::new(document)?;
    check_names(&tree, description)?;
    let selection = select(&tree, description)?;
    if selection.free.is_empty() && description.base == Base::Fixed {
        return Err(Error::NoJoints {
            robot: document.name.clone(),
            root: document.links[selection.root].name.clone(),
        });
    }
    let mut assembly = Assembly::new(&tree, &selection, description);
    assembly.base()?;
    assembly.joints()?;
    assembly.finish()
}

struct Assembly<'a, 'b> {
    tree: &'a Tree<'b>,
    selection: &'a Selection,
    description: &'a Description,
    origins: HashMap<&'a str, &'a Isometry3<f64>>,
    /// The body that carries each link, and the link's pose on it.
    placed: Vec<(usize, Isometry3<f64>)>,
    /// First entries of each free joint in q and q̇.
    entries: Vec<(usize, usize)>,
    /// Limits of each joint that follows another one, and the line where it begins.
    followers: Vec<(JointLimits, usize)>,
    model: Model,
}

impl<'a, 'b> Assembly<'a, 'b> {
    fn new(tree: &'a Tree<'b>, selection: &'a Selection, description: &'a Description) -> Self {
        let document = tree.document;
        let (position_offset, velocity_offset) = match description.base {
            Base::Fixed => (0, 0),
            Base::Planar => (3, 3),
            Base::Floating => (7, 6),
        };
        let free = 0..selection.free.len();
        Self {
            tree,
            selection,
            description,
            origins: description.origins.iter().map(|(name, pose)| (&**name, pose)).collect(),
            placed: vec![(0, Isometry3::identity()); document.links.len()],
            entries: free.map(|k| (position_offset + k, velocity_offset + k)).collect(),
            followers: Vec::new(),
            model: Model {
                tag: next_tag(),
                name: document.name.clone(),
                base: description.base,
                positions: position_offset + selection.free.len(),
                velocities: velocity_offset + selection.free.len(),
                joints: Vec::new(),
                mimics: Vec::new(),
                limits: Vec::new(),
                limit_sources: Vec::new(),
                friction: Vec::new(),
                default_accelerations: Vec::new(),
                movers: Vec::new(),
                inertias: vec![BodyInertia::zero()],
                frames: Vec::new(),
                frame_names: HashMap::new(),
                joint_names: HashMap::new(),
                gravity: description.gravity,
                warnings: Vec::new(),
            },
        }
    }

    /// Adds the joints of the base and the root link.
    fn base(&mut self) -> Result<(), Error> {
        let root = self.selection.root;
        let child = self.next_frame();
        match self.description.base {
            Base::Fixed => {}
            Base::Planar => {
                let joints = [
                    ("base_x", Vector3::x_axis(), JointKind::Prismatic),
                    ("base_y", Vector3::y_axis(), JointKind::Prismatic),
                    ("base_yaw", Vector3::z_axis(), JointKind::Continuous),
                ];
                for (index, (name, axis, kind)) in joints.into_iter().enumerate() {
                    let limits = limit_rules::of_base(name, self.description)?;
                    self.add_joint(name, kind, child, (index, index), None, limits)?;
                    // Each joint is along the world's axes while it is at zero.
                    let before = self.placed[root];
                    self.placed[root] =
                        self.add_mover(&before, &Isometry3::identity(), &axis, kind, index, index);
                }
            }
            Base::Floating => {
                let limits =
                    Resolved { limits: JointLimits::UNLIMITED, default_acceleration: false };
                self.add_joint("floating_base", JointKind::Floating, child, (0, 0), None, limits)?;
            }
        }
        self.add_link(root)
    }

    /// Adds all joints below the root, with the links that they carry.
    fn joints(&mut self) -> Result<(), Error> {
        let document = self.tree.document;
        for &index in &self.selection.order {
            let joint = &document.joints[index];
            let child = self.tree.child(index);
            let carrier = self.placed[self.tree.parent(index)];
            let origin = self.origin(joint);
            self.placed[child] = match self.selection.roles[index] {
                Role::Locked(position) => {
                    let held = displacement(joint, position)?;
                    (carrier.0, carrier.1 * origin * held)
                }
                Role::Free(free) => {
                    let kind = moving_kind(joint);
                    let frame = self.next_frame();
                    let entries = self.entries[free];
                    let resolved =
                        limit_rules::of_joint(joint, self.description, &mut self.model.warnings)?;
                    self.add_joint(&joint.name, kind, frame, entries, Some(joint.line), resolved)?;
                    self.add_mover(&carrier, &origin, &axis(joint)?, kind, entries.0, entries.1)
                }
                Role::Follows { free, multiplier, offset } => {
                    let follows = self.joint_id(free);
                    let limits = limit_rules::of_follower(joint, self.description)?;
                    self.followers.push((limits, joint.line));
                    let name = joint.name.clone();
                    let child = self.next_frame();
                    self.model.mimics.push(MimicJoint { name, follows, multiplier, offset, child });
                    let kind = moving_kind(joint);
                    let (position, velocity) = self.entries[free];
                    let placed =
                        self.add_mover(&carrier, &origin, &axis(joint)?, kind, position, velocity);
                    if let Some(mover) = self.model.movers.last_mut() {
                        (mover.ratio, mover.offset) = (multiplier, offset);
                    }
                    placed
                }
            };
            self.add_link(child)?;
        }
        Ok(())
    }

    /// The id of the free joint of this number. The base's joints come first.
    fn joint_id(&self, free: usize) -> JointId {
        let base = match self.description.base {
            Base::Fixed => 0,
            Base::Planar => 3,
            Base::Floating => 1,
        };
        JointId { model: self.model.tag, index: base + free }
    }

    fn next_frame(&self) -> FrameId {
        FrameId { model: self.model.tag, index: self.model.frames.len() }
    }

    fn add_joint(
        &mut self,
        name: &str,
        kind: JointKind,
        child: FrameId,
        (position_index, velocity_index): (usize, usize),
        line: Option<usize>,
        Resolved { limits, default_acceleration }: Resolved,
    ) -> Result<(), Error> {
        let model = &mut self.model;
        let index = model.joints.len();
        if model.joint_names.insert(name.to_owned(), index).is_some() {
            return Err(Error::DuplicateName { line, element: "joint", name: name.to_owned() });
        }
        if default_acceleration {
            model.default_accelerations.push(JointId { model: model.tag, index });
        }
        let friction = self.description.friction.iter().find(|(joint, _)| joint == name);
        let friction = friction.map(|(_, friction)| *friction);
        model.limits.extend(std::iter::repeat_n(limits, kind.velocities()));
        model.limit_sources.resize(model.limits.len(), LimitSources::default());
        model.friction.extend(std::iter::repeat_n(friction, kind.velocities()));
        let name = name.to_owned();
        model.joints.push(Joint { name, kind, child, position_index, velocity_index });
        Ok(())
    }

    /// Adds a body that moves relative to its carrier. Its link's pose is that of its frame without the rotation that
    /// makes the axis z.
    fn add_mover(
        &mut self,
        carrier: &(usize, Isometry3<f64>),
        origin: &Isometry3<f64>,
        axis: &UnitVector3<f64>,
        kind: JointKind,
        position: usize,
        velocity: usize,
    ) -> (usize, Isometry3<f64>) {
        let align = rotation_from_z(axis);
        let motion = if kind == JointKind::Prismatic { Motion::Slides } else { Motion::Turns };
        self.model.movers.push(Mover {
            parent: carrier.0,
            motion,
            placement: Pose::from_isometry(&(carrier.1 * origin * align)),
            position,
            velocity,
            ratio: 1.0,
            offset: 0.0,
        });
        self.model.inertias.push(BodyInertia::zero());
        (self.model.movers.len(), align.inverse())
    }

    /// Adds a link's frame and inertia to the body that carries it.
    fn add_link(&mut self, link: usize) -> Result<(), Error> {
        let (body, pose) = self.placed[link];
        let link = &self.tree.document.links[link];
        let own = |inertial: &document::Inertial| {
            Pose::from_isometry(&(pose * isometry(&inertial.origin)))
        };
        let inertia = inertia::of_link(link, own, &mut self.model.warnings)?;
        // Links that are fixed in the world do not count in the dynamics.
        if body > 0 || self.description.base == Base::Floating {
            let carried = &mut self.model.inertias[body];
            *carried = carried.joined(&inertia);
        }
        self.model.add_frame(Frame {
            name: link.name.clone(),
            body,
            pose: Pose::from_isometry(&pose),
        })
    }

    fn origin(&self, joint: &document::Joint) -> Isometry3<f64> {
        let replaced = self.origins.get(joint.name.as_str());
        replaced.map_or_else(|| isometry(&joint.origin), |pose| **pose)
    }

    fn finish(mut self) -> Result<Model, Error> {
        for frame in &self.description.frames {
            self.model.place_frame(frame)?;
        }
        for (number, (limits, line)) in self.followers.iter().enumerate() {
            self.model.limit_by_follower(number, limits, *line);
        }
        self.model.limit_default_accelerations(self.description);
        self.model.warn_of_massless();
        Ok(self.model)
    }
}

fn moving_kind(joint: &document::Joint) -> JointKind {
    match joint.kind {
        Kind::Prismatic => JointKind::Prismatic,
        Kind::Continuous => JointKind::Continuous,
        _ => JointKind::Revolute,
    }
}

fn isometry(origin: &Origin) -> Isometry3<f64> {
    let ([x, y, z], [roll, pitch, yaw]) = (origin.xyz, origin.rpy);
    let rotation = UnitQuaternion::from_euler_angles(roll, pitch, yaw);
    Isometry3::from_parts(Translation3::new(x, y, z), rotation)
}

fn axis(joint: &document::Joint) -> Result<UnitVector3<f64>, Error> {
    UnitVector3::try_new(Vector3::from(joint.axis), 1e-9).ok_or_else(|| {
        Error::from(UrdfError::ZeroAxis { line: joint.line, joint: joint.name.clone() })
    })
}

/// A rotation that takes z to `axis`; the identity if `axis` is z.
fn rotation_from_z(axis: &UnitVector3<f64>) -> Isometry3<f64> {
    let up = if axis.y.abs() < 0.9 { Vector3::y() } else { Vector3::x() };
    turn(UnitQuaternion::face_towards(axis, &up))
}

fn turn(rotation: UnitQuaternion<f64>) -> Isometry3<f64> {
    Isometry3::from_parts(Translation3::identity(), rotation)
}

/// The pose of a joint's child with the joint at `position`.
fn displacement(joint: &document::Joint, position: f64) -> Result<Isometry3<f64>, Error> {
    Ok(match joint.kind {
        Kind::Fixed | Kind::Other(_) => Isometry3::identity(),
        Kind::Prismatic => Translation3::from(position * *axis(joint)?).into(),
        Kind::Revolute | Kind::Continuous => {
            turn(UnitQuaternion::from_axis_angle(&axis(joint)?, position))
        }
    })
}
