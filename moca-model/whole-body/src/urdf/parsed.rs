//! Conversion of robots that `urdf-rs` has read.

use urdf_rs::{JointLimit, JointType, Pose, Robot};

use super::document::{Document, Inertial, Joint, Kind, Limit, Link, Mimic, Origin};

/// The line that errors name, since parsed robots do not know their lines.
const NO_LINE: usize = 0;

impl From<&Robot> for Document {
    fn from(robot: &Robot) -> Self {
        Self {
            name: robot.name.clone(),
            links: robot.links.iter().map(link).collect(),
            joints: robot.joints.iter().map(joint).collect(),
        }
    }
}

fn link(link: &urdf_rs::Link) -> Link {
    let urdf_rs::Inertial { origin: pose, mass, inertia } = &link.inertial;
    let inertial = Inertial {
        line: NO_LINE,
        origin: origin(pose),
        mass: mass.value,
        moments: [inertia.ixx, inertia.iyy, inertia.izz, inertia.ixy, inertia.ixz, inertia.iyz],
    };
    Link { name: link.name.clone(), line: NO_LINE, inertial: Some(inertial) }
}

fn joint(joint: &urdf_rs::Joint) -> Joint {
    let kind = match joint.joint_type {
        JointType::Fixed => Kind::Fixed,
        JointType::Revolute => Kind::Revolute,
        JointType::Continuous => Kind::Continuous,
        JointType::Prismatic => Kind::Prismatic,
        JointType::Floating => Kind::Other("floating".to_owned()),
        JointType::Planar => Kind::Other("planar".to_owned()),
        JointType::Spherical => Kind::Other("spherical".to_owned()),
    };
    Joint {
        name: joint.name.clone(),
        line: NO_LINE,
        kind,
        parent: joint.parent.link.clone(),
        child: joint.child.link.clone(),
        origin: origin(&joint.origin),
        axis: *joint.axis.xyz,
        limit: limit(&joint.limit),
        mimic: joint.mimic.as_ref().map(|mimic| Mimic {
            joint: mimic.joint.clone(),
            multiplier: mimic.multiplier.unwrap_or(1.0),
            offset: mimic.offset.unwrap_or(0.0),
        }),
    }
}

fn origin(pose: &Pose) -> Origin {
    Origin { xyz: *pose.xyz, rpy: *pose.rpy }
}

/// Converts a limit. `urdf-rs` gives a joint without `<limit>` its default, and infinity for a missing acceleration or
/// jerk.
fn limit(limit: &JointLimit) -> Option<Limit> {
    let stated = |value: f64| value.is_finite().then_some(value);
    (*limit != JointLimit::default()).then(|| Limit {
        lower: Some(limit.lower),
        upper: Some(limit.upper),
        velocity: Some(limit.velocity),
        effort: Some(limit.effort),
        acceleration: stated(limit.acceleration.min(limit.deceleration)),
        jerk: stated(limit.jerk),
    })
}
