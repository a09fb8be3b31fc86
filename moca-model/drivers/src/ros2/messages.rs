//! The ROS messages in use, field by field as their definitions have them: CDR is without names. Positions in m,
//! angles in rad, forces in N, torques in Nm.

use serde::{Deserialize, Serialize};

/// `builtin_interfaces/Time`, since 1970.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Time {
    /// \[s\]
    pub sec: i32,
    /// \[ns\], below 10⁹.
    pub nanosec: u32,
}

/// `std_msgs/Header`
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Header {
    /// When the numbers were true.
    pub stamp: Time,
    /// The frame that they are in.
    pub frame_id: String,
}

/// `std_msgs/String`
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Text {
    /// The text.
    pub data: String,
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

/// No rotation.
impl Default for Quaternion {
    fn default() -> Self {
        Self { x: 0.0, y: 0.0, z: 0.0, w: 1.0 }
    }
}

/// `geometry_msgs/Pose`
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Pose {
    /// \[m\]
    pub position: Vector3,
    /// Of norm 1.
    pub orientation: Quaternion,
}

/// `geometry_msgs/PoseArray`
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PoseArray {
    /// Time and frame of all poses.
    pub header: Header,
    /// The poses.
    pub poses: Vec<Pose>,
}

/// `geometry_msgs/Twist`
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Twist {
    /// \[m/s\]
    pub linear: Vector3,
    /// \[rad/s\]
    pub angular: Vector3,
}

/// `geometry_msgs/TwistStamped`
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TwistStamped {
    /// Time and frame.
    pub header: Header,
    /// The twist.
    pub twist: Twist,
}

/// The 36 numbers of a covariance, row by row.
pub type Covariance = [[f64; 6]; 6];

/// `geometry_msgs/PoseWithCovariance`
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PoseWithCovariance {
    /// The pose.
    pub pose: Pose,
    /// Of x, y, z and the rotations about them.
    pub covariance: Covariance,
}

/// `geometry_msgs/TwistWithCovariance`
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TwistWithCovariance {
    /// The twist.
    pub twist: Twist,
    /// Linear, then angular.
    pub covariance: Covariance,
}

/// `nav_msgs/Odometry`
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Odometry {
    /// Time, and the frame of the pose.
    pub header: Header,
    /// The frame of the twist.
    pub child_frame_id: String,
    /// Of the child frame.
    pub pose: PoseWithCovariance,
    /// Of the child frame, in its own axes.
    pub twist: TwistWithCovariance,
}

/// `sensor_msgs/JointState`: numbers of the joints in the order of their names; a list may be empty.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct JointState {
    /// When they were measured; the frame means nothing.
    pub header: Header,
    /// The joints.
    pub name: Vec<String>,
    /// \[m or rad\]
    pub position: Vec<f64>,
    /// \[m/s or rad/s\]
    pub velocity: Vec<f64>,
    /// \[N or Nm\]
    pub effort: Vec<f64>,
}

/// `std_msgs/MultiArrayDimension`
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct MultiArrayDimension {
    /// Its name.
    pub label: String,
    /// How many elements it has.
    pub size: u32,
    /// From one element to the next.
    pub stride: u32,
}

/// `std_msgs/MultiArrayLayout`
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct MultiArrayLayout {
    /// The dimensions; none for a plain list.
    pub dim: Vec<MultiArrayDimension>,
    /// Numbers before the first element.
    pub data_offset: u32,
}

/// `std_msgs/Float64MultiArray`
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Float64MultiArray {
    /// How the numbers lie.
    pub layout: MultiArrayLayout,
    /// The numbers.
    pub data: Vec<f64>,
}
