//! The motion elements of a URDF as they stand in the text.

use super::reader::{Element, Reader};
use crate::error::{Error, urdf::UrdfError};

/// The robot element.
#[derive(Debug, Clone)]
pub(crate) struct Document {
    pub(crate) name: String,
    pub(crate) links: Vec<Link>,
    pub(crate) joints: Vec<Joint>,
}

#[derive(Debug, Clone)]
pub(crate) struct Link {
    pub(crate) name: String,
    pub(crate) line: usize,
    pub(crate) inertial: Option<Inertial>,
}

#[derive(Debug, Clone, Default)]
pub(crate) struct Inertial {
    pub(crate) line: usize,
    pub(crate) origin: Origin,
    pub(crate) mass: f64,
    /// xx, yy, zz, xy, xz, yz \[kg m²\].
    pub(crate) moments: [f64; 6],
}

/// A translation \[m\] and roll, pitch and yaw \[rad\].
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Origin {
    pub(crate) xyz: [f64; 3],
    pub(crate) rpy: [f64; 3],
}

#[derive(Debug, Clone)]
pub(crate) struct Joint {
    pub(crate) name: String,
    pub(crate) line: usize,
    pub(crate) kind: Kind,
    pub(crate) parent: String,
    pub(crate) child: String,
    pub(crate) origin: Origin,
    pub(crate) axis: [f64; 3],
    pub(crate) limit: Option<Limit>,
    pub(crate) mimic: Option<Mimic>,
}

#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Kind {
    Fixed,
    Revolute,
    Continuous,
    Prismatic,
    /// A planar or floating joint, or a type unknown to URDF.
    Other(String),
}

/// The numbers of `<limit>`. URDF 1.2 leaves an attribute out if the joint is unlimited.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Limit {
    pub(crate) lower: Option<f64>,
    pub(crate) upper: Option<f64>,
    pub(crate) velocity: Option<f64>,
    pub(crate) effort: Option<f64>,
    pub(crate) acceleration: Option<f64>,
    pub(crate) jerk: Option<f64>,
}

#[derive(Debug, Clone)]
pub(crate) struct Mimic {
    pub(crate) joint: String,
    pub(crate) multiplier: f64,
    pub(crate) offset: f64,
}

/// Reads the text of a URDF.
pub(crate) fn read(text: &str) -> Result<Document, Error> {
    let mut reader = Reader::new(text);
    let root = reader.root()?;
    let mut robot = Document {
        name: root.attribute("name")?.unwrap_or_default(),
        links: Vec::new(),
        joints: Vec::new(),
    };
    let unlimited = says_unlimited(&root)?;
    while let Some(element) = reader.child(&root)? {
        match element.name() {
            "link" => robot.links.push(link(&mut reader, &element)?),
            "joint" => robot.joints.push(joint(&mut reader, &element, unlimited)?),
            _ => reader.skip(&element)?,
        }
    }
    reader.end()?;
    Ok(robot)
}

/// True if a missing limit means that there is none, as since URDF 1.2.
fn says_unlimited(root: &Element) -> Result<bool, Error> {
    let version = root.attribute("version")?.unwrap_or_default();
    let mut parts = version.trim().split('.').map(str::parse::<u32>);
    Ok(match (parts.next(), parts.next()) {
        (Some(Ok(major)), Some(Ok(minor))) => (major, minor) >= (1, 2),
        _ => false,
    })
}

fn link(reader: &mut Reader, element: &Element) -> Result<Link, Error> {
    let name = element.needed("name")?;
    let mut inertial = None;
    while let Some(child) = reader.child(element)? {
        if child.name() == "inertial" && inertial.is_none() {
            inertial = Some(read_inertial(reader, &child, &name)?);
        } else {
            reader.skip(&child)?;
        }
    }
    Ok(Link { name, line: element.line(), inertial })
}

