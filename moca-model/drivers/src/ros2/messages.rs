//! ROS messages in use. The fields have the order of the definitions, because CDR stores no names. Positions are in m,
//! angles in rad, forces in N, torques in Nm.

use serde::{Deserialize, Serialize};

/// `builtin_interfaces/Time`, since 1970.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Time {
    /// Seconds \[s\].
    pub sec: i32,
    /// Nanoseconds \[ns\], below 10⁹.
    pub nanosec: u32,
}

/// `std_msgs/Header`
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Header {
    /// Time of the numbers.
    pub stamp: Time,
    /// Frame of the numbers.
    pub frame_id: String,
}

/// `std_msgs/String`
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Text {
    /// Text.
    pub data: String,
}

/// `std_msgs/Empty`, which DDS gives a byte without meaning
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Empty {
    /// Byte without a meaning.
    pub structure_needs_at_least_one_member: u8,
}

/// `geometry_msgs/Vector3` and `geometry_msgs/Point`
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[allow(missing_docs)] // The names say it all.
pub struct Vector3 {
    pub x: f64,
    pub y: f64,
    pub z: f64,
}

/// `geometry_msgs/Quaternion`
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[allow(missing_docs)] // The names say it all.
pub struct Quaternion {
    pub x: f64,
    pub y: f64,
    pub z: f64,
    pub w: f64,
}

/// The identity.
impl Default for Quaternion {
    fn default() -> Self {
        Self { x: 0.0, y: 0.0, z: 0.0, w: 1.0 }
    }
}

/// `geometry_msgs/Pose`
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Pose {
    /// Position \[m\].
    pub position: Vector3,
    /// Orientation, of norm 1.
    pub orientation: Quaternion,
}

/// `geometry_msgs/PoseArray`
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PoseArray {
    /// Time and frame of all poses.
    pub header: Header,
    /// Poses.
    pub poses: Vec<Pose>,
}

/// `geometry_msgs/Twist`
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Twist {
    /// Linear velocity \[m/s\].
    pub linear: Vector3,
    /// Angular velocity \[rad/s\].
    pub angular: Vector3,
}

/// `geometry_msgs/TwistStamped`
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TwistStamped {
    /// Time and frame.
    pub header: Header,
    /// Twist.
    pub twist: Twist,
}

/// 36 numbers of a covariance, row by row.
pub type Covariance = [[f64; 6]; 6];

/// `geometry_msgs/PoseWithCovariance`
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PoseWithCovariance {
    /// Pose.
    pub pose: Pose,
    /// Covariance of x, y, z and the rotations about them.
    pub covariance: Covariance,
}

/// `geometry_msgs/TwistWithCovariance`
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TwistWithCovariance {
    /// Twist.
    pub twist: Twist,
    /// Covariance of the linear, then of the angular velocity.
    pub covariance: Covariance,
}

/// `nav_msgs/Odometry`
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Odometry {
    /// Time, and frame of the pose.
    pub header: Header,
    /// Frame of the twist.
    pub child_frame_id: String,
    /// Pose of the child frame.
    pub pose: PoseWithCovariance,
    /// Twist of the child frame, in its own axes.
    pub twist: TwistWithCovariance,
}

/// `geometry_msgs/Transform`
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[allow(missing_docs)] // The names say it all.
pub struct Transform {
    pub translation: Vector3,
    pub rotation: Quaternion,
}

/// `geometry_msgs/TransformStamped`
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TransformStamped {
    /// Time, and frame in which the child frame is placed.
    pub header: Header,
    /// Child frame.
    pub child_frame_id: String,
    /// Pose of the child frame.
    pub transform: Transform,
}

/// `tf2_msgs/TFMessage`
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TfMessage {
    /// Places of frames in each other.
    pub transforms: Vec<TransformStamped>,
}

/// `sensor_msgs/JointState`: numbers of the joints in the order of their names. A list may be empty.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct JointState {
    /// Time of the measurement; the frame has no meaning.
    pub header: Header,
    /// Names of the joints.
    pub name: Vec<String>,
    /// Positions \[m or rad\].
    pub position: Vec<f64>,
    /// Velocities \[m/s or rad/s\].
    pub velocity: Vec<f64>,
    /// Efforts \[N or Nm\].
    pub effort: Vec<f64>,
}

