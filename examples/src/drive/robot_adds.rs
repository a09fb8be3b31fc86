//! Torques that a robot adds by itself.

use clap::ValueEnum;
use moca_model::whole_body::torque::Compensation;

/// Torques that a robot adds to its commands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum RobotAdds {
    /// Nothing: motors, simulated or not, and effort controllers on them.
    Nothing,
    /// Gravity and friction, as Franka's robots do.
    Franka,
}

impl From<RobotAdds> for Compensation {
    fn from(adds: RobotAdds) -> Self {
        match adds {
            RobotAdds::Nothing => Self::BARE,
            RobotAdds::Franka => Self::FRANKA,
        }
    }
}
