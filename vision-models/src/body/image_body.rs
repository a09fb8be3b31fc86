//! A person's joints in one image.

use nalgebra::{Point2, center};

use super::{body_25::Body25, middle::Middle};
use crate::confidence::Confidence;

/// Joint of a person in an image.
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
/// let wrist = ImageKeypoint { position: Point2::new(310.5, 242.0), confidence: Confidence::ONE };
/// let mut body = ImageBody::default();
/// body.set(Body25::LeftWrist, Some(wrist));
/// assert_eq!(body.iter().next(), Some((Body25::LeftWrist, wrist)));
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ImageBody {
    keypoints: [Option<ImageKeypoint>; Body25::COUNT],
    /// True if a joint is the middle of others.
    derived: [bool; Body25::COUNT],
}

impl ImageBody {
    /// Creates a body from its keypoints in the order of [`Body25::ALL`].
    pub fn new(keypoints: [Option<ImageKeypoint>; Body25::COUNT]) -> Self {
        Self { keypoints, ..Self::default() }
    }

    /// Sets the joint in the middle of two others, if both were seen.
    pub(super) fn set_middle(&mut self, Middle { joint, sides: [one, other] }: Middle) {
        self.set(joint, ImageKeypoint::between(self.get(one), self.get(other)));
        self.derived[joint.index()] = true;
    }

    /// Returns true if the joint was set to the midpoint of two others, not seen itself.
    pub fn is_derived(&self, joint: Body25) -> bool {
        self.derived[joint.index()]
    }

    /// Returns the diagonal of the smallest rectangle around the joints that were seen (pixels).
    /// `None` if there are none.
    pub fn size(&self) -> Option<f64> {
        let seen = || self.iter().map(|(_, keypoint)| keypoint.position);
        let from = seen().reduce(|one, other| one.inf(&other))?;
        let to = seen().reduce(|one, other| one.sup(&other))?;
        Some((to - from).norm())
    }

    /// Returns the joint if it was seen.
    pub fn get(&self, joint: Body25) -> Option<ImageKeypoint> {
        self.keypoints[joint.index()]
    }

    /// Sets a joint, or removes it.
    pub fn set(&mut self, joint: Body25, keypoint: Option<ImageKeypoint>) {
        self.keypoints[joint.index()] = keypoint;
        self.derived[joint.index()] = false;
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
    use crate::body::JointLayout;

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
        let body = JointLayout::Coco18.body(&coco);
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
        assert_eq!(JointLayout::Coco17.body(&coco).get(Body25::MidHip), None);
        coco[12] = keypoint(6.0, 0.2);
        assert_eq!(JointLayout::Coco17.body(&coco).get(Body25::MidHip), keypoint(5.0, 0.2));
    }
}
