//! Robots and cameras that are reached by ROS 2 over DDS. Also the simulated robot behind it, with the person in front of
//! its camera.
//!
//! The loop never waits for DDS. [`Ros2Side`] has two threads for it, one that takes messages and one that publishes
//! them. They exchange numbers with the loop without a lock. [`Measurements`], [`Perceived`] and [`Commands`] define
//! which messages are valid; they do not depend on DDS.

mod camera;
mod commands;
mod domain;
mod error;
mod frame_pairs;
mod frame_tree;
mod gripper;
mod gripper_server;
mod hand_over;
mod inbox;
mod measurements;
mod node;
mod outbox;
mod peers;
mod people_messages;
mod people_publisher;
mod perceived;
mod pictures;
mod reader;
mod recorded_people;
mod refusal;
mod report;
mod server;
mod side;
mod stamps;
mod statistics;
mod topic;
mod wakes;

pub mod messages;

pub use crate::topic_names::{MAP_FRAME, WORLD_FRAME};
pub use camera::{CameraReport, ReceivedImages, Ros2Camera};
pub use commands::Commands;
pub use domain::RosDomain;
pub use error::Ros2Error;
pub use frame_pairs::{CameraImages, FramePairs};
pub use frame_tree::FrameTree;
pub use measurements::{Measurements, RobotJoints};
pub use people_publisher::{PeoplePublisher, Place, PublishedPeople};
pub use perceived::{Perceived, SeenPeople};
pub use pictures::{colour_of, depth_of, intrinsics_of};
pub use recorded_people::ServedRobot;
pub use refusal::Refusal;
pub use report::{Ros2Report, TopicReport};
pub use server::Ros2Server;
pub use side::{Ros2People, Ros2Side, Ros2Statistics};
pub use stamps::{StampWindow, Stamps};
pub use statistics::{RefusalCount, TopicStatistics};
pub use topic::{JointInterface, Topic};

/// ROS 2 client that speaks DDS, in the version that this crate uses.
pub use ros2_client;

/// Frame of the base: x forwards, y to the left, z up, on the floor.
pub const BASE_FRAME: &str = "base_footprint";
