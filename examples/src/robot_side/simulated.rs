//! The simulated robot in the process of the loop.

use moca_model::whole_body::{JointCommand, JointMeasurement, Received, RobotSide};
use moca_model::{DynamicRobot, DynamicRobotSettings, Error, MOCA_BASE_JOINTS, moca};

use crate::plant::RobotNoise;

/// MOCA as rigid bodies, which moves for a period with every command.
#[derive(Debug)]
pub struct SimulatedSide {
    robot: DynamicRobot,
    noise: RobotNoise,
    period: f64,
}

impl SimulatedSide {
    /// At rest at `start` \[m, rad\], with a control `period` \[s\] and noise of this seed.
    ///
    /// # Errors
    /// A start that is no configuration.
    pub fn new(start: &[f64], period: f64, seed: u64) -> Result<Self, Error> {
        let robot = DynamicRobot::new(&moca()?, &DynamicRobotSettings::default(), start)?;
        Ok(Self { robot, noise: RobotNoise::new(seed), period })
    }
}

impl RobotSide for SimulatedSide {
    type Error = Error;

    fn receive(&mut self, measured: &mut JointMeasurement) -> Result<Received, Error> {
        self.robot.measure(&mut self.noise)?;
        let now = self.robot.measured();
        measured.position.copy_from_slice(now.position);
        measured.velocity.copy_from_slice(now.velocity);
        measured.torque.copy_from_slice(now.torque);
        Ok(Received::Fresh)
    }

    fn send(&mut self, command: &JointCommand) -> Result<(), Error> {
        let torque = command.torque.get(MOCA_BASE_JOINTS..).unwrap_or_default();
        self.robot.drive(&command.velocity, torque, &[], self.period, &mut self.noise)
    }

    fn halt(&mut self) -> Result<(), Error> {
        Ok(())
    }
}
