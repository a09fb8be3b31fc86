//! The topics.

use super::refusal::Refusal;

/// What the joints of the arm follow: which controller of `ros2_controllers` their commands go to.
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

/// A topic between a loop and its robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Topic {
    /// Of the arm.
    JointStates,
    /// Of the base.
    Odometry,
    /// Of the robot: whether it takes commands.
    RobotMode,
    /// Of the person.
    BodyJoints,
    /// Of the person's joints.
    BodyConfidences,
    /// Of the person.
    Action,
    /// To the base.
    BaseTwist,
    /// To the arm.
    JointCommands(JointInterface),
}

impl Topic {
    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::JointStates => "/joint_states",
            Self::Odometry => "/odom",
            Self::RobotMode => "/robot_mode",
            Self::BodyJoints => "/body_joints",
            Self::BodyConfidences => "/body_confidences",
            Self::Action => "/action",
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

    /// The package and the name of its message.
    pub fn message(self) -> (&'static str, &'static str) {
        match self {
            Self::JointStates => ("sensor_msgs", "JointState"),
            Self::Odometry => ("nav_msgs", "Odometry"),
            Self::BodyJoints => ("geometry_msgs", "PoseArray"),
            Self::Action | Self::RobotMode => ("std_msgs", "String"),
            Self::BaseTwist => ("geometry_msgs", "TwistStamped"),
            Self::BodyConfidences | Self::JointCommands(_) => ("std_msgs", "Float64MultiArray"),
        }
    }

    /// Checks the type that somebody gives to this topic, as DDS writes it. DDS compares names of topics only.
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
