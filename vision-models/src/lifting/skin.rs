//! Depths of joints below the skin.

use super::section::CrossSection;
use crate::body::Body25;
use crate::error::Error;

/// Distance of the centre of a joint behind the skin that the camera sees (m).
///
/// Limbs are round, so their joints are equally deep from every side. Trunk and head are not round.
/// There the depth depends on the side from which the camera sees the person, and on the joint's
/// distance from the middle.
///
/// The defaults are for adults in working clothes, with breadths and depths rounded from ANSUR II
/// (2012). Nose and eyes are on the skin.
///
/// ```
/// use vision_models::{Body25, SkinDepths};
///
/// let skin = SkinDepths { wrists: 0.025, ..SkinDepths::default() };
/// assert_eq!(skin.of(Body25::LeftWrist, 0.0), 0.025);
/// // From the left, the left hip is near and the right one far.
/// let left = std::f64::consts::FRAC_PI_2;
/// assert!(skin.of(Body25::LeftHip, left) < 0.11 && skin.of(Body25::RightHip, left) > 0.2);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SkinDepths {
    /// The trunk at the neck, between the shoulders. Default 0.24 and 0.065.
    pub neck: CrossSection,
    /// The trunk at the hips. Default 0.19 and 0.10.
    pub hips: CrossSection,
    /// Distance from the middle of the hips to either hip. Default 0.09.
    pub hip: f64,
    /// The head at the ears. Default 0.08 and 0.09.
    pub head: CrossSection,
    /// Distance from the middle of the head to either ear. Default 0.075.
    pub ear: f64,
    /// Shoulders. The near shoulder is as deep as both are from the front. The far one is seen
    /// through the breadth of the trunk. Default 0.12 and 0.08.
    pub shoulders: CrossSection,
    /// Elbows. Default 0.045.
    pub elbows: f64,
    /// Wrists. Default 0.03.
    pub wrists: f64,
    /// Knees. Default 0.065.
    pub knees: f64,
    /// Ankles. Default 0.05.
    pub ankles: f64,
    /// Heels and toes. Default 0.025.
    pub feet: f64,
}

impl Default for SkinDepths {
    fn default() -> Self {
        Self {
            neck: CrossSection { half_width: 0.24, half_depth: 0.065 },
            hips: CrossSection { half_width: 0.19, half_depth: 0.10 },
            hip: 0.09,
            head: CrossSection { half_width: 0.08, half_depth: 0.09 },
            ear: 0.075,
            shoulders: CrossSection { half_width: 0.12, half_depth: 0.08 },
            elbows: 0.045,
            wrists: 0.03,
            knees: 0.065,
            ankles: 0.05,
            feet: 0.025,
        }
    }
}

impl SkinDepths {
    /// Returns the depth of a joint below the skin (m). `bearing` is the direction to the camera
    /// relative to the person's forward direction, positive to the left (rad).
    pub fn of(&self, joint: Body25, bearing: f64) -> f64 {
        use Body25::{
            LeftAnkle, LeftBigToe, LeftEar, LeftElbow, LeftEye, LeftHeel, LeftHip, LeftKnee,
            LeftShoulder, LeftSmallToe, LeftWrist, MidHip, Neck, Nose, RightAnkle, RightBigToe,
            RightEar, RightElbow, RightEye, RightHeel, RightHip, RightKnee, RightShoulder,
            RightSmallToe, RightWrist,
        };
        match joint {
            Nose | LeftEye | RightEye => 0.0,
            LeftEar => self.head.depth(self.ear, bearing),
            RightEar => self.head.depth(-self.ear, bearing),
            Neck => self.neck.depth(0.0, bearing),
            LeftShoulder => self.shoulder(bearing),
            RightShoulder => self.shoulder(-bearing),
            LeftElbow | RightElbow => self.elbows,
            LeftWrist | RightWrist => self.wrists,
            MidHip => self.hips.depth(0.0, bearing),
            LeftHip => self.hip_depth(self.hip, bearing),
            RightHip => self.hip_depth(-self.hip, bearing),
            LeftKnee | RightKnee => self.knees,
            LeftAnkle | RightAnkle => self.ankles,
            LeftBigToe | RightBigToe | LeftSmallToe | RightSmallToe | LeftHeel | RightHeel => {
                self.feet
            }
        }
    }

    /// Returns the depth of the hip at this distance to the left (m). The trunk does not become
    /// thinner towards its sides.
    fn hip_depth(&self, aside: f64, bearing: f64) -> f64 {
        self.hips.depth(aside, bearing).max(self.hips.half_depth)
    }

    /// Returns the depth of the shoulder on the side of positive bearings.
    fn shoulder(&self, bearing: f64) -> f64 {
        let is_near = bearing.sin() >= 0.0;
        if is_near { self.shoulders.half_depth } else { self.shoulders.depth(0.0, bearing) }
    }

    pub(super) fn validate(&self) -> Result<(), Error> {
        self.neck.validate("skin.neck")?;
        self.hips.validate("skin.hips")?;
        self.head.validate("skin.head")?;
        self.shoulders.validate("skin.shoulders")?;
        for (name, value) in [
            ("skin.hip", self.hip),
            ("skin.ear", self.ear),
            ("skin.elbows", self.elbows),
            ("skin.wrists", self.wrists),
            ("skin.knees", self.knees),
            ("skin.ankles", self.ankles),
            ("skin.feet", self.feet),
        ] {
            if !(0.0..=0.3).contains(&value) {
                return Err(Error::value(name, value, "a depth in [0, 0.3] m"));
            }
        }
        Ok(())
    }
}
