//! The thread beside a control loop: camera, notes, and files.

mod alone;
mod attendant;
#[cfg(feature = "ros2")]
mod beneath;
mod cameras;
#[cfg(feature = "ros2")]
mod interface;
mod object;
mod own_robot;
mod percepts;
mod records;
mod robot_adds;
#[cfg(feature = "ros2")]
mod served;

pub use alone::alone;
pub use attendant::{Attendant, acknowledge_by_keys};
#[cfg(feature = "ros2")]
pub use beneath::beneath;
pub use cameras::recorded;
#[cfg(feature = "ros2")]
pub use cameras::seen_by_others;
#[cfg(feature = "ros2")]
pub use interface::FollowedBy;
pub use object::ObjectOption;
pub use own_robot::DrivenRobot;
pub use percepts::watch_percepts;
pub use records::Records;
pub use robot_adds::RobotAdds;
#[cfg(feature = "ros2")]
pub use served::serve_on_ros2;
