//! The people in OpenPose's files, and in those that look like them.

use serde::Deserialize;
use serde_json::value::RawValue;

use super::{
    arrays::Bounded,
    body_25b::body_of_25,
    keypoints::{KEYPOINTS, body, keypoint},
    listed, refuse,
};
use crate::body::{ImageKeypoint, ObservedBody};

use crate::error::Error;

/// Least number of joints by which it is told that they are scaled.
const FEW: usize = 3;

/// A person: versions of OpenPose before 1.3 leave `_2d` out.
#[derive(Deserialize)]
struct Person<'a> {
    #[serde(borrow)]
    pose_keypoints_2d: Option<&'a RawValue>,
    #[serde(borrow)]
    pose_keypoints: Option<&'a RawValue>,
}

pub(super) fn people(list: &RawValue) -> Result<Vec<ObservedBody>, Error> {
    listed(list)?.into_iter().enumerate().map(|(index, text)| person(index, text)).collect()
}

fn person(index: usize, text: &RawValue) -> Result<ObservedBody, Error> {
    let refuse = |problem: &str| refuse(&format!("person {index} (from 0) has {problem}"));
    let numbers = serde_json::from_str(text.get())
        .ok()
        .and_then(|Person { pose_keypoints_2d, pose_keypoints }| {
            pose_keypoints_2d.or(pose_keypoints)
        })
        .ok_or_else(|| refuse("no array \"pose_keypoints_2d\""))?;
    of_triples(numbers).map_err(|problem| refuse(&problem))
}

/// A person of numbers x, y, confidence.
pub(super) fn of_triples(numbers: &RawValue) -> Result<ObservedBody, String> {
    let numbers: Bounded<'_, { 3 * KEYPOINTS }> =
        serde_json::from_str(numbers.get()).map_err(|_| "no array of numbers".to_owned())?;
    if !numbers.count.is_multiple_of(3) || numbers.count > 3 * KEYPOINTS {
        return Err(format!("{} numbers, which are no x, y, confidence", numbers.count));
    }
    let joints = numbers.first.as_chunks::<3>().0.iter().enumerate();
    let keypoints = joints.map(|(joint, [x, y, confidence])| keypoint(joint, [x, y], confidence));
    let keypoints = keypoints.collect::<Result<Vec<_>, _>>()?;
    if is_scaled(&keypoints) {
        return Err(
            "joints from 0 to 1, which are no pixels: run OpenPose with --keypoint_scale 0".into(),
        );
    }
    let image = match keypoints.first_chunk() {
        Some(all) if keypoints.len() == all.len() => body_of_25(all),
        _ => body(&keypoints)?,
    };
    Ok(ObservedBody { image, metric: None })
}
/// True if joints were scaled to the image's size: with `--keypoint_scale` 3 they lie in 0 to 1, with 4 in −1 to 1.
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
