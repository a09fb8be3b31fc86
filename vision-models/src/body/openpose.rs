//! The JSON that OpenPose writes.

mod body_25b;
mod bounded;

use nalgebra::Point2;
use serde::Deserialize;
use serde_json::value::RawValue;

use self::{body_25b::body_of_25, bounded::Bounded};
use super::{
    image_body::{ImageBody, ImageKeypoint},
    keypoints::Body25,
};
use crate::confidence::Confidence;
use crate::error::Error;
use crate::excerpt::Excerpt;

/// Largest text that is read (bytes).
const LARGEST: usize = 16 << 20;

/// Largest coordinate in an image (pixels).
const FARTHEST: f64 = 1e5;

/// Other models: how many numbers a person has, and what to do.
const OTHERS: [(usize, &str); 3] = [
    (45, "the 15 joints of MPI: run OpenPose with --model_pose BODY_25 or COCO"),
    (51, "the 17 joints of COCO without a neck: reorder them by ImageBody::from_coco_17"),
    (405, "the 135 joints of BODY_135: run OpenPose with --model_pose BODY_25"),
];

/// Smallest number of joints from which scaled coordinates are recognised.
const FEW: usize = 3;

/// Largest length of a person's array. No model needs more numbers.
const NUMBERS: usize = 512;

#[derive(Deserialize)]
struct File<'a> {
    #[serde(borrow)]
    people: Bounded<'a, { ImageBody::MAX_PEOPLE }>,
}

/// A person. Versions of OpenPose before 1.3 leave `_2d` out.
#[derive(Deserialize)]
struct Person<'a> {
    #[serde(borrow)]
    pose_keypoints_2d: Option<&'a RawValue>,
    #[serde(borrow)]
    pose_keypoints: Option<&'a RawValue>,
}

impl ImageBody {
    /// Largest number of people that are read from one image.
    pub const MAX_PEOPLE: usize = 64;

    /// Reads the JSON that `OpenPose` writes for an image (`--write_json`, keypoints in pixels).
    /// Returns one body for each person.
    ///
    /// The number of joints identifies COCO-18. BODY_25 and BODY_25B have equally many joints. The
    /// positions of neck and mid hip tell them apart. A joint of confidence 0 was not seen.
    /// Confidences above 1 count as 1. Reading takes at most five times the text's size and 64 KiB
    /// of memory.
    ///
    /// ```
    /// use vision_models::{Body25, ImageBody};
    ///
    /// let nothing = "0,0,0,".repeat(24);
    /// let json = format!(r#"{{"people":[{{"pose_keypoints_2d":[{nothing}5,6,0.7]}}]}}"#);
    /// let people = ImageBody::from_openpose(json.as_bytes())?;
    /// assert_eq!(people.len(), 1);
    /// let heel = people[0].get(Body25::RightHeel).expect("seen");
    /// assert_eq!((heel.position.x, heel.confidence.value()), (5.0, 0.7));
    /// # Ok::<(), vision_models::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Malformed`] if the text is not such JSON. The error names the person and the wrong
    /// number. In the case of other models it says how to export the right one.
    pub fn from_openpose(json: &[u8]) -> Result<Vec<Self>, Error> {
        if json.len() > LARGEST {
            return Err(refuse(&format!("{} bytes, at most {LARGEST} are read", json.len())));
        }
        let File { people } = serde_json::from_slice(json)
            .map_err(|error| refuse(&Excerpt(&error.to_string()).to_string()))?;
        if people.count > Self::MAX_PEOPLE {
            let (found, most) = (people.count, Self::MAX_PEOPLE);
            return Err(refuse(&format!("{found} people, at most {most} are read")));
        }
        people.first.iter().enumerate().map(|(index, text)| person(index, text)).collect()
    }
}

fn person(index: usize, text: &RawValue) -> Result<ImageBody, Error> {
    let refuse = |problem: &str| refuse(&format!("person {index} (from 0) has {problem}"));
    let numbers = serde_json::from_str(text.get())
        .ok()
        .and_then(|Person { pose_keypoints_2d, pose_keypoints }| {
            pose_keypoints_2d.or(pose_keypoints)
        })
        .and_then(|text| serde_json::from_str::<Bounded<'_, NUMBERS>>(text.get()).ok())
        .ok_or_else(|| refuse("no array \"pose_keypoints_2d\""))?;
    let mut keypoints = [None; Body25::COUNT];
    let joints = numbers.first.as_chunks::<3>();
    let count = numbers.count;
    if ![75, 54].contains(&count) {
        let known = OTHERS.iter().find(|(numbers, _)| *numbers == count);
        let other = known.map_or(String::new(), |(_, what)| format!(", {what}"));
        return Err(refuse(&format!("{count} numbers{other}")));
    }
    for (joint, (values, slot)) in joints.0.iter().zip(&mut keypoints).enumerate() {
        *slot = keypoint(values)
            .map_err(|what| refuse(&format!("{what} as keypoint {joint} (from 0)")))?;
    }
    if is_scaled(&keypoints) {
        return Err(refuse(
            "joints from 0 to 1, which are no pixels: run OpenPose with --keypoint_scale 0",
        ));
    }
    Ok(match keypoints.first_chunk::<18>() {
        Some(coco) if count == 54 => ImageBody::from_coco_18(*coco),
        _ => body_of_25(&keypoints),
    })
}

/// Returns true if joints were scaled to the image's size. They lie in 0 to 1 with
/// `--keypoint_scale` 3, and in −1 to 1 with 4.
fn is_scaled(keypoints: &[Option<ImageKeypoint>]) -> bool {
    let mut seen = keypoints.iter().flatten().map(|keypoint| keypoint.position).peekable();
    let first = seen.peek().copied();
    let (mut count, mut differs) = (0, false);
    let within = seen.all(|position| {
        count += 1;
        differs |= Some(position) != first;
        position.iter().all(|coordinate| coordinate.abs() <= 1.0)
    });
    within && differs && count >= FEW
}

/// Returns a joint, or `None` if it was not seen. The error is the joint's text.
fn keypoint(values: &[&RawValue; 3]) -> Result<Option<ImageKeypoint>, String> {
    let shown = || {
        let [x, y, c] = values.map(|value| Excerpt(value.get()));
        format!("{x}, {y}, {c}")
    };
    let number = |value: &RawValue| serde_json::from_str::<f64>(value.get()).ok();
    let [Some(x), Some(y), Some(confidence)] = values.map(number) else {
        return Err(shown());
    };
    if confidence == 0.0 {
        return Ok(None);
    }
    if !(x.abs() <= FARTHEST && y.abs() <= FARTHEST) {
        return Err(shown());
    }
    let confidence = Confidence::new(confidence.min(1.0)).map_err(|_| shown())?;
    Ok(Some(ImageKeypoint { position: Point2::new(x, y), confidence }))
}

fn refuse(problem: &str) -> Error {
    let wanted = "give an object with \"people\", each with \"pose_keypoints_2d\" of 75 (BODY_25) or 54 \
                  (COCO-18) numbers x, y, confidence";
    Error::malformed("no OpenPose JSON", format!("{problem}; {wanted}"))
}
