//! Topics between camera, loop and robot.

use super::refusal::Refusal;
use crate::topic_names::TopicNames;

/// Quantity that the joints of the arm follow. It decides which controller of `ros2_controllers` receives the commands.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum JointInterface {
    /// Torques \[Nm\]. The simulated robot follows these.
    #[default]
    Effort,
    /// Velocities \[rad/s\].
    Velocity,
    /// Positions \[rad\].
    Position,
}

/// Topic between a camera, a loop and its robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Topic {
    /// Joint states of the arm.
    JointStates,
    /// Odometry of the base.
    Odometry,
    /// Mode of the robot: whether it takes commands.
    RobotMode,
    /// Transforms between frames.
    Transforms,
    /// Transforms between frames that stay valid.
    StaticTransforms,
    /// Joints of the people's bodies.
    BodyJoints,
    /// Confidences of the body joints.
    BodyConfidences,
    /// Covariances of the body joints.
    BodyCovariances,
    /// Numbers and places of the people.
    People,
    /// Action of the person.
    Action,
    /// Surface of the object.
    Surface,
    /// Delays of the perception.
    PerceptionDelays,
    /// Acknowledgement of a stop.
    Acknowledge,
    /// Twist of the base.
    BaseTwist,
    /// Commands of the arm.
    JointCommands(JointInterface),
    /// Phase and safety state of the loop.
    ControlState,
    /// Colour images of the camera that sees the people.
    Colour,
    /// Depth images, aligned to the colour images.
    Depth,
    /// Geometry of the colour images.
    CameraInfo,
    /// Colour images of the on-board camera.
    OnBoardColour,
}

impl Topic {
    /// Returns the name of the topic.
    pub fn name(self, names: &TopicNames) -> &str {
        match self {
            Self::JointStates => &names.joint_states,
            Self::Odometry => &names.odometry,
            Self::RobotMode => &names.robot_mode,
            Self::Transforms => &names.transforms,
            Self::StaticTransforms => &names.static_transforms,
            Self::BodyJoints => &names.body_joints,
            Self::BodyConfidences => &names.body_confidences,
            Self::BodyCovariances => &names.body_covariances,
            Self::People => &names.people,
            Self::Action => &names.action,
            Self::Surface => &names.surface,
            Self::PerceptionDelays => &names.perception_delays,
            Self::Acknowledge => &names.acknowledge,
            Self::ControlState => &names.control_state,
            Self::BaseTwist => &names.base_twist,
            Self::JointCommands(JointInterface::Effort) => &names.effort_commands,
            Self::JointCommands(JointInterface::Velocity) => &names.velocity_commands,
            Self::JointCommands(JointInterface::Position) => &names.position_commands,
            Self::Colour => &names.colour,
            Self::Depth => &names.depth,
            Self::CameraInfo => &names.camera_info,
            Self::OnBoardColour => &names.on_board_colour,
        }
    }

    /// Returns the package and the name of the message type.
    pub fn message(self) -> (&'static str, &'static str) {
        match self {
            Self::JointStates => ("sensor_msgs", "JointState"),
            Self::Odometry => ("nav_msgs", "Odometry"),
            Self::Transforms | Self::StaticTransforms => ("tf2_msgs", "TFMessage"),
            Self::BodyJoints => ("geometry_msgs", "PoseArray"),
            Self::Action | Self::Surface | Self::RobotMode | Self::ControlState => {
                ("std_msgs", "String")
            }
            Self::Colour | Self::Depth | Self::OnBoardColour => ("sensor_msgs", "Image"),
            Self::CameraInfo => ("sensor_msgs", "CameraInfo"),
            Self::Acknowledge => ("std_msgs", "Empty"),
            Self::BaseTwist => ("geometry_msgs", "TwistStamped"),
            Self::BodyConfidences
            | Self::BodyCovariances
            | Self::People
            | Self::PerceptionDelays
            | Self::JointCommands(_) => ("std_msgs", "Float64MultiArray"),
        }
    }

    /// Checks the message type that a peer uses on this topic, as DDS writes it. DDS itself compares only the names of
    /// topics.
    ///
    /// ```
    /// use moca_drivers::ros2::Topic;
    ///
    /// assert!(Topic::Odometry.check_type("nav_msgs::msg::dds_::Odometry_").is_ok());
    /// let refusal = Topic::Odometry.check_type("geometry_msgs::msg::dds_::Pose_").unwrap_err();
    /// assert_eq!(
    ///     refusal.to_string(),
    ///     "somebody has the type geometry_msgs/Pose there, expected nav_msgs/Odometry"
    /// );
    /// ```
    ///
    /// # Errors
    /// [`Refusal::Type`]
    pub fn check_type(self, found: &str) -> Result<(), Refusal> {
        let (package, name) = self.message();
        if found == format!("{package}::msg::dds_::{name}_") {
            return Ok(());
        }
        let found = found.replace("::msg::dds_::", "/");
        let found = found.trim_end_matches('_').to_owned();
        Err(Refusal::Type { found, expected: format!("{package}/{name}") })
    }
}
