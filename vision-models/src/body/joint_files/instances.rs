//! The people in files of mmpose, COCO and AlphaPose.

use serde::Deserialize;
use serde_json::value::RawValue;

use super::{
    arrays::Bounded,
    keypoints::{KEYPOINTS, body, keypoint},
    listed, of_syntax, openpose, refuse,
};
use crate::body::ObservedBody;
use crate::error::Error;

#[derive(Deserialize)]
struct Instance<'a> {
    #[serde(borrow)]
    keypoints: &'a RawValue,
    #[serde(borrow)]
    keypoint_scores: Option<&'a RawValue>,
}

/// The instances of an image.
pub(super) fn people(list: &RawValue) -> Result<Vec<ObservedBody>, Error> {
    let read = |text: &RawValue| {
        let Instance { keypoints, keypoint_scores } =
            serde_json::from_str(text.get()).map_err(|error| of_syntax(&error))?;
        person(keypoints, keypoint_scores)
    };
    listed(list)?.into_iter().map(read).collect()
}

/// A person: pairs x, y with scores beside them, as mmpose writes them; or numbers x, y, confidence, as COCO's are.
pub(super) fn person(
    keypoints: &RawValue,
    scores: Option<&RawValue>,
) -> Result<ObservedBody, Error> {
    let refuse = |problem: String| refuse(&format!("\"keypoints\" of {problem}"));
    let Some(scores) = scores else {
        return openpose::of_triples(keypoints).map_err(refuse);
    };
    let read = |error: serde_json::Error| of_syntax(&error);
    let places: Bounded<'_, KEYPOINTS> = serde_json::from_str(keypoints.get()).map_err(read)?;
    let scores: Bounded<'_, KEYPOINTS> = serde_json::from_str(scores.get()).map_err(read)?;
    if places.count != scores.count || places.count > KEYPOINTS {
        let [places, scores] = [places.count, scores.count];
        return Err(refuse(format!("{places} places and {scores} scores")));
    }
    let joints = places.first.iter().zip(&scores.first).enumerate();
    let keypoints = joints.map(|(joint, (place, score))| {
        let pair: Bounded<'_, 2> = serde_json::from_str(place.get())
            .map_err(|_| format!("no pair as keypoint {joint} (from 0)"))?;
        match pair.first[..] {
            [x, y] => keypoint(joint, [x, y], score),
            _ => Err(format!("no pair as keypoint {joint} (from 0)")),
        }
    });
    let keypoints = keypoints.collect::<Result<Vec<_>, _>>().map_err(refuse)?;
    let image = body(&keypoints).map_err(refuse)?;
    Ok(ObservedBody { image, metric: None })
}
