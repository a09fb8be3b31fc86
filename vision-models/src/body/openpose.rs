//! The JSON that OpenPose writes.

use nalgebra::Point2;
use serde::Deserialize;
use serde_json::Value;

use super::{
    image_body::{ImageBody, ImageKeypoint},
    keypoints::Body25,
};
use crate::{Confidence, Error, error::Excerpt};

/// The largest text that is read (bytes).
const LARGEST: usize = 16 << 20;

/// Pixels beyond this are in no image.
const FARTHEST: f64 = 1e5;

/// Of other models, how many numbers a person has, and what to do.
const OTHERS: [(usize, &str); 3] = [
    (45, "the 15 joints of MPI: run OpenPose with --model_pose BODY_25 or COCO"),
    (51, "the 17 joints of COCO without a neck: reorder them by ImageBody::from_coco_17"),
    (405, "the 135 joints of BODY_135: run OpenPose with --model_pose BODY_25"),
];

#[derive(Deserialize)]
struct File {
    people: Vec<Value>,
}

impl ImageBody {
    /// The most people that are read of one image.
    pub const MAX_PEOPLE: usize = 64;

    /// Reads the JSON that `OpenPose` writes for an image (`--write_json`, keypoints in pixels): one
    /// body a person, BODY_25 or COCO-18 by the number of joints. A joint of zeros was not seen.
    /// Confidences above 1 count as 1.
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
    /// [`Error::OpenPose`] for what is no such JSON: with the person and the number that is wrong,
    /// and for other models with what would be right.
    pub fn from_openpose(json: &[u8]) -> Result<Vec<Self>, Error> {
        if json.len() > LARGEST {
            return Err(refuse(format!("{} bytes, at most {LARGEST} are read", json.len())));
        }
        let File { people } = serde_json::from_slice(json)
            .map_err(|error| refuse(Excerpt(&error.to_string()).to_string()))?;
        if people.len() > Self::MAX_PEOPLE {
            let (found, most) = (people.len(), Self::MAX_PEOPLE);
            return Err(refuse(format!("{found} people, at most {most} are read")));
        }
        people.iter().enumerate().map(|(index, value)| person(index, value)).collect()
    }
}

fn person(index: usize, value: &Value) -> Result<ImageBody, Error> {
    let refuse = |problem: &str| refuse(format!("person {index} (from 0) has {problem}"));
    let numbers = value
        .get("pose_keypoints_2d")
        .or_else(|| value.get("pose_keypoints"))
        .and_then(Value::as_array)
        .ok_or_else(|| refuse("no array \"pose_keypoints_2d\""))?;
    let mut keypoints = [None; Body25::COUNT];
    let joints = numbers.as_chunks::<3>();
    let count = numbers.len();
    if ![75, 54].contains(&count) {
        let known = OTHERS.iter().find(|(numbers, _)| *numbers == count);
        let other = known.map_or(String::new(), |(_, what)| format!(", {what}"));
        return Err(refuse(&format!("{count} numbers{other}")));
    }
    for (joint, (values, slot)) in joints.0.iter().zip(&mut keypoints).enumerate() {
        *slot = keypoint(values)
            .map_err(|what| refuse(&format!("{what} as keypoint {joint} (from 0)")))?;
    }
    Ok(match keypoints.first_chunk::<18>() {
        Some(coco) if count == 54 => ImageBody::from_coco_18(*coco),
        _ => ImageBody::new(keypoints),
    })
}

/// A joint, if it was seen; else what stands there.
fn keypoint(values: &[Value; 3]) -> Result<Option<ImageKeypoint>, String> {
    let shown = || {
        let [x, y, c] = values;
        Excerpt(&format!("{x}, {y}, {c}")).to_string()
    };
    let [Some(x), Some(y), Some(confidence)] = values.each_ref().map(Value::as_f64) else {
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

fn refuse(problem: String) -> Error {
    Error::OpenPose { problem }
}
