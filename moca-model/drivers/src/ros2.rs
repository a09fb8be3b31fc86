//! A robot that is reached by ROS 2, over DDS; and the simulated robot behind it, with the person whom it sees.
//!
//! The loop never waits for DDS: two threads of [`Ros2Side`] speak it, one that takes messages and one that publishes
//! them, and hand numbers to and from the loop without a lock. What a message must be like is in [`Measurements`],
//! [`Perceived`] and [`Commands`], which know nothing of DDS.

mod commands;
mod domain;
mod error;
mod hand_over;
mod inbox;
mod measurements;
mod node;
mod outbox;
mod perceived;
mod reader;
mod refusal;
mod report;
mod server;
mod side;
mod stamps;
mod statistics;
mod topic;

pub mod messages;

pub use commands::Commands;
pub use domain::RosDomain;
pub use error::Ros2Error;
pub use measurements::{Measurements, RobotJoints};
pub use perceived::{Perceived, SeenPeople};
pub use refusal::Refusal;
pub use report::{Ros2Report, TopicReport};
pub use server::Ros2Server;
pub use side::{Ros2Side, Ros2Statistics};
pub use stamps::{StampWindow, Stamps};
pub use statistics::{RefusalCount, TopicStatistics};
pub use topic::{JointInterface, Topic};

/// The ROS 2 client that speaks DDS, in the version that is used here.
pub use ros2_client;

/// The frame of odometry and persons: x and y on the floor, z up.
pub const WORLD_FRAME: &str = "odom";
/// The frame of the base: x forwards, y to the left, z up, on the floor.
pub const BASE_FRAME: &str = "base_footprint";