fn read_inertial(reader: &mut Reader, element: &Element, link: &str) -> Result<Inertial, Error> {
    let (mut origin, mut mass, mut moments) = (None, None, None);
    while let Some(child) = reader.child(element)? {
        match child.name() {
            "origin" if origin.is_none() => origin = Some(read_origin(&child)?),
            "mass" if mass.is_none() => mass = Some(child.needed_number("value")?),
            "inertia" if moments.is_none() => {
                let mut values = [0.0; 6];
                for (value, name) in
                    values.iter_mut().zip(["ixx", "iyy", "izz", "ixy", "ixz", "iyz"])
                {
                    *value = child.needed_number(name)?;
                }
                moments = Some(values);
            }
            _ => {}
        }
        reader.skip(&child)?;
    }
    let missing = |missing| {
        Error::from(UrdfError::Missing {
            line: element.line(),
            owner: format!("the <inertial> of link `{link}`"),
            missing,
        })
    };
    Ok(Inertial {
        line: element.line(),
        origin: origin.unwrap_or_default(),
        mass: mass.ok_or_else(|| missing("<mass value=…/>"))?,
        moments: moments.ok_or_else(|| missing("<inertia ixx=… …/>"))?,
    })
}

fn read_origin(element: &Element) -> Result<Origin, Error> {
    let xyz = element.vector("xyz")?.unwrap_or_default();
    let rpy = match (element.vector("rpy")?, element.numbers::<4>("quat_xyzw")?) {
        (Some(rpy), _) => rpy,
        (None, Some([x, y, z, w])) => {
            let quaternion = nalgebra::Quaternion::new(w, x, y, z);
            if !(quaternion.norm() > 1e-9 && quaternion.norm().is_finite()) {
                return Err(Error::from(UrdfError::Attribute {
                    line: element.line(),
                    what: "`quat_xyzw` of <origin>".to_owned(),
                    got: format!("{x} {y} {z} {w}"),
                    wanted: "a quaternion that is not zero",
                }));
            }
            let (roll, pitch, yaw) =
                nalgebra::UnitQuaternion::from_quaternion(quaternion).euler_angles();
            [roll, pitch, yaw]
        }
        (None, None) => [0.0; 3],
    };
    Ok(Origin { xyz, rpy })
}

fn joint(reader: &mut Reader, element: &Element, unlimited: bool) -> Result<Joint, Error> {
    let name = element.needed("name")?;
    let kind = match element.needed("type")?.as_str() {
        "fixed" => Kind::Fixed,
        "revolute" => Kind::Revolute,
        "continuous" => Kind::Continuous,
        "prismatic" => Kind::Prismatic,
        other => Kind::Other(other.to_owned()),
    };
    let (mut parent, mut child, mut origin) = (None, None, None);
    let (mut axis, mut limit, mut mimic) = (None, None, None);
    while let Some(part) = reader.child(element)? {
        match part.name() {
            "parent" if parent.is_none() => parent = Some(part.needed("link")?),
            "child" if child.is_none() => child = Some(part.needed("link")?),
            "origin" if origin.is_none() => origin = Some(read_origin(&part)?),
            "axis" if axis.is_none() => axis = part.vector("xyz")?,
            "limit" if limit.is_none() => limit = Some(read_limit(&part, unlimited)?),
            "mimic" if mimic.is_none() => {
                mimic = Some(Mimic {
                    joint: part.needed("joint")?,
                    multiplier: part.number("multiplier")?.unwrap_or(1.0),
                    offset: part.number("offset")?.unwrap_or(0.0),
                });
            }
            _ => {}
        }
        reader.skip(&part)?;
    }
    let missing = |missing| {
        Error::from(UrdfError::Missing {
            line: element.line(),
            owner: format!("joint `{name}`"),
            missing,
        })
    };
    Ok(Joint {
        line: element.line(),
        kind,
        parent: parent.ok_or_else(|| missing("<parent link=…/>"))?,
        child: child.ok_or_else(|| missing("<child link=…/>"))?,
        origin: origin.unwrap_or_default(),
        axis: axis.unwrap_or([1.0, 0.0, 0.0]),
        limit,
        mimic,
        name,
    })
}

/// Reads a limit. Infinite values are left to the check of limits.
fn read_limit(element: &Element, unlimited: bool) -> Result<Limit, Error> {
    let omitted = unlimited.then_some(f64::INFINITY);
    let deceleration = element.any_number("deceleration")?;
    let acceleration = element.any_number("acceleration")?;
    let braking = |limit: f64| deceleration.map_or(limit, |deceleration| limit.min(deceleration));
    Ok(Limit {
        lower: element.any_number("lower")?.or(omitted.map(|limit| -limit)),
        upper: element.any_number("upper")?.or(omitted),
        velocity: element.any_number("velocity")?.or(omitted),
        effort: element.any_number("effort")?.or(omitted),
        acceleration: acceleration.map(braking),
        jerk: element.any_number("jerk")?,
    })
}
