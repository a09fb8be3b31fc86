//! The orders in which pose networks and their files give joints.

use nalgebra::Point3;

use super::{
    body_25::Body25,
    image_body::{ImageBody, ImageKeypoint},
    middle::Middle,
    observed::MetricBody,
};

/// Order of the joints in the output of a pose network. A layout without a neck or a mid hip has
/// the midpoints of shoulders and hips there.
///
/// The orders are from the projects' own documentation: OpenPose's `doc/02_output.md` and `poseParameters.cpp`, COCO's
/// data format, the README of Halpe-FullBody, COCO-WholeBody, and MediaPipe's guide to its pose landmarks.
///
/// ```
/// use nalgebra::Point2;
/// use vision_models::{Body25, Confidence, ImageKeypoint, JointLayout};
///
/// let at = |x: f64, y: f64| {
///     Some(ImageKeypoint { position: Point2::new(x, y), confidence: Confidence::ONE })
/// };
/// // COCO's shoulders are joints 5 (left) and 6 (right).
/// let mut joints = [None; 17];
/// joints[5] = at(120.0, 80.0);
/// joints[6] = at(80.0, 84.0);
/// let body = JointLayout::Coco17.body(&joints);
/// assert_eq!(body.get(Body25::LeftShoulder), at(120.0, 80.0));
/// assert_eq!(body.get(Body25::Neck), at(100.0, 82.0));
/// assert!(body.is_derived(Body25::Neck));
/// assert_eq!(JointLayout::of_count(26), Some(JointLayout::Halpe26));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum JointLayout {
    /// OpenPose's BODY_25, the order of [`Body25`].
    Body25,
    /// OpenPose's experimental BODY_25B. Upper neck and top of the head are left out.
    Body25B,
    /// OpenPose's BODY_135: BODY_25B, then hands and face, which are left out.
    Body135,
    /// OpenPose's COCO model: COCO's joints and a neck.
    Coco18,
    /// OpenPose's MPI model. Its head and chest are left out.
    Mpi,
    /// COCO's seventeen joints, left before right.
    Coco17,
    /// Halpe's twenty-six joints of the body, as AlphaPose and RTMPose give them. The top of the head is left out.
    Halpe26,
    /// Halpe-FullBody: Halpe's twenty-six joints, then face and hands, which are left out.
    Halpe136,
    /// COCO-WholeBody: COCO's joints and six of the feet, then face and hands, which are left out.
    Coco133,
    /// MediaPipe's landmarks. Big toes are the tips of the feet; mouth and fingers are left out.
    BlazePose,
}

use Body25::{
    LeftAnkle, LeftBigToe, LeftEar, LeftElbow, LeftEye, LeftHeel, LeftHip, LeftKnee, LeftShoulder,
    LeftSmallToe, LeftWrist, MidHip, Neck, Nose, RightAnkle, RightBigToe, RightEar, RightElbow,
    RightEye, RightHeel, RightHip, RightKnee, RightShoulder, RightSmallToe, RightWrist,
};

/// COCO's joints by their places; other layouts begin so.
const COCO: [(Body25, usize); 17] = [
    (Nose, 0),
    (LeftEye, 1),
    (RightEye, 2),
    (LeftEar, 3),
    (RightEar, 4),
    (LeftShoulder, 5),
    (RightShoulder, 6),
    (LeftElbow, 7),
    (RightElbow, 8),
    (LeftWrist, 9),
    (RightWrist, 10),
    (LeftHip, 11),
    (RightHip, 12),
    (LeftKnee, 13),
    (RightKnee, 14),
    (LeftAnkle, 15),
    (RightAnkle, 16),
];

