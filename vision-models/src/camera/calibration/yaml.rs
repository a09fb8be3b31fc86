//! The YAML of OpenCV and ROS.

use std::collections::BTreeMap;

use nalgebra::{Matrix3, Rotation3, Vector3};
use saphyr_parser::{Event, Parser};

use super::{
    CalibratedCamera,
    pose::{pose, refuse},
};
use crate::camera::{Distortion, Intrinsics};
use crate::error::Error;
use crate::excerpt::Excerpt;

/// The most values that are kept of a name: none that is read has more.
const MOST: usize = 16;

/// Values behind each name of the outermost mapping: all scalars, but of a matrix those of its `data` alone.
type Values = BTreeMap<String, Vec<String>>;

/// The camera of a text, whose name is the one in the text if there is one.
pub(super) fn camera(text: &str, name: &str) -> Result<CalibratedCamera, Error> {
    let values = values(text)?;
    let size = [number(&values, "image_width")?, number(&values, "image_height")?];
    if !size.iter().all(|side| (1.0..=1e6).contains(side)) {
        return Err(refuse(format!("images of {} × {} pixels", size[0], size[1])));
    }
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "is checked")]
    let size = size.map(|side| side as usize);
    let matrix = numbers(&values, "camera_matrix")?;
    let [fx, skew, cx, _, fy, cy, _, _, _] = matrix[..] else {
        return Err(refuse(format!("camera_matrix of {} numbers, not 9", matrix.len())));
    };
    if skew.abs() > 1e-6 * fx.abs() {
        return Err(refuse(format!("camera_matrix with a skew of {skew}: give one without")));
    }
    let name = values.get("camera_name").and_then(|names| names.first()).map_or(name, |name| name);
    Ok(CalibratedCamera {
        name: name.to_owned(),
        intrinsics: Intrinsics::new(size, [fx, fy], [cx, cy])?,
        distortion: distortion(&values)?,
        world_from_camera: world_from_camera(&values)?,
    })
}

fn distortion(values: &Values) -> Result<Distortion, Error> {
    let factors = numbers(values, "distortion_coefficients")?;
    let model = values.get("distortion_model").and_then(|model| model.first());
    let model = model.map_or("plumb_bob", |model| model);
    let count = factors.len();
    match model {
        _ if factors.iter().all(|factor| *factor == 0.0) => Ok(Distortion::None),
        "plumb_bob" | "rational_polynomial" | "pinhole" if [4, 5, 8].contains(&count) => {
            let mut all = [0.0; 8];
            all.iter_mut().zip(factors).for_each(|(all, factor)| *all = factor);
            Ok(Distortion::Radial(all))
        }
        "equidistant" | "fisheye" if count == 4 => {
            let mut all = [0.0; 4];
            all.copy_from_slice(&factors);
            Ok(Distortion::Fisheye(all))
        }
        _ => Err(refuse(format!(
            "distortion_model {} with {count} coefficients: give plumb_bob (4 or 5), rational_polynomial (8) or \
             equidistant (4)",
            Excerpt(model)
        ))),
    }
}

/// Pose of the camera, if it is told: OpenCV's motion is from the world to the camera.
fn world_from_camera(values: &Values) -> Result<Option<nalgebra::Isometry3<f64>>, Error> {
    let named =
        |names: &[&'static str]| names.iter().copied().find(|name| values.contains_key(*name));
    let (Some(turn), Some(shift)) = (named(&["R", "rvec"]), named(&["T", "tvec"])) else {
        return match named(&["R", "rvec", "T", "tvec"]) {
            None => Ok(None),
            Some(name) => Err(refuse(format!("{name} alone: give both R or rvec, and T or tvec"))),
        };
    };
    let (turn, shift) = (numbers(values, turn)?, numbers(values, shift)?);
    let rotation = match turn[..] {
        [x, y, z] => *Rotation3::new(Vector3::new(x, y, z)).matrix(),
        ref rows if rows.len() == 9 => Matrix3::from_row_slice(rows),
        _ => return Err(refuse(format!("a rotation of {} numbers, not 3 or 9", turn.len()))),
    };
    let [x, y, z] = shift[..] else {
        return Err(refuse(format!("a translation of {} numbers, not 3", shift.len())));
    };
    pose(rotation, Vector3::new(x, y, z)).map(|camera_from_world| Some(camera_from_world.inverse()))
}

fn number(values: &Values, name: &str) -> Result<f64, Error> {
    let numbers = numbers(values, name)?;
    let [number] = numbers[..] else {
        return Err(refuse(format!("{name} of {} numbers", numbers.len())));
    };
    Ok(number)
}

fn numbers(values: &Values, name: &str) -> Result<Vec<f64>, Error> {
    let texts = values.get(name).ok_or_else(|| {
        refuse(format!("no {name}: give the YAML of a camera as OpenCV or ROS write it"))
    })?;
    let number = |text: &String| {
        let number = text.parse::<f64>().ok().filter(|number| number.is_finite());
        number.ok_or_else(|| refuse(format!("{} in {name}", Excerpt(text))))
    };
    texts.iter().map(number).collect()
}

/// The scalars behind the outermost names. OpenCV's first line has a colon that YAML does not know.
fn values(text: &str) -> Result<Values, Error> {
    let text = text.trim_start_matches('\u{feff}');
    let text = match text.split_once('\n') {
        Some((first, rest)) if first.starts_with("%YAML:") => rest,
        _ => text,
    };
    let mut values = Values::new();
    let (mut outer, mut inner) = (None::<String>, None::<String>);
    let mut depth = 0_usize;
    for event in Parser::new_from_str(text) {
        let (event, _) = event.map_err(|error| refuse(Excerpt(&error.to_string()).to_string()))?;
        match event {
            Event::MappingStart(..) | Event::SequenceStart(..) => depth += 1,
            Event::MappingEnd | Event::SequenceEnd => {
                depth = depth.saturating_sub(1);
                if depth == 1 {
                    (outer, inner) = (None, None);
                }
            }
            Event::Alias(_) => return Err(refuse("an alias")),
            Event::Scalar(text, ..) if depth == 1 && outer.is_none() => {
                outer = Some(text.into_owned());
            }
            Event::Scalar(text, ..) => {
                let Some(name) = &outer else { continue };
                let is_key = depth == 2 && ["rows", "cols", "dt", "data"].contains(&&*text);
                if is_key {
                    inner = Some(text.into_owned());
                    continue;
                }
                if inner.as_deref().is_none_or(|key| key == "data") {
                    let kept = values.entry(name.clone()).or_default();
                    if kept.len() < MOST {
                        kept.push(text.into_owned());
                    }
                }
                if depth == 1 {
                    outer = None;
                }
            }
            _ => {}
        }
    }
    Ok(values)
}
