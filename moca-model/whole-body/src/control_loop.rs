//! The loop that moves a real robot. Once a period it takes what the robot measures, asks a control law and sends the
//! command. It counts ticks that come too late, watches over robot and perception, and stops in order.

pub(crate) mod clock;
pub(crate) mod deadlines;
pub(crate) mod law;
pub(crate) mod robot_side;
pub(crate) mod run;
#[cfg(all(feature = "real-time", target_os = "linux"))]
pub(crate) mod scheduling;
pub(crate) mod settings;

pub use clock::{Clock, ManualClock, MonotonicClock};
pub use deadlines::{DeadlineStatistics, TimeHistogram};
pub use law::ControlLaw;
pub use robot_side::{
    Grip, JointCommand, JointMeasurement, Received, RobotMode, RobotSide, RobotStatus,
};
pub use run::{ControlLoop, LoopEnding, LoopError, StopCause};
#[cfg(all(feature = "real-time", target_os = "linux"))]
pub use scheduling::Scheduling;
pub use settings::LoopSettings;
