//! How far below the skin joints are.

use crate::{Body25, Error};

/// How far the centre of a joint lies behind the skin that depth sees (m).
///
/// The defaults are for adults in working clothes. Nose, eyes and ears are on the skin.
///
/// ```
/// use vision_models::{Body25, SkinDepths};
///
/// let skin = SkinDepths { hips: 0.10, ..SkinDepths::default() };
/// assert_eq!(skin.of(Body25::MidHip), 0.10);
/// assert_eq!(skin.of(Body25::Nose), 0.0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SkinDepths {
    /// Neck, between the shoulders. Default 0.08.
    pub neck: f64,
    /// Shoulders. Default 0.07.
    pub shoulders: f64,
    /// Elbows. Default 0.04.
    pub elbows: f64,
    /// Wrists. Default 0.03.
    pub wrists: f64,
    /// Mid hip and hips. Default 0.095.
    pub hips: f64,
    /// Knees. Default 0.06.
    pub knees: f64,
    /// Ankles, heels and toes. Default 0.035.
    pub feet: f64,
}

impl Default for SkinDepths {
    fn default() -> Self {
        Self {
            neck: 0.08,
            shoulders: 0.07,
            elbows: 0.04,
            wrists: 0.03,
            hips: 0.095,
            knees: 0.06,
            feet: 0.035,
        }
    }
}

impl SkinDepths {
    /// The depth of a joint below the skin (m).
    pub fn of(&self, joint: Body25) -> f64 {
        use Body25::{
            LeftAnkle, LeftBigToe, LeftEar, LeftElbow, LeftEye, LeftHeel, LeftHip, LeftKnee,
            LeftShoulder, LeftSmallToe, LeftWrist, MidHip, Neck, Nose, RightAnkle, RightBigToe,
            RightEar, RightElbow, RightEye, RightHeel, RightHip, RightKnee, RightShoulder,
            RightSmallToe, RightWrist,
        };
        match joint {
            Nose | LeftEye | RightEye | LeftEar | RightEar => 0.0,
            Neck => self.neck,
            LeftShoulder | RightShoulder => self.shoulders,
            LeftElbow | RightElbow => self.elbows,
            LeftWrist | RightWrist => self.wrists,
            MidHip | LeftHip | RightHip => self.hips,
            LeftKnee | RightKnee => self.knees,
            LeftAnkle | RightAnkle | LeftBigToe | RightBigToe | LeftSmallToe | RightSmallToe
            | LeftHeel | RightHeel => self.feet,
        }
    }

    pub(super) fn validate(&self) -> Result<(), Error> {
        for (name, value) in [
            ("skin.neck", self.neck),
            ("skin.shoulders", self.shoulders),
            ("skin.elbows", self.elbows),
            ("skin.wrists", self.wrists),
            ("skin.hips", self.hips),
            ("skin.knees", self.knees),
            ("skin.feet", self.feet),
        ] {
            if !(0.0..=0.3).contains(&value) {
                return Err(Error::Setting { name, value, expected: "a depth in [0, 0.3] m" });
            }
        }
        Ok(())
    }
}