/// Joints that follow COCO's in other layouts.
const FEET_25B: [(Body25, usize); 6] = [
    (LeftBigToe, 19),
    (LeftSmallToe, 20),
    (LeftHeel, 21),
    (RightBigToe, 22),
    (RightSmallToe, 23),
    (RightHeel, 24),
];
const FEET_133: [(Body25, usize); 6] = [
    (LeftBigToe, 17),
    (LeftSmallToe, 18),
    (LeftHeel, 19),
    (RightBigToe, 20),
    (RightSmallToe, 21),
    (RightHeel, 22),
];
const HALPE: [(Body25, usize); 8] = [
    (Neck, 18),
    (MidHip, 19),
    (LeftBigToe, 20),
    (RightBigToe, 21),
    (LeftSmallToe, 22),
    (RightSmallToe, 23),
    (LeftHeel, 24),
    (RightHeel, 25),
];

/// Neck and limbs in OpenPose's models of CMU: MPI has these alone.
const LIMBS: [(Body25, usize); 13] = [
    (Neck, 1),
    (RightShoulder, 2),
    (RightElbow, 3),
    (RightWrist, 4),
    (LeftShoulder, 5),
    (LeftElbow, 6),
    (LeftWrist, 7),
    (RightHip, 8),
    (RightKnee, 9),
    (RightAnkle, 10),
    (LeftHip, 11),
    (LeftKnee, 12),
    (LeftAnkle, 13),
];
const HEAD_18: [(Body25, usize); 5] =
    [(Nose, 0), (RightEye, 14), (LeftEye, 15), (RightEar, 16), (LeftEar, 17)];

const BLAZE_POSE: [(Body25, usize); 21] = [
    (Nose, 0),
    (LeftEye, 2),
    (RightEye, 5),
    (LeftEar, 7),
    (RightEar, 8),
    (LeftShoulder, 11),
    (RightShoulder, 12),
    (LeftElbow, 13),
    (RightElbow, 14),
    (LeftWrist, 15),
    (RightWrist, 16),
    (LeftHip, 23),
    (RightHip, 24),
    (LeftKnee, 25),
    (RightKnee, 26),
    (LeftAnkle, 27),
    (RightAnkle, 28),
    (LeftHeel, 29),
    (RightHeel, 30),
    (LeftBigToe, 31),
    (RightBigToe, 32),
];

/// BODY_25 itself.
const BODY_25: [(Body25, usize); Body25::COUNT] = {
    let mut joints = [(Nose, 0); Body25::COUNT];
    let mut place = 0;
    while place < Body25::COUNT {
        joints[place] = (Body25::ALL[place], place);
        place += 1;
    }
    joints
};

/// Facts about a layout.
#[derive(Debug)]
struct Row {
    layout: JointLayout,
    name: &'static str,
    count: usize,
    /// The joints of the body by their places, in two parts.
    joints: [&'static [(Body25, usize)]; 2],
}

const fn row(
    layout: JointLayout,
    name: &'static str,
    count: usize,
    joints: [&'static [(Body25, usize)]; 2],
) -> Row {
    Row { layout, name, count, joints }
}

/// Every layout, in the order of [`JointLayout`].
static TABLE: [Row; 10] = [
    row(JointLayout::Body25, "BODY_25", 25, [&BODY_25, &[]]),
    row(JointLayout::Body25B, "BODY_25B", 25, [&COCO, &FEET_25B]),
    row(JointLayout::Body135, "BODY_135", 135, [&COCO, &FEET_25B]),
    row(JointLayout::Coco18, "COCO-18", 18, [&LIMBS, &HEAD_18]),
    row(JointLayout::Mpi, "MPI", 15, [&LIMBS, &[]]),
    row(JointLayout::Coco17, "COCO-17", 17, [&COCO, &[]]),
    row(JointLayout::Halpe26, "Halpe-26", 26, [&COCO, &HALPE]),
    row(JointLayout::Halpe136, "Halpe-136", 136, [&COCO, &HALPE]),
    row(JointLayout::Coco133, "COCO-WholeBody", 133, [&COCO, &FEET_133]),
    row(JointLayout::BlazePose, "BlazePose", 33, [&BLAZE_POSE, &[]]),
];

impl JointLayout {
    /// Lists all layouts.
    pub fn all() -> impl Iterator<Item = Self> {
        TABLE.iter().map(|row| row.layout)
    }

    /// Returns the layout with this number of joints: BODY_25 for twenty-five, not BODY_25B.
    pub fn of_count(count: usize) -> Option<Self> {
        Self::all().find(|layout| layout.count() == count)
    }

    fn row(self) -> &'static Row {
        &TABLE[self as usize]
    }

    /// Returns the number of joints.
    pub fn count(self) -> usize {
        self.row().count
    }

    /// Returns the name that the layout's own project uses.
    pub fn name(self) -> &'static str {
        self.row().name
    }

