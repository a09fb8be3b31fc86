//! Topics between loop and robot.

use super::refusal::Refusal;

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

/// Topic between a loop and its robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Topic {
    /// Joint states of the arm.
    JointStates,
    /// Odometry of the base.
    Odometry,
    /// Mode of the robot: whether it takes commands.
    RobotMode,
    /// Joints of the people's bodies.
    BodyJoints,
    /// Confidences of the body joints.
    BodyConfidences,
    /// Action of the person.
    Action,
    /// Acknowledgement of a stop.
    Acknowledge,
    /// Twist of the base.
    BaseTwist,
    /// Commands of the arm.
    JointCommands(JointInterface),
    /// Phase and safety state of the loop.
    ControlState,
}

impl Topic {
    /// Returns the name of the topic.
    pub fn name(self) -> &'static str {
        match self {
            Self::JointStates => "/joint_states",
            Self::Odometry => "/odom",
            Self::RobotMode => "/robot_mode",
            Self::BodyJoints => "/body_joints",
            Self::BodyConfidences => "/body_confidences",
            Self::Action => "/action",
            Self::Acknowledge => "/acknowledge",
            Self::ControlState => "/control_state",
            Self::BaseTwist => "/cmd_vel",
            Self::JointCommands(JointInterface::Effort) => "/forward_effort_controller/commands",
            Self::JointCommands(JointInterface::Velocity) => {
                "/forward_velocity_controller/commands"
            }
            Self::JointCommands(JointInterface::Position) => {
                "/forward_position_controller/commands"
            }
        }
    }

    /// Returns the package and the name of the message type.
    pub fn message(self) -> (&'static str, &'static str) {
        match self {
            Self::JointStates => ("sensor_msgs", "JointState"),
            Self::Odometry => ("nav_msgs", "Odometry"),
            Self::BodyJoints => ("geometry_msgs", "PoseArray"),
            Self::Action | Self::RobotMode | Self::ControlState => ("std_msgs", "String"),
            Self::Acknowledge => ("std_msgs", "Empty"),
            Self::BaseTwist => ("geometry_msgs", "TwistStamped"),
            Self::BodyConfidences | Self::JointCommands(_) => ("std_msgs", "Float64MultiArray"),
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