/// `std_msgs/MultiArrayDimension`
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct MultiArrayDimension {
    /// Name of the dimension.
    pub label: String,
    /// Number of elements.
    pub size: u32,
    /// Distance from one element to the next.
    pub stride: u32,
}

/// `std_msgs/MultiArrayLayout`
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct MultiArrayLayout {
    /// Dimensions; empty for a plain list.
    pub dim: Vec<MultiArrayDimension>,
    /// Number of values before the first element.
    pub data_offset: u32,
}

/// `std_msgs/Float64MultiArray`
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Float64MultiArray {
    /// Layout of the numbers.
    pub layout: MultiArrayLayout,
    /// Numbers.
    pub data: Vec<f64>,
}

/// `sensor_msgs/Image`
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Image {
    /// Time of the exposure, and the optical frame.
    pub header: Header,
    /// Number of rows.
    pub height: u32,
    /// Number of columns.
    pub width: u32,
    /// Name of the format of a pixel, such as `rgb8` or `16UC1`.
    pub encoding: String,
    /// 1 if numbers of several bytes begin with the most significant one.
    pub is_bigendian: u8,
    /// Length of a row in bytes.
    pub step: u32,
    /// Rows of pixels.
    #[serde(with = "bytes")]
    pub data: Vec<u8>,
}

/// `sensor_msgs/RegionOfInterest`
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct RegionOfInterest {
    /// First column.
    pub x_offset: u32,
    /// First row.
    pub y_offset: u32,
    /// Number of rows; 0 for the whole image.
    pub height: u32,
    /// Number of columns; 0 for the whole image.
    pub width: u32,
    /// True if the region is to be rectified.
    pub do_rectify: bool,
}

/// `sensor_msgs/CameraInfo`
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct CameraInfo {
    /// Time of the image, and the optical frame.
    pub header: Header,
    /// Number of rows.
    pub height: u32,
    /// Number of columns.
    pub width: u32,
    /// Name of the model of the lens, such as `plumb_bob`.
    pub distortion_model: String,
    /// Coefficients of the lens.
    pub d: Vec<f64>,
    /// Intrinsics row by row: fx, 0, cx, 0, fy, cy, 0, 0, 1 \[pixels\].
    pub k: [f64; 9],
    /// Rectification of a stereo camera.
    pub r: [f64; 9],
    /// Projection of the rectified image \[pixels\].
    pub p: [[f64; 4]; 3],
    /// Columns that are one pixel; 0 and 1 mean none.
    pub binning_x: u32,
    /// Rows that are one pixel; 0 and 1 mean none.
    pub binning_y: u32,
    /// Part of the sensor that the image shows.
    pub roi: RegionOfInterest,
}

/// Goal of the action `control_msgs/GripperCommand`
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct GripperCommand {
    /// Place of a finger \[m\].
    pub position: f64,
    /// Largest effort \[N\].
    pub max_effort: f64,
}

impl ros2_client::Message for GripperCommand {}

/// Result of the action `control_msgs/GripperCommand`
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct GripperResult {
    /// Place of a finger \[m\].
    pub position: f64,
    /// Effort \[N\].
    pub effort: f64,
    /// True if the fingers push at their largest effort and do not move.
    pub stalled: bool,
    /// True if the fingers are where they should be.
    pub reached_goal: bool,
}

impl ros2_client::Message for GripperResult {}

/// Feedback of the action `control_msgs/GripperCommand`, which is like its result
pub type GripperFeedback = GripperResult;

/// Bytes as one block. Serde would take a list of bytes one by one.
mod bytes {
    use std::fmt;

    use serde::de::{Deserializer, Error, Visitor};
    use serde::ser::Serializer;

    struct Block;

    impl Visitor<'_> for Block {
        type Value = Vec<u8>;

        fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
            formatter.write_str("bytes")
        }

        fn visit_bytes<E: Error>(self, bytes: &[u8]) -> Result<Vec<u8>, E> {
            Ok(bytes.to_vec())
        }

        fn visit_byte_buf<E: Error>(self, bytes: Vec<u8>) -> Result<Vec<u8>, E> {
            Ok(bytes)
        }
    }

    pub(super) fn serialize<S: Serializer>(bytes: &[u8], to: S) -> Result<S::Ok, S::Error> {
        to.serialize_bytes(bytes)
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Vec<u8>, D::Error> {
        from.deserialize_byte_buf(Block)
    }
}
