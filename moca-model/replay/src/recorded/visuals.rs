//! The visible shapes of a URDF, link by link.

use std::collections::HashMap;

use nalgebra::{Isometry3, Translation3, UnitQuaternion};
use quick_xml::{
    Reader,
    events::{BytesStart, Event},
};

use super::{ReplayError, Shape};

/// The visible shapes of a robot.
#[derive(Debug, Default)]
pub(super) struct Visuals {
    /// In the order of the text.
    pub(super) links: Vec<LinkVisuals>,
    /// Red, green and blue of the robot's materials.
    materials: HashMap<String, [f64; 3]>,
}

#[derive(Debug)]
pub(super) struct LinkVisuals {
    pub(super) name: String,
    pub(super) visuals: Vec<Visual>,
}

/// A shape in its link; meshes have none.
#[derive(Debug, Default)]
pub(super) struct Visual {
    pub(super) link_from_shape: Isometry3<f64>,
    pub(super) shape: Option<Shape>,
    material: String,
    colour: Option<[f64; 3]>,
}

impl Visuals {
    pub(super) fn read(urdf: &str) -> Result<Self, ReplayError> {
        let mut xml = Reader::from_str(urdf);
        xml.config_mut().expand_empty_elements = true;
        let (mut robot, mut path) = (Self::default(), Vec::new());
        let (mut is_robot, mut material) = (false, String::new());
        loop {
            let event = xml.read_event().map_err(|error| refuse(&error.to_string()))?;
            let start = match event {
                Event::Start(start) => start,
                Event::End(_) => {
                    path.pop();
                    continue;
                }
                Event::Eof if is_robot && path.is_empty() => return Ok(robot),
                Event::Eof => return Err(refuse("a closed <robot> is missing")),
                _ => continue,
            };
            path.push(String::from_utf8_lossy(start.name().as_ref()).into_owned());
            is_robot |= path == ["robot"];
            let names: Vec<&str> = path.iter().take(6).map(String::as_str).collect();
            match names[..] {
                ["robot", "material"] => material = text(&start, "name")?.unwrap_or_default(),
                ["robot", "material", "color"] => {
                    robot.materials.insert(material.clone(), colour(&start)?);
                }
                ["robot", "link"] => {
                    let name = text(&start, "name")?.unwrap_or_default();
                    robot.links.push(LinkVisuals { name, visuals: Vec::new() });
                }
                ["robot", "link", "visual", ref below @ ..] => {
                    if let Some(link) = robot.links.last_mut() {
                        link.read_visual(below, &start)?;
                    }
                }
                _ => {}
            }
        }
    }

    /// Red, green and blue, if the text says them.
    pub(super) fn colour(&self, visual: &Visual) -> Option<[f64; 3]> {
        visual.colour.or_else(|| self.materials.get(&visual.material).copied())
    }
}

impl LinkVisuals {
    /// Takes the start of a `<visual>`, or of what is `below` it.
    fn read_visual(&mut self, below: &[&str], start: &BytesStart<'_>) -> Result<(), ReplayError> {
        if below.is_empty() {
            self.visuals.push(Visual::default());
        }
        let Some(visual) = self.visuals.last_mut() else { return Ok(()) };
        match below {
            ["origin"] => {
                let [x, y, z] = numbers(start, "xyz")?.unwrap_or_default();
                let [roll, pitch, yaw] = numbers(start, "rpy")?.unwrap_or_default();
                let rotation = UnitQuaternion::from_euler_angles(roll, pitch, yaw);
                visual.link_from_shape =
                    Isometry3::from_parts(Translation3::new(x, y, z), rotation);
            }
            ["geometry", kind] => visual.shape = shape(kind, start)?,
            ["material"] => visual.material = text(start, "name")?.unwrap_or_default(),
            ["material", "color"] => visual.colour = Some(colour(start)?),
            _ => {}
        }
        Ok(())
    }
}

fn shape(kind: &str, start: &BytesStart<'_>) -> Result<Option<Shape>, ReplayError> {
    let number = |name| needed(start, name).map(|[number]| number);
    Ok(match kind {
        "box" => Some(Shape::Box { size: needed(start, "size")? }),
        "cylinder" => {
            Some(Shape::Cylinder { length: number("length")?, radius: number("radius")? })
        }
        "capsule" => Some(Shape::Capsule { length: number("length")?, radius: number("radius")? }),
        "sphere" => Some(Shape::Sphere { radius: number("radius")? }),
        _ => None,
    })
}

fn colour(start: &BytesStart<'_>) -> Result<[f64; 3], ReplayError> {
    needed(start, "rgba").map(|[red, green, blue, _]| [red, green, blue])
}

fn needed<const N: usize>(start: &BytesStart<'_>, name: &str) -> Result<[f64; N], ReplayError> {
    numbers(start, name)?.ok_or_else(|| refuse(&format!("attribute `{name}` is missing")))
}

fn numbers<const N: usize>(
    start: &BytesStart<'_>,
    name: &str,
) -> Result<Option<[f64; N]>, ReplayError> {
    let Some(text) = text(start, name)? else { return Ok(None) };
    let numbers: Option<Vec<f64>> = text.split_whitespace().map(|word| word.parse().ok()).collect();
    let numbers = numbers.and_then(|numbers| numbers.try_into().ok());
    numbers.map(Some).ok_or_else(|| refuse(&format!("`{name}` is {text:?}, not {N} numbers")))
}

fn text(start: &BytesStart<'_>, name: &str) -> Result<Option<String>, ReplayError> {
    let attribute = start.try_get_attribute(name).map_err(|error| refuse(&error.to_string()))?;
    let text = attribute.map(|attribute| attribute.unescape_value()).transpose();
    Ok(text.map_err(|error| refuse(&error.to_string()))?.map(Into::into))
}

fn refuse(reason: &str) -> ReplayError {
    ReplayError::Urdf { reason: reason.to_owned() }
}
