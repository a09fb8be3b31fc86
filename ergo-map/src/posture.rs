use crate::error::{Result, angle};
use crate::upper_arm::UpperArm;

/// A posture as an assessor describes it: the angles that REBA and RULA use \[rad\].
///
/// All zeros are upright standing with hanging arms. Flexion is positive and extension negative.
/// Side bends, twists and rotations count by magnitude. The trunk's flexion is its inclination from
/// the vertical. Those of neck and upper arm are relative to the trunk.
///
/// Flexion and abduction describe the direction of the upper arm like longitude and latitude. At an
/// abduction of 90° the flexion is undefined. Scores therefore use the elevation, which every
/// direction has: [`Posture::upper_arm_elevation`].
///
/// ```
/// let leaning = ergo_map::Posture { trunk_flexion: 0.5, ..Default::default() };
/// assert!(leaning.validate().is_ok());
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Posture {
    /// Inclination of the trunk from the vertical, forward positive.
    pub trunk_flexion: f64,
    /// Side bend of the trunk.
    pub trunk_side: f64,
    /// Twist of the trunk about its long axis.
    pub trunk_twist: f64,
    /// Flexion of the neck, forward positive.
    pub neck_flexion: f64,
    /// Side bend of the neck.
    pub neck_side: f64,
    /// Rotation of the head about the neck's long axis.
    pub neck_twist: f64,
    /// Flexion of the knees.
    pub knee_flexion: f64,
    /// Flexion of the upper arm in the sagittal plane of the trunk, forward positive.
    pub upper_arm_flexion: f64,
    /// Angle of the upper arm out of the sagittal plane of the trunk, outward positive.
    pub upper_arm_abduction: f64,
    /// Rotation of the upper arm about its long axis.
    pub upper_arm_rotation: f64,
    /// Flexion of the elbow.
    pub elbow_flexion: f64,
    /// Flexion of the wrist, extension negative.
    pub wrist_flexion: f64,
    /// Radial or ulnar deviation of the wrist.
    pub wrist_deviation: f64,
    /// Pronation or supination of the forearm from its mid position.
    pub wrist_twist: f64,
}

impl Posture {
    /// Number of angles.
    pub const LEN: usize = 14;

    /// Names of the angles in the order of the fields.
    pub const NAMES: [&'static str; Self::LEN] = [
        "trunk_flexion",
        "trunk_side",
        "trunk_twist",
        "neck_flexion",
        "neck_side",
        "neck_twist",
        "knee_flexion",
        "upper_arm_flexion",
        "upper_arm_abduction",
        "upper_arm_rotation",
        "elbow_flexion",
        "wrist_flexion",
        "wrist_deviation",
        "wrist_twist",
    ];

    /// Returns the angles in the order of the fields.
    pub fn to_array(&self) -> [f64; Self::LEN] {
        [
            self.trunk_flexion,
            self.trunk_side,
            self.trunk_twist,
            self.neck_flexion,
            self.neck_side,
            self.neck_twist,
            self.knee_flexion,
            self.upper_arm_flexion,
            self.upper_arm_abduction,
            self.upper_arm_rotation,
            self.elbow_flexion,
            self.wrist_flexion,
            self.wrist_deviation,
            self.wrist_twist,
        ]
    }

    /// Creates the posture from an array. This is the inverse of [`Posture::to_array`].
    pub fn from_array(angles: [f64; Self::LEN]) -> Self {
        let [
            trunk_flexion,
            trunk_side,
            trunk_twist,
            neck_flexion,
            neck_side,
            neck_twist,
            knee_flexion,
            upper_arm_flexion,
            upper_arm_abduction,
            upper_arm_rotation,
            elbow_flexion,
            wrist_flexion,
            wrist_deviation,
            wrist_twist,
        ] = angles;
        Self {
            trunk_flexion,
            trunk_side,
            trunk_twist,
            neck_flexion,
            neck_side,
            neck_twist,
            knee_flexion,
            upper_arm_flexion,
            upper_arm_abduction,
            upper_arm_rotation,
            elbow_flexion,
            wrist_flexion,
            wrist_deviation,
            wrist_twist,
        }
    }

    /// Returns the elevation of the upper arm: its angle from hanging along the trunk \[rad\], 0 to
    /// π (ISB, Wu et al. 2005).
    pub fn upper_arm_elevation(&self) -> f64 {
        self.upper_arm().elevation()
    }

    /// Returns the plane of elevation of the upper arm \[rad\]: 0 to the side, π/2 forward,
    /// negative behind the trunk (ISB, Wu et al. 2005). The value is arbitrary if the arm hangs or
    /// points straight up.
    pub fn upper_arm_plane_of_elevation(&self) -> f64 {
        let UpperArm { forward, outward, .. } = self.upper_arm();
        forward.atan2(outward)
    }

    /// Returns the direction of the upper arm.
    pub(crate) fn upper_arm(&self) -> UpperArm {
        UpperArm::of_angles(self.upper_arm_flexion, self.upper_arm_abduction)
    }

    /// Checks that every angle is finite and at most a full turn.
    ///
    /// # Errors
    /// [`crate::Error::Value`] names the first angle that is not.
    pub fn validate(&self) -> Result<()> {
        Self::NAMES
            .into_iter()
            .zip(self.to_array())
            .try_for_each(|(name, q)| angle(name, q).map(drop))
    }
}
