//! Folds fixed joints and side branches of a URDF into the links of the chain.

use nalgebra::{Isometry3, Point3, Translation3, UnitQuaternion, UnitVector3, Vector3};

use super::description::RobotDescription;
use super::limits::JointLimits;
use super::model::{Frame, Joint, JointKind, LinkId, PlacedLink, RobotModel, Segment};
use super::urdf::{Path, Tree, joint_kind};
use crate::error::{Error, check_finite};

/// A link that is still to be visited, in the frame of the joint that moves it.
struct Visit<'a> {
    link: &'a urdf_rs::Link,
    joint: Option<usize>,
    joint_from_link: Isometry3<f64>,
}

/// Visits every link below the root and gives its mass and its frame to the
/// moving joint that carries it.
pub(super) fn assemble<'a>(
    tree: &Tree<'a>,
    path: &Path<'a>,
    moving: &[(&'a urdf_rs::Joint, JointKind)],
    limits: Vec<JointLimits>,
    description: &RobotDescription,
) -> Result<RobotModel, Error> {
    let mut bodies = moving.iter().map(|(_, kind)| Body::new(*kind)).collect::<Vec<_>>();
    let mut links: Vec<PlacedLink> = Vec::new();
    let mut to_visit =
        vec![Visit { link: path.root, joint: None, joint_from_link: Isometry3::identity() }];
    while let Some(visit) = to_visit.pop() {
        let inertia = checked_inertia(visit.link)?;
        if let Some(body) = visit.joint.and_then(|index| bodies.get_mut(index)) {
            body.carry(&inertia, &visit.joint_from_link);
        }
        for joint in tree.joints_on(&visit.link.name) {
            let child = tree.link(&joint.child.link, "the child that a joint names")?;
            let placed = visit.joint_from_link * origin(joint, description)?;
            let index = moving.iter().position(|(moves, _)| moves.name == joint.name);
            let next = if let Some(body) = index.and_then(|index| bodies.get_mut(index)) {
                let align = rotation_from_z(&axis(joint)?);
                body.placement = placed * align;
                Visit { link: child, joint: index, joint_from_link: align.inverse() }
            } else {
                let displaced = placed * displacement(joint, description)?;
                Visit { link: child, joint: visit.joint, joint_from_link: displaced }
            };
            to_visit.push(next);
        }
        links.push(PlacedLink {
            name: visit.link.name.clone(),
            joint: visit.joint,
            joint_from_link: visit.joint_from_link,
        });
    }
    let named = |name: &str| links.iter().position(|link| link.name == name);
    let joints = moving
        .iter()
        .filter_map(|(joint, kind)| {
            Some(Joint {
                name: joint.name.clone(),
                kind: *kind,
                child: LinkId(named(&joint.child.link)?),
            })
        })
        .collect();
    let tool = named(path.tool).and_then(|index| links.get(index));
    Ok(RobotModel {
        name: tree.robot.name.clone(),
        joints,
        limits,
        segments: segments(&bodies),
        tool_from_last_joint: tool
            .map_or_else(Frame::identity, |link| Frame::from_isometry(&link.joint_from_link)),
        gravity: description.gravity,
        links,
    })
}

/// What one moving joint carries up to the next one.
struct Body {
    kind: JointKind,
    placement: Isometry3<f64>,
    mass: f64,
    first_moment: Vector3<f64>,
}

impl Body {
    fn new(kind: JointKind) -> Self {
        Self { kind, placement: Isometry3::identity(), mass: 0.0, first_moment: Vector3::zeros() }
    }

    fn carry(&mut self, inertia: &PointMass, joint_from_link: &Isometry3<f64>) {
        self.mass += inertia.mass;
        self.first_moment += inertia.mass * (joint_from_link * inertia.center).coords;
    }
}

fn segments(bodies: &[Body]) -> Vec<Segment> {
    let mut distal_mass = 0.0;
    let mut segments: Vec<_> = bodies
        .iter()
        .rev()
        .map(|body| {
            distal_mass += body.mass;
            Segment {
                slides: body.kind == JointKind::Prismatic,
                placement: Frame::from_isometry(&body.placement),
                distal_mass,
                first_moment: body.first_moment,
            }
        })
        .collect();
    segments.reverse();
    segments
}

/// As much of a link's inertia as gravity sees.
struct PointMass {
    mass: f64,
    center: Point3<f64>,
}

fn checked_inertia(link: &urdf_rs::Link) -> Result<PointMass, Error> {
    let urdf_rs::Inertial { origin, mass, inertia } = &link.inertial;
    check_finite(mass.value, || format!("the mass of link `{}`", link.name))?;
    if mass.value < 0.0 {
        return Err(Error::NegativeMass { link: link.name.clone(), mass: mass.value });
    }
    for value in origin.xyz.iter().chain(origin.rpy.iter()) {
        check_finite(*value, || format!("the origin of the inertia of link `{}`", link.name))?;
    }
    for value in [inertia.ixx, inertia.iyy, inertia.izz, inertia.ixy, inertia.ixz, inertia.iyz] {
        check_finite(value, || format!("the inertia of link `{}`", link.name))?;
    }
    Ok(PointMass { mass: mass.value, center: Point3::from(*origin.xyz) })
}

/// The joint's frame at zero in its parent link's: the description's, or the URDF's.
fn origin(joint: &urdf_rs::Joint, description: &RobotDescription) -> Result<Isometry3<f64>, Error> {
    let replaced = description.origins.iter().find(|(name, _)| *name == joint.name);
    if let Some((_, pose)) = replaced {
        return Ok(*pose);
    }
    let urdf_rs::Pose { xyz, rpy } = &joint.origin;
    for value in xyz.iter().chain(rpy.iter()) {
        check_finite(*value, || format!("the origin of joint `{}`", joint.name))?;
    }
    let [x, y, z] = **xyz;
    let [roll, pitch, yaw] = **rpy;
    Ok(Isometry3::from_parts(
        Translation3::new(x, y, z),
        UnitQuaternion::from_euler_angles(roll, pitch, yaw),
    ))
}

fn axis(joint: &urdf_rs::Joint) -> Result<UnitVector3<f64>, Error> {
    for value in joint.axis.xyz.iter() {
        check_finite(*value, || format!("the axis of joint `{}`", joint.name))?;
    }
    UnitVector3::try_new(Vector3::from(*joint.axis.xyz), 1e-9)
        .ok_or_else(|| Error::ZeroAxis { joint: joint.name.clone() })
}

/// A rotation that takes z to `axis`; none if `axis` is z.
fn rotation_from_z(axis: &UnitVector3<f64>) -> Isometry3<f64> {
    let up = if axis.y.abs() < 0.9 { Vector3::y() } else { Vector3::x() };
    turn(UnitQuaternion::face_towards(axis, &up))
}

fn turn(rotation: UnitQuaternion<f64>) -> Isometry3<f64> {
    Isometry3::from_parts(Translation3::identity(), rotation)
}

/// Where a joint that does not move with q holds its child.
fn displacement(
    joint: &urdf_rs::Joint,
    description: &RobotDescription,
) -> Result<Isometry3<f64>, Error> {
    let Some(kind) = joint_kind(joint)? else {
        return Ok(Isometry3::identity());
    };
    let held = description.held.iter().find(|(name, _)| *name == joint.name);
    let position = held.map_or(0.0, |(_, position)| *position);
    let axis = axis(joint)?;
    Ok(match kind {
        JointKind::Prismatic => Translation3::from(position * *axis).into(),
        JointKind::Revolute | JointKind::Continuous => {
            turn(UnitQuaternion::from_axis_angle(&axis, position))
        }
    })
}
