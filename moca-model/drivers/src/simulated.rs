//! The simulated robot in the process of the loop.

use std::fmt;

use moca_model::whole_body::control_loop::{
    JointCommand, JointMeasurement, Received, RobotSide, RobotStatus,
};
use moca_model::whole_body::simulation::RandomSource;
use moca_model::{DynamicRobot, DynamicRobotSettings, Error, MOCA_BASE_JOINTS, moca};

use super::command_limits::{CommandLimits, CommandRefusal};

/// A robot with all joints slower than this is at rest \[m/s or rad/s\].
const REST: f64 = 0.01;

/// MOCA as rigid bodies, which moves for a period with every command.
///
/// It takes no command that its limits exclude: such a one counts as lost. A robot that has stopped by itself
/// takes commands again once it stands, from one on that begins at rest.
#[derive(Debug)]
pub struct SimulatedSide {
    robot: DynamicRobot,
    limits: CommandLimits,
    noise: Noise,
    period: f64,
    refused: u64,
}

/// Noise of the caller's choice.
struct Noise(Box<dyn RandomSource + Send>);

impl fmt::Debug for Noise {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Noise")
    }
}

impl RandomSource for Noise {
    fn normal(&mut self) -> f64 {
        self.0.normal()
    }

    fn uniform(&mut self) -> f64 {
        self.0.uniform()
    }
}

impl SimulatedSide {
    /// At rest at `start` \[m, rad\], with a control `period` \[s\] and this noise.
    ///
    /// # Errors
    /// A start that is no configuration.
    pub fn new(
        start: &[f64],
        period: f64,
        noise: impl RandomSource + Send + 'static,
    ) -> Result<Self, Error> {
        let model = moca()?;
        let robot = DynamicRobot::new(&model, &DynamicRobotSettings::default(), start)?;
        let (limits, noise) = (CommandLimits::new(&model), Noise(Box::new(noise)));
        Ok(Self { robot, limits, noise, period, refused: 0 })
    }

    /// Commands that the robot did not take, because of its limits or of a stop of its own.
    pub fn refused(&self) -> u64 {
        self.refused
    }

    /// What the robot says of itself.
    pub fn status(&self) -> RobotStatus {
        self.robot.status()
    }

    /// Whether all joints rest.
    pub fn is_at_rest(&self) -> bool {
        self.robot.simulation().velocity().iter().all(|velocity| velocity.abs() < REST)
    }

    /// Checks whether the robot takes a command.
    ///
    /// # Errors
    /// Why it does not; the refusal is counted.
    pub fn check(&mut self, command: &JointCommand) -> Result<(), CommandRefusal> {
        let checked = self.limits.check(command).and_then(|()| {
            if !self.status().is_stopped() {
                Ok(())
            } else if self.is_at_rest() {
                CommandLimits::check_begin(command)
            } else {
                Err(CommandRefusal::Braking)
            }
        });
        self.refused += u64::from(checked.is_err());
        checked
    }

    /// Moves for a period as a command says that was checked.
    ///
    /// # Errors
    /// Those of the simulation.
    pub fn obey(&mut self, command: &JointCommand) -> Result<(), Error> {
        if self.status().is_stopped() {
            self.robot.recover();
        }
        let torque = command.torque.get(MOCA_BASE_JOINTS..).unwrap_or_default();
        self.robot.drive(&command.velocity, torque, &[], self.period, &mut self.noise)
    }

    /// Moves for a period without a command: as with one that was lost.
    ///
    /// # Errors
    /// Those of the simulation.
    pub fn miss(&mut self) -> Result<(), Error> {
        self.robot.miss(&[], self.period)
    }

    /// A robot that stands is ready for another controller.
    pub fn recover(&mut self) {
        self.robot.recover();
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
        measured.robot = self.robot.status();
        Ok(Received::Fresh)
    }

    fn send(&mut self, command: &JointCommand) -> Result<(), Error> {
        match self.check(command) {
            Ok(()) => self.obey(command),
            Err(_) => self.miss(),
        }
    }

    fn halt(&mut self) -> Result<(), Error> {
        Ok(())
    }
}
