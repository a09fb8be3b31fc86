//! MediaPipe's landmarks, as its programs and their users write them.

use nalgebra::{Point2, Point3};
use serde::Deserialize;
use serde_json::value::RawValue;

use super::{arrays::Bounded, listed, of_syntax, refuse};
use crate::body::{ImageKeypoint, JointLayout, ObservedBody};
use crate::confidence::Confidence;
use crate::error::Error;
use crate::excerpt::Excerpt;

/// Landmarks of a person.
const COUNT: usize = 33;

/// Landmarks farther out are no parts of an image's width and height.
const FARTHEST: f64 = 4.0;

/// A landmark, as its message in JSON is; what it leaves out is certain.
#[derive(Deserialize)]
struct Named {
    x: f64,
    y: f64,
    #[serde(default)]
    z: f64,
    visibility: Option<f64>,
    presence: Option<f64>,
}

/// The message around landmarks.
#[derive(Deserialize)]
struct Message<'a> {
    #[serde(borrow, alias = "landmarks")]
    landmark: &'a RawValue,
}

#[derive(Clone, Copy)]
struct Mark {
    place: Point3<f64>,
    confidence: Confidence,
}

/// True if a text is the array of one person's landmarks.
pub(super) fn is_person(text: &RawValue) -> bool {
    let first = serde_json::from_str::<Bounded<'_, 1>>(text.get()).ok();
    let first = first.and_then(|array| array.first.first().copied());
    let is_number = |text: &RawValue| serde_json::from_str::<f64>(text.get()).is_ok();
    first.is_some_and(|first| match serde_json::from_str::<Bounded<'_, 1>>(first.get()) {
        Ok(array) => array.first.first().is_some_and(|number| is_number(number)),
        Err(_) => serde_json::from_str::<Named>(first.get()).is_ok(),
    })
}

/// The people of landmarks in the image and in metres; either may be missing.
pub(super) fn people(
    image: Option<&RawValue>,
    world: Option<&RawValue>,
    size: Option<[usize; 2]>,
) -> Result<Vec<ObservedBody>, Error> {
    let [image, world] = [image, world].map(|text| text.map_or(Ok(Vec::new()), marks));
    let (image, world) = (image?, world?);
    if !(image.is_empty() || world.is_empty() || image.len() == world.len()) {
        let [image, world] = [image.len(), world.len()];
        return Err(refuse(&format!("{image} people in the image and {world} in metres")));
    }
    let mut people = vec![ObservedBody::default(); image.len().max(world.len())];
    for (person, marks) in people.iter_mut().zip(&image) {
        let [columns, rows] = pixels(marks, size)?;
        let keypoint = |mark: &Mark| {
            let position = Point2::new(columns * mark.place.x, rows * mark.place.y);
            Some(ImageKeypoint { position, confidence: mark.confidence })
        };
        let keypoints: Vec<_> = marks.iter().map(keypoint).collect();
        person.image = JointLayout::BlazePose.body(&keypoints);
    }
    for (person, marks) in people.iter_mut().zip(&world) {
        let points: Vec<_> = marks.iter().map(|mark| Some(mark.place)).collect();
        person.metric = Some(JointLayout::BlazePose.metric(&points));
    }
    Ok(people)
}

/// Unit of landmarks in the image (pixels): the image's sides, or one where they are pixels already.
fn pixels(marks: &[Mark], size: Option<[usize; 2]>) -> Result<[f64; 2], Error> {
    let is_part = |mark: &Mark| mark.place.xy().iter().all(|part| part.abs() <= FARTHEST);
    match size {
        _ if !marks.iter().all(is_part) => Ok([1.0; 2]),
        Some(size) => Ok(size.map(|side| side as f64)),
        None => Err(refuse(
            "landmarks that are parts of the image's sides, and nobody says how large it is: give its size",
        )),
    }
}

/// The landmarks of each person.
fn marks(text: &RawValue) -> Result<Vec<Vec<Mark>>, Error> {
    match text.get().as_bytes().first() {
        Some(b'n') => Ok(Vec::new()),
        Some(b'{') => Ok(vec![person(text)?]),
        _ if is_person(text) => Ok(vec![person(text)?]),
        _ => listed(text)?.into_iter().map(person).collect(),
    }
}

fn person(text: &RawValue) -> Result<Vec<Mark>, Error> {
    let text = match text.get().as_bytes().first() {
        Some(b'{') => {
            let message: Message<'_> =
                serde_json::from_str(text.get()).map_err(|error| of_syntax(&error))?;
            message.landmark
        }
        _ => text,
    };
    let all: Bounded<'_, COUNT> =
        serde_json::from_str(text.get()).map_err(|error| of_syntax(&error))?;
    if all.count != COUNT {
        return Err(refuse(&format!("{} landmarks of a person, not {COUNT}", all.count)));
    }
    all.first.into_iter().enumerate().map(|(index, text)| mark(index, text)).collect()
}

/// A landmark: an object, or an array x, y, z and perhaps visibility and presence.
fn mark(index: usize, text: &RawValue) -> Result<Mark, Error> {
    let refused = || refuse(&format!("{} as landmark {index} (from 0)", Excerpt(text.get())));
    let named = serde_json::from_str(text.get()).ok().or_else(|| {
        let numbers: Bounded<'_, 5> = serde_json::from_str(text.get()).ok()?;
        let number = |text: &&RawValue| serde_json::from_str::<f64>(text.get()).ok();
        let numbers: Vec<_> = numbers.first.iter().map_while(number).collect();
        let [x, y, z, ref more @ ..] = numbers[..] else { return None };
        Some(Named { x, y, z, visibility: more.first().copied(), presence: more.get(1).copied() })
    });
    let Named { x, y, z, visibility, presence } = named.ok_or_else(refused)?;
    let place = Point3::new(x, y, z);
    if !place.iter().all(|coordinate| coordinate.abs() <= 1e5) {
        return Err(refused());
    }
    let sure = visibility.unwrap_or(1.0).min(presence.unwrap_or(1.0));
    let confidence = Confidence::new(sure.min(1.0)).map_err(|_| refused())?;
    Ok(Mark { place, confidence })
}
