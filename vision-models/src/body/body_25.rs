//! The joints of `OpenPose`'s `BODY_25` model.

/// The joints of `BODY_25`. The discriminant is the index in `OpenPose`'s output.
///
/// ```
/// use vision_models::Body25;
///
/// assert_eq!(Body25::MidHip.index(), 8);
/// assert_eq!(Body25::ALL[7], Body25::LeftWrist);
/// assert_eq!(Body25::LeftWrist.name(), "left wrist");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[allow(missing_docs)] // The names are clear.
pub enum Body25 {
    Nose,
    Neck,
    RightShoulder,
    RightElbow,
    RightWrist,
    LeftShoulder,
    LeftElbow,
    LeftWrist,
    MidHip,
    RightHip,
    RightKnee,
    RightAnkle,
    LeftHip,
    LeftKnee,
    LeftAnkle,
    RightEye,
    LeftEye,
    RightEar,
    LeftEar,
    LeftBigToe,
    LeftSmallToe,
    LeftHeel,
    RightBigToe,
    RightSmallToe,
    RightHeel,
}

impl Body25 {
    /// The number of joints.
    pub const COUNT: usize = 25;

    /// Joints in the order of their index.
    pub const ALL: [Self; Self::COUNT] = [
        Self::Nose,
        Self::Neck,
        Self::RightShoulder,
        Self::RightElbow,
        Self::RightWrist,
        Self::LeftShoulder,
        Self::LeftElbow,
        Self::LeftWrist,
        Self::MidHip,
        Self::RightHip,
        Self::RightKnee,
        Self::RightAnkle,
        Self::LeftHip,
        Self::LeftKnee,
        Self::LeftAnkle,
        Self::RightEye,
        Self::LeftEye,
        Self::RightEar,
        Self::LeftEar,
        Self::LeftBigToe,
        Self::LeftSmallToe,
        Self::LeftHeel,
        Self::RightBigToe,
        Self::RightSmallToe,
        Self::RightHeel,
    ];

    /// Returns the index in `OpenPose`'s output, 0 to 24.
    pub fn index(self) -> usize {
        self as usize
    }

    /// Returns the joint's name in words, such as `"left wrist"`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Nose => "nose",
            Self::Neck => "neck",
            Self::RightShoulder => "right shoulder",
            Self::RightElbow => "right elbow",
            Self::RightWrist => "right wrist",
            Self::LeftShoulder => "left shoulder",
            Self::LeftElbow => "left elbow",
            Self::LeftWrist => "left wrist",
            Self::MidHip => "mid hip",
            Self::RightHip => "right hip",
            Self::RightKnee => "right knee",
            Self::RightAnkle => "right ankle",
            Self::LeftHip => "left hip",
            Self::LeftKnee => "left knee",
            Self::LeftAnkle => "left ankle",
            Self::RightEye => "right eye",
            Self::LeftEye => "left eye",
            Self::RightEar => "right ear",
            Self::LeftEar => "left ear",
            Self::LeftBigToe => "left big toe",
            Self::LeftSmallToe => "left small toe",
            Self::LeftHeel => "left heel",
            Self::RightBigToe => "right big toe",
            Self::RightSmallToe => "right small toe",
            Self::RightHeel => "right heel",
        }
    }
}
