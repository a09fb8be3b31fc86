//! A person's joints in one image.

use nalgebra::{Point2, center};

use super::keypoints::Body25;
use crate::confidence::Confidence;

/// One joint in an image.
///
/// ```
/// use nalgebra::Point2;
/// use vision_models::{Confidence, ImageKeypoint};
///
/// let wrist = ImageKeypoint { position: Point2::new(310.5, 242.0), confidence: Confidence::new(0.8)? };
/// assert_eq!(wrist.position.x, 310.5);
/// # Ok::<(), vision_models::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImageKeypoint {
    /// Position in pixels, x to the right and y downwards from the centre of the pixel at the top
    /// left.
    pub position: Point2<f64>,
    /// The detector's confidence.
    pub confidence: Confidence,
}

impl ImageKeypoint {
    /// Returns the midpoint of two joints. Its confidence is the lower of the two.
    fn between(one: Option<Self>, other: Option<Self>) -> Option<Self> {
        let (one, other) = (one?, other?);
        let confidence = if one.confidence < other.confidence { one } else { other }.confidence;
        Some(Self { position: center(&one.position, &other.position), confidence })
    }
}

/// A person in one image: the position of each of the twenty-five joints that was seen. The default
/// has none.
///
/// ```
/// use nalgebra::Point2;
/// use vision_models::{Body25, Confidence, ImageBody, ImageKeypoint};
///
/// let at = |x: f64, y: f64| {
///     Some(ImageKeypoint { position: Point2::new(x, y), confidence: Confidence::ONE })
/// };
/// // COCO's order: shoulders are joints 5 (left) and 6 (right).
/// let mut coco = [None; 17];
/// coco[5] = at(120.0, 80.0);
/// coco[6] = at(80.0, 84.0);
/// let body = ImageBody::from_coco_17(coco);
/// assert_eq!(body.get(Body25::LeftShoulder), at(120.0, 80.0));
/// assert_eq!(body.get(Body25::Neck), at(100.0, 82.0));
/// assert_eq!(body.iter().count(), 3);
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ImageBody {
    keypoints: [Option<ImageKeypoint>; Body25::COUNT],
}

/// COCO's seventeen joints in their order.
const COCO_17: [Body25; 17] = [
    Body25::Nose,
    Body25::LeftEye,
    Body25::RightEye,
    Body25::LeftEar,
    Body25::RightEar,
    Body25::LeftShoulder,
    Body25::RightShoulder,
    Body25::LeftElbow,
    Body25::RightElbow,
    Body25::LeftWrist,
    Body25::RightWrist,
    Body25::LeftHip,
    Body25::RightHip,
    Body25::LeftKnee,
    Body25::RightKnee,
    Body25::LeftAnkle,
    Body25::RightAnkle,
];

/// The joints of `OpenPose`'s BODY_25B in their order. Joints 17 and 18, the upper neck and the top
/// of the head, are not part of BODY_25.
const BODY_25B: [Option<Body25>; 25] = [
    Some(Body25::Nose),
    Some(Body25::LeftEye),
    Some(Body25::RightEye),
    Some(Body25::LeftEar),
    Some(Body25::RightEar),
    Some(Body25::LeftShoulder),
    Some(Body25::RightShoulder),
    Some(Body25::LeftElbow),
    Some(Body25::RightElbow),
    Some(Body25::LeftWrist),
    Some(Body25::RightWrist),
    Some(Body25::LeftHip),
    Some(Body25::RightHip),
    Some(Body25::LeftKnee),
    Some(Body25::RightKnee),
    Some(Body25::LeftAnkle),
    Some(Body25::RightAnkle),
    None,
    None,
    Some(Body25::LeftBigToe),
    Some(Body25::LeftSmallToe),
    Some(Body25::LeftHeel),
    Some(Body25::RightBigToe),
    Some(Body25::RightSmallToe),
    Some(Body25::RightHeel),
];

/// The eighteen joints of `OpenPose`'s COCO model in their order.
const COCO_18: [Body25; 18] = [
    Body25::Nose,
    Body25::Neck,
    Body25::RightShoulder,
    Body25::RightElbow,
    Body25::RightWrist,
    Body25::LeftShoulder,
    Body25::LeftElbow,
    Body25::LeftWrist,
    Body25::RightHip,
    Body25::RightKnee,
    Body25::RightAnkle,
    Body25::LeftHip,
    Body25::LeftKnee,
    Body25::LeftAnkle,
    Body25::RightEye,
    Body25::LeftEye,
    Body25::RightEar,
    Body25::LeftEar,
];

impl ImageBody {
    /// Creates a body from its keypoints in the order of [`Body25::ALL`].
    pub fn new(keypoints: [Option<ImageKeypoint>; Body25::COUNT]) -> Self {
        Self { keypoints }
    }

