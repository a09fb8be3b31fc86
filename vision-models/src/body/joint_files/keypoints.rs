//! Joints in pixels.

use nalgebra::Point2;
use serde_json::value::RawValue;

use crate::body::{ImageBody, ImageKeypoint, JointLayout};
use crate::confidence::Confidence;
use crate::excerpt::Excerpt;

/// No layout has so many keypoints.
pub(super) const KEYPOINTS: usize = 140;

/// Pixels beyond this are in no image.
const FARTHEST: f64 = 1e5;

/// The body of keypoints whose layout their number tells.
pub(super) fn body(keypoints: &[Option<ImageKeypoint>]) -> Result<ImageBody, String> {
    let count = keypoints.len();
    let known = JointLayout::of_count(count).map(|layout| layout.body(keypoints));
    known.ok_or_else(|| {
        let known =
            JointLayout::all().map(|layout| format!("{} has {}", layout.name(), layout.count()));
        format!("{count} joints: {}", known.collect::<Vec<_>>().join(", "))
    })
}

/// A joint, if it was seen; else what stands there.
pub(super) fn keypoint(
    joint: usize,
    [x, y]: [&RawValue; 2],
    confidence: &RawValue,
) -> Result<Option<ImageKeypoint>, String> {
    let refused = || {
        let [x, y, confidence] = [x, y, confidence].map(|value| Excerpt(value.get()));
        format!("{x}, {y}, {confidence} as keypoint {joint} (from 0)")
    };
    let number = |value: &RawValue| serde_json::from_str::<f64>(value.get()).ok();
    let [Some(x), Some(y), Some(confidence)] = [x, y, confidence].map(number) else {
        return Err(refused());
    };
    if confidence == 0.0 {
        return Ok(None);
    }
    if !(x.abs() <= FARTHEST && y.abs() <= FARTHEST) {
        return Err(refused());
    }
    let confidence = Confidence::new(confidence.min(1.0)).map_err(|_| refused())?;
    Ok(Some(ImageKeypoint { position: Point2::new(x, y), confidence }))
}
