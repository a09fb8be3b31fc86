use crate::error::{Error, Result, angle};
use crate::posture::Posture;

/// Number of joints of the model.
pub(crate) const DOF: usize = 15;
/// Number of joints that move the hand's position if the wrist stays in line with the forearm.
pub(crate) const POINT_DOF: usize = 12;

/// Names of the joints in the order of [`JointAngles::to_array`].
pub(crate) const NAMES: [&str; DOF] = [
    "ankle",
    "knee",
    "hip",
    "lumbar_flexion",
    "lumbar_side",
    "lumbar_rotation",
    "neck_flexion",
    "neck_rotation",
    "shoulder_flexion",
    "shoulder_abduction",
    "shoulder_rotation",
    "elbow",
    "forearm_pronation",
    "wrist_flexion",
    "wrist_deviation",
];

/// The angles of the fifteen joints of the model \[rad\]. Zero is upright standing, with hanging
/// arms and palms to the body. Both legs move alike. The arm is the working one.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct JointAngles {
    /// Dorsiflexion: the shank leans forward.
    pub ankle: f64,
    /// Flexion of both knees.
    pub knee: f64,
    /// Flexion of both hips.
    pub hip: f64,
    /// Forward flexion of the lumbar spine.
    pub lumbar_flexion: f64,
    /// Side bend of the lumbar spine, to the left positive.
    pub lumbar_side: f64,
    /// Rotation of the trunk on the pelvis, to the left positive.
    pub lumbar_rotation: f64,
    /// Forward flexion of the neck.
    pub neck_flexion: f64,
    /// Rotation of the head, to the left positive.
    pub neck_rotation: f64,
    /// Flexion of the shoulder: the arm rises forward.
    pub shoulder_flexion: f64,
    /// Abduction of the shoulder: the arm rises outward.
    pub shoulder_abduction: f64,
    /// Internal rotation of the upper arm about its long axis.
    pub shoulder_rotation: f64,
    /// Flexion of the elbow.
    pub elbow: f64,
    /// Pronation of the forearm.
    pub forearm_pronation: f64,
    /// Flexion of the wrist, towards the palm.
    pub wrist_flexion: f64,
    /// Ulnar deviation of the wrist, towards the little finger.
    pub wrist_deviation: f64,
}

impl JointAngles {
    /// Number of joints.
    pub const LEN: usize = DOF;
    /// Names of the joints in the order of the fields.
    pub const NAMES: [&str; DOF] = NAMES;

    /// Returns the angles in the order of the fields.
    pub fn to_array(&self) -> [f64; DOF] {
        [
            self.ankle,
            self.knee,
            self.hip,
            self.lumbar_flexion,
            self.lumbar_side,
            self.lumbar_rotation,
            self.neck_flexion,
            self.neck_rotation,
            self.shoulder_flexion,
            self.shoulder_abduction,
            self.shoulder_rotation,
            self.elbow,
            self.forearm_pronation,
            self.wrist_flexion,
            self.wrist_deviation,
        ]
    }

    /// Creates the angles from an array. This is the inverse of [`JointAngles::to_array`].
    pub fn from_array(q: [f64; DOF]) -> Self {
        Self {
            ankle: q[0],
            knee: q[1],
            hip: q[2],
            lumbar_flexion: q[3],
            lumbar_side: q[4],
            lumbar_rotation: q[5],
            neck_flexion: q[6],
            neck_rotation: q[7],
            shoulder_flexion: q[8],
            shoulder_abduction: q[9],
            shoulder_rotation: q[10],
            elbow: q[11],
            forearm_pronation: q[12],
            wrist_flexion: q[13],
            wrist_deviation: q[14],
        }
    }

    /// Returns the posture in the terms of REBA and RULA. The trunk's inclination is the sum of
    /// ankle, knee, hip and lumbar flexion. All other angles are joints of the model.
    pub fn posture(&self) -> Posture {
        Posture {
            trunk_flexion: self.ankle - self.knee + self.hip + self.lumbar_flexion,
            trunk_side: self.lumbar_side,
            trunk_twist: self.lumbar_rotation,
            neck_flexion: self.neck_flexion,
            neck_side: 0.0,
            neck_twist: self.neck_rotation,
            knee_flexion: self.knee,
            upper_arm_flexion: self.shoulder_flexion,
            upper_arm_abduction: self.shoulder_abduction,
            upper_arm_rotation: self.shoulder_rotation,
            elbow_flexion: self.elbow,
            wrist_flexion: self.wrist_flexion,
            wrist_deviation: self.wrist_deviation,
            wrist_twist: self.forearm_pronation,
        }
    }

    /// Checks that every angle is finite and at most a full turn.
    ///
    /// # Errors
    /// [`Error::Value`] names the first joint that is not.
    pub fn validate(&self) -> Result<()> {
        NAMES.into_iter().zip(self.to_array()).try_for_each(|(n, q)| angle(n, q).map(drop))
    }

    /// Returns the posture in a mirror, which exchanges left and right.
    #[must_use]
    pub fn mirrored(&self) -> Self {
        Self {
            lumbar_side: -self.lumbar_side,
            lumbar_rotation: -self.lumbar_rotation,
            neck_rotation: -self.neck_rotation,
            ..*self
        }
    }
}

/// Ranges of motion \[rad\], the joint limits of posture prediction.
///
/// Defaults: arm and wrist from AAOS. Hip, knee, ankle, lumbar spine and neck are from the
/// literature. The adduction of the shoulder is 45°.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointRanges {
    /// Smallest angle of each joint.
    pub min: JointAngles,
    /// Largest angle of each joint.
    pub max: JointAngles,
}

impl Default for JointRanges {
    fn default() -> Self {
        const DEGREES: [(f64, f64); DOF] = [
            (-50.0, 20.0),
            (0.0, 135.0),
            (-30.0, 120.0),
            (-25.0, 80.0),
            (-35.0, 35.0),
            (-45.0, 45.0),
            (-45.0, 45.0),
            (-60.0, 60.0),
            (-60.0, 180.0),
            (-45.0, 180.0),
            (-90.0, 70.0),
            (0.0, 150.0),
            (-80.0, 80.0),
            (-70.0, 80.0),
            (-20.0, 30.0),
        ];
        Self {
            min: JointAngles::from_array(DEGREES.map(|(min, _)| min.to_radians())),
            max: JointAngles::from_array(DEGREES.map(|(_, max)| max.to_radians())),
        }
    }
}

impl JointRanges {
    /// Checks that every range is finite, contains zero (the neutral posture) and is not empty.
    ///
    /// # Errors
    /// [`Error::Value`] with the name of the joint.
    pub fn validate(&self) -> Result<()> {
        self.min.validate()?;
        self.max.validate()?;
        for ((name, min), max) in
            NAMES.into_iter().zip(self.min.to_array()).zip(self.max.to_array())
        {
            if !(min <= 0.0 && max >= 0.0 && max - min > 1e-3) {
                let wanted = format!("lie in [{min}, {max}] rad, a range that is not empty");
                return Err(Error::Value { what: name, got: 0.0, unit: "rad", wanted });
            }
        }
        Ok(())
    }

    /// Returns true if the angles are within the ranges.
    pub fn contains(&self, angles: &JointAngles) -> bool {
        let bounds = self.min.to_array().into_iter().zip(self.max.to_array());
        angles.to_array().into_iter().zip(bounds).all(|(q, (min, max))| (min..=max).contains(&q))
    }
}