    /// Returns the joints of [`Body25`] in the layout, each with its index there. Other points of
    /// the layout are left out.
    pub fn joints(self) -> impl Iterator<Item = (Body25, usize)> {
        self.row().joints.into_iter().flatten().copied()
    }

    /// Returns a person's joints in an image from keypoints in this order. Missing keypoints count
    /// as not seen.
    pub fn body(self, keypoints: &[Option<ImageKeypoint>]) -> ImageBody {
        let mut body = ImageBody::default();
        for (joint, place) in self.joints() {
            body.set(joint, keypoints.get(place).copied().flatten());
        }
        for middle in self.derived() {
            body.set_middle(middle);
        }
        body
    }

    /// Returns a person's metric joints from points in this order (m). Missing points count as not
    /// known.
    pub fn metric(self, points: &[Option<Point3<f64>>]) -> MetricBody {
        let mut body = MetricBody::default();
        for (joint, place) in self.joints() {
            body.set(joint, points.get(place).copied().flatten());
        }
        for Middle { joint, sides: [one, other] } in self.derived() {
            let middle = body.get(one).zip(body.get(other));
            body.set(joint, middle.map(|(one, other)| nalgebra::center(&one, &other)));
        }
        body
    }

    /// Returns the midpoints that the layout lacks, of neck and mid hip.
    pub fn derived(self) -> impl Iterator<Item = Middle> {
        Middle::ALL
            .into_iter()
            .filter(move |middle| self.joints().all(|(joint, _)| joint != middle.joint))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_layout_has_each_joint_once() {
        for (index, layout) in JointLayout::all().enumerate() {
            assert_eq!(layout as usize, index);
            let joints: Vec<_> = layout.joints().collect();
            for (index, (joint, place)) in joints.iter().enumerate() {
                assert!(*place < layout.count(), "{layout:?}");
                for (other, elsewhere) in &joints[..index] {
                    assert!(joint != other && place != elsewhere, "{layout:?}: {joint:?}");
                }
            }
            let derived: Vec<_> = layout.derived().collect();
            assert!(joints.len() + derived.len() >= 14, "{layout:?}");
            let is_known = |joint| joints.iter().any(|(known, _)| *known == joint);
            assert!(derived.iter().flat_map(|middle| middle.sides).all(is_known));
        }
    }

    /// All layouts name the same person: left and right come from their names in the projects' documents.
    #[test]
    fn layouts_agree_with_the_documents() {
        use JointLayout::{BlazePose, Body25B, Coco17, Coco18, Coco133, Halpe26, Mpi};
        for (layout, joint, place) in [
            (Coco18, LeftEar, 17),
            (Coco18, RightHip, 8),
            (Mpi, Neck, 1),
            (Mpi, LeftAnkle, 13),
            (Coco17, RightAnkle, 16),
            (Body25B, RightHeel, 24),
            (Halpe26, Neck, 18),
            (Halpe26, RightHeel, 25),
            (Coco133, LeftHeel, 19),
            (BlazePose, LeftWrist, 15),
            (BlazePose, RightBigToe, 32),
        ] {
            assert!(layout.joints().any(|found| found == (joint, place)), "{layout:?} {joint:?}");
        }
    }
}
