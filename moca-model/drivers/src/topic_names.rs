//! Names of the topics on a ROS graph.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Frame of odometry and people on a ROS graph: x and y on the floor, z up.
pub const WORLD_FRAME: &str = "odom";
/// Frame of a localisation, which does not drift. A camera that stands in the building stands in it.
pub const MAP_FRAME: &str = "map";

/// Names of the topics on a ROS graph. The defaults are those of `ros2_control` and of `realsense2_camera`.
///
/// ```
/// use moca_drivers::TopicNames;
///
/// let names = TopicNames { odometry: "/robot/odom".to_owned(), ..TopicNames::default() };
/// assert_eq!(names.joint_states, "/joint_states");
/// ```
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TopicNames {
    /// Joint states of the arm (`sensor_msgs/JointState`).
    pub joint_states: String,
    /// Odometry of the base (`nav_msgs/Odometry`).
    pub odometry: String,
    /// Mode of the robot (`std_msgs/String`).
    pub robot_mode: String,
    /// Transforms between frames, of which that from `map` to `odom` counts (`tf2_msgs/TFMessage`).
    pub transforms: String,
    /// Transforms between frames that stay valid, of which a new node receives the last (`tf2_msgs/TFMessage`).
    pub static_transforms: String,
    /// Joints of the people's bodies (`geometry_msgs/PoseArray`).
    pub body_joints: String,
    /// Confidences of the body joints (`std_msgs/Float64MultiArray`).
    pub body_confidences: String,
    /// Covariances of the body joints (`std_msgs/Float64MultiArray`).
    pub body_covariances: String,
    /// Numbers and places of the people (`std_msgs/Float64MultiArray`).
    pub people: String,
    /// Action of the person (`std_msgs/String`).
    pub action: String,
    /// Surface of the object that faces the on-board camera (`std_msgs/String`).
    pub surface: String,
    /// Delays of the perception (`std_msgs/Float64MultiArray`).
    pub perception_delays: String,
    /// Acknowledgement of a stop (`std_msgs/Empty`).
    pub acknowledge: String,
    /// Twist of the base (`geometry_msgs/TwistStamped`).
    pub base_twist: String,
    /// Torques of the arm (`std_msgs/Float64MultiArray`).
    pub effort_commands: String,
    /// Velocities of the arm (`std_msgs/Float64MultiArray`).
    pub velocity_commands: String,
    /// Positions of the arm (`std_msgs/Float64MultiArray`).
    pub position_commands: String,
    /// Action that opens and closes the gripper (`control_msgs/GripperCommand`).
    pub gripper: String,
    /// Phase and safety state of the loop (`std_msgs/String`).
    pub control_state: String,
    /// Colour images of the camera that sees the people (`sensor_msgs/Image`).
    pub colour: String,
    /// Depth images, aligned to the colour images (`sensor_msgs/Image`).
    pub depth: String,
    /// Geometry of the colour images (`sensor_msgs/CameraInfo`).
    pub camera_info: String,
    /// Colour images of the on-board camera, which sees the object (`sensor_msgs/Image`).
    pub on_board_colour: String,
}

impl Default for TopicNames {
    fn default() -> Self {
        let name = str::to_owned;
        Self {
            joint_states: name("/joint_states"),
            odometry: name("/odom"),
            robot_mode: name("/robot_mode"),
            transforms: name("/tf"),
            static_transforms: name("/tf_static"),
            body_joints: name("/body_joints"),
            body_confidences: name("/body_confidences"),
            body_covariances: name("/body_covariances"),
            people: name("/people"),
            action: name("/action"),
            surface: name("/surface"),
            perception_delays: name("/perception_delays"),
            acknowledge: name("/acknowledge"),
            base_twist: name("/cmd_vel"),
            effort_commands: name("/forward_effort_controller/commands"),
            velocity_commands: name("/forward_velocity_controller/commands"),
            position_commands: name("/forward_position_controller/commands"),
            gripper: name("/franka_gripper/gripper_action"),
            control_state: name("/control_state"),
            colour: name("/camera/camera/color/image_raw"),
            depth: name("/camera/camera/aligned_depth_to_color/image_raw"),
            camera_info: name("/camera/camera/color/camera_info"),
            on_board_colour: name("/on_board/camera/color/image_raw"),
        }
    }
}