    /// Creates a body from COCO's seventeen joints (nose, eyes, ears, shoulders, elbows, wrists,
    /// hips, knees, ankles, left before right). Neck and mid hip are the midpoints of shoulders and
    /// hips.
    pub fn from_coco_17(keypoints: [Option<ImageKeypoint>; 17]) -> Self {
        let mut body = Self::placed(&COCO_17, &keypoints);
        body.set_middles();
        body
    }

    /// Creates a body from the eighteen joints of `OpenPose`'s COCO model (nose, neck, arms, legs,
    /// eyes, ears, right before left). Mid hip is the midpoint of the hips.
    pub fn from_coco_18(keypoints: [Option<ImageKeypoint>; 18]) -> Self {
        let mut body = Self::placed(&COCO_18, &keypoints);
        body.set_middle(Body25::MidHip, Body25::LeftHip, Body25::RightHip);
        body
    }

    /// Creates a body from the joints of `OpenPose`'s BODY_25B, which has the eyes where BODY_25
    /// has the neck. Neck and mid hip are the midpoints of shoulders and hips. Upper neck and top
    /// of the head are left out.
    pub fn from_body_25b(keypoints: [Option<ImageKeypoint>; 25]) -> Self {
        let mut body = Self::default();
        for (joint, keypoint) in BODY_25B.into_iter().zip(keypoints) {
            if let Some(joint) = joint {
                body.set(joint, keypoint);
            }
        }
        body.set_middles();
        body
    }

    fn placed(joints: &[Body25], keypoints: &[Option<ImageKeypoint>]) -> Self {
        let mut body = Self::default();
        for (&joint, &keypoint) in joints.iter().zip(keypoints) {
            body.set(joint, keypoint);
        }
        body
    }

    /// Sets neck and mid hip to the midpoints of shoulders and hips.
    pub(crate) fn set_middles(&mut self) {
        self.set_middle(Body25::Neck, Body25::LeftShoulder, Body25::RightShoulder);
        self.set_middle(Body25::MidHip, Body25::LeftHip, Body25::RightHip);
    }

    fn set_middle(&mut self, joint: Body25, one: Body25, other: Body25) {
        self.set(joint, ImageKeypoint::between(self.get(one), self.get(other)));
    }

    /// Returns the joint if it was seen.
    pub fn get(&self, joint: Body25) -> Option<ImageKeypoint> {
        self.keypoints[joint.index()]
    }

    /// Sets a joint, or removes it.
    pub fn set(&mut self, joint: Body25, keypoint: Option<ImageKeypoint>) {
        self.keypoints[joint.index()] = keypoint;
    }

    /// Returns the keypoints in the order of [`Body25::ALL`].
    pub fn keypoints(&self) -> &[Option<ImageKeypoint>; Body25::COUNT] {
        &self.keypoints
    }

    /// Returns the joints that were seen.
    pub fn iter(&self) -> impl Iterator<Item = (Body25, ImageKeypoint)> + '_ {
        Body25::ALL
            .into_iter()
            .zip(&self.keypoints)
            .filter_map(|(joint, keypoint)| keypoint.map(|keypoint| (joint, keypoint)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn keypoint(x: f64, confidence: f64) -> Option<ImageKeypoint> {
        let confidence = Confidence::new(confidence).ok()?;
        Some(ImageKeypoint { position: Point2::new(x, -x), confidence })
    }

    /// OpenPose's two models share the order of the first eight joints only.
    #[test]
    fn coco_18_has_its_own_order() {
        let mut coco = [None; 18];
        for (x, joint) in (0..).zip(&mut coco) {
            *joint = keypoint(f64::from(x), 0.5);
        }
        let body = ImageBody::from_coco_18(coco);
        for joint in Body25::ALL.into_iter().take(8) {
            assert_eq!(body.get(joint), coco[joint.index()]);
        }
        assert_eq!(body.get(Body25::RightHip), coco[8]);
        assert_eq!(body.get(Body25::LeftAnkle), coco[13]);
        assert_eq!(body.get(Body25::LeftEar), coco[17]);
        assert_eq!(body.get(Body25::MidHip), keypoint(9.5, 0.5));
        assert_eq!(body.get(Body25::LeftHeel), None);
    }

    #[test]
    fn a_midpoint_needs_both_joints() {
        let mut coco = [None; 17];
        coco[11] = keypoint(4.0, 0.9);
        assert_eq!(ImageBody::from_coco_17(coco).get(Body25::MidHip), None);
        coco[12] = keypoint(6.0, 0.2);
        assert_eq!(ImageBody::from_coco_17(coco).get(Body25::MidHip), keypoint(5.0, 0.2));
    }
}
