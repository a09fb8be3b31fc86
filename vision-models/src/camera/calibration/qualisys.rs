//! Qualisys' `.qca.txt`.
//!
//! Focal lengths and centres are in 64ths of a pixel. Factors of distortion belong to positions in
//! focal lengths, as OpenCV's do. They have no unit, so that nothing scales them.

use nalgebra::{Matrix3, Vector3};
use quick_xml::{
    Reader,
    events::{BytesStart, Event},
};

use super::{
    CalibratedCamera,
    pose::{pose, refuse},
};
use crate::camera::{Distortion, Intrinsics};
use crate::error::Error;
use crate::excerpt::Excerpt;

/// Parts of a pixel.
const PARTS: f64 = 64.0;
/// Metres.
const MILLIMETRE: f64 = 1e-3;

/// The elements of a camera that are read.
const ELEMENTS: [&str; 3] = ["fov_video", "transform", "intrinsic"];

/// A camera and the elements in it, as far as they were read.
struct Found<'a> {
    name: String,
    is_video: bool,
    elements: [Option<BytesStart<'a>>; 3],
}

/// The cameras for video in the order of the file; all cameras if none is for video.
pub(super) fn cameras(text: &str) -> Result<Vec<CalibratedCamera>, Error> {
    let mut reader = Reader::from_str(text);
    let mut found: Vec<Found<'_>> = Vec::new();
    loop {
        let start = match reader.read_event().map_err(|error| refuse(error.to_string()))? {
            Event::Start(start) | Event::Empty(start) => start,
            Event::Eof => break,
            _ => continue,
        };
        let element = start.name();
        if element.as_ref() == b"camera" {
            found.push(camera(&start)?);
        } else if let Some(index) =
            ELEMENTS.iter().position(|name| name.as_bytes() == element.as_ref())
            && let Some(last) = found.last_mut()
        {
            last.elements[index] = Some(start);
        }
    }
    if found.is_empty() {
        return Err(refuse("XML without a <camera>: give the .qca.txt of Qualisys"));
    }
    let any_video = found.iter().any(|camera| camera.is_video);
    found.iter().filter(|camera| camera.is_video || !any_video).map(Found::calibrated).collect()
}

fn camera<'a>(start: &BytesStart<'a>) -> Result<Found<'a>, Error> {
    let text = |name| text(start, name);
    let name = text("serial")?.unwrap_or_default();
    let model = text("model")?.unwrap_or_default().to_lowercase();
    let turned = text("viewrotation")?.filter(|turn| turn.trim() != "0");
    if let Some(turned) = turned {
        let turned = Excerpt(&turned);
        return Err(refuse(format!(
            "the view of camera {name} is rotated by {turned} degrees: calibrate without, and do not turn the film"
        )));
    }
    let is_video = ["video", "none"].iter().any(|kind| model.contains(kind));
    Ok(Found { name, is_video, elements: [None, None, None] })
}

impl Found<'_> {
    fn calibrated(&self) -> Result<CalibratedCamera, Error> {
        let number = |element: usize, name: &str| {
            let start = self.elements.get(element).and_then(Option::as_ref);
            let missing = || {
                let element = ELEMENTS.get(element).copied().unwrap_or_default();
                refuse(format!(
                    "camera {} lacks the number {name} of <{element}>",
                    Excerpt(&self.name)
                ))
            };
            let text = text(start.ok_or_else(missing)?, name)?;
            let number = text.and_then(|text| text.trim().parse::<f64>().ok());
            number.filter(|number| number.abs() < 1e9).ok_or_else(missing)
        };
        let view = |name| number(0, name);
        let [left, top, right, bottom] =
            [view("left")?, view("top")?, view("right")?, view("bottom")?];
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "is checked")]
        let size = [right - left, bottom - top].map(|side| (side + 1.0).round() as usize);
        let lens = |name| number(2, name);
        let focal = [lens("focalLengthU")? / PARTS, lens("focalLengthV")? / PARTS];
        let centre = [lens("centerPointU")? / PARTS - left, lens("centerPointV")? / PARTS - top];
        let mut factors = [0.0; 8];
        let names = [
            "radialDistortion1",
            "radialDistortion2",
            "tangentalDistortion1",
            "tangentalDistortion2",
            "radialDistortion3",
        ];
        for (factor, name) in factors.iter_mut().zip(names) {
            *factor = lens(name)?;
        }
        let place = |name| Ok::<_, Error>(number(1, name)? * MILLIMETRE);
        let place = Vector3::new(place("x")?, place("y")?, place("z")?);
        let mut rows = Matrix3::zeros();
        for (row, column) in (0..3).flat_map(|row| (0..3).map(move |column| (row, column))) {
            rows[(row, column)] = number(1, &format!("r{}{}", row + 1, column + 1))?;
        }
        // The file's camera looks along its own -z, y upwards, and its rows are the world's axes.
        let rotation = rows.transpose() * Matrix3::from_diagonal(&Vector3::new(1.0, -1.0, -1.0));
        Ok(CalibratedCamera {
            name: self.name.clone(),
            intrinsics: Intrinsics::new(size, focal, centre)?,
            distortion: Distortion::Radial(factors),
            world_from_camera: Some(pose(rotation, place)?),
        })
    }
}

/// An attribute.
fn text(start: &BytesStart<'_>, name: &str) -> Result<Option<String>, Error> {
    let attribute = start.try_get_attribute(name).map_err(|error| refuse(error.to_string()))?;
    Ok(attribute.map(|attribute| String::from_utf8_lossy(&attribute.value).into_owned()))
}
