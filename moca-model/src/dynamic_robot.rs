//! A simulated robot whose arm takes torques.

use whole_body::control_loop::{JointMeasurement, RobotMode, RobotStatus};
use whole_body::simulation::{
    CommandLine, JointDrive, RandomSource, RigidBodySimulation, SensorSettings, Sensors,
};
use whole_body::state::{ExternalWrench, PayloadId};
use whole_body::{FrameId, Model};

use crate::command::Command;
use crate::error::{Error, check_plain, check_settings};
use crate::grasped_object::GraspedObject;
use crate::robot::moca::MOCA_BASE_JOINTS;

/// Drives and sensors of a [`DynamicRobot`].
#[derive(Debug, Clone, PartialEq)]
pub struct DynamicRobotSettings {
    /// Number of the first joints, which follow velocities. Default the three of MOCA's base.
    pub base_joints: usize,
    /// Time constant of these joints \[s\]. Default 0.03.
    pub base_time_constant: f64,
    /// Inertia of the rotors of the other joints at the joint \[kg m²\]. Default 0.1, as in MuJoCo Menagerie's Panda.
    pub rotor_inertia: f64,
    /// Noise of measured positions of the base \[m, rad\] and of the arm \[rad\]. Default 2e-5, 2e-5.
    pub position_noise: [f64; 2],
    /// Noise of measured velocities of base \[m/s, rad/s\] and arm \[rad/s\]. Default 1e-3, 2e-3.
    pub velocity_noise: [f64; 2],
    /// Noise of measured torques \[Nm\]. Default 0.05.
    pub torque_noise: f64,
    /// Delay of measurements in ticks. Default 1.
    pub delay: usize,
    /// Share of packets that are lost in each direction. Default 0.001.
    pub loss: f64,
    /// Number of lost commands in a row at which the robot stops by itself. Default 20, as of a Panda.
    pub stops_after: u32,
}

/// Damping by which an arm brakes that has stopped by itself \[Nm s/rad\].
const BRAKE: f64 = 50.0;

impl Default for DynamicRobotSettings {
    fn default() -> Self {
        Self {
            base_joints: MOCA_BASE_JOINTS,
            base_time_constant: 0.03,
            rotor_inertia: 0.1,
            position_noise: [2e-5, 2e-5],
            velocity_noise: [1e-3, 2e-3],
            torque_noise: 0.05,
            delay: 1,
            loss: 1e-3,
            stops_after: 20,
        }
    }
}

impl DynamicRobotSettings {
    /// Multiplies the noise of all measurements by `factor`, 0 or more.
    #[must_use]
    pub fn with_noise(mut self, factor: f64) -> Self {
        let noise = self.position_noise.iter_mut().chain(&mut self.velocity_noise);
        noise.chain([&mut self.torque_noise]).for_each(|noise| *noise *= factor);
        self
    }

    fn sensors(&self, joints: usize) -> SensorSettings {
        let base = |index: usize| index < self.base_joints;
        let each = |[of_base, of_arm]: [f64; 2]| -> Vec<f64> {
            (0..joints).map(|index| if base(index) { of_base } else { of_arm }).collect()
        };
        SensorSettings {
            position_noise: each(self.position_noise),
            velocity_noise: each(self.velocity_noise),
            torque_noise: each([0.0, self.torque_noise]),
            delay: self.delay,
            loss: self.loss,
        }
    }
}

/// MOCA as rigid bodies: the arm under torques with friction and rotors, on a base that follows velocities with a lag.
///
/// Measurements are noisy and late, and packets get lost. If a command is lost, the base continues at constant
/// acceleration and torques stay constant. After too many losses in a row the robot brakes by itself and stands until
/// it is recovered.
///
/// ```
/// use moca_model::{DynamicRobot, DynamicRobotSettings, MOCA_HOME, moca};
/// # struct None;
/// # impl moca_model::whole_body::simulation::RandomSource for None {
/// #     fn normal(&mut self) -> f64 { 0.0 }
/// #     fn uniform(&mut self) -> f64 { 1.0 }
/// # }
/// # let mut random = None;
/// let settings = DynamicRobotSettings::default();
/// let mut robot = DynamicRobot::new(&moca()?, &settings, &MOCA_HOME)?;
/// robot.measure(&mut random)?;
/// let _measured = robot.measured(); // for TorqueController::step
/// # Ok::<(), moca_model::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct DynamicRobot {
    simulation: RigidBodySimulation,
    base_joints: usize,
    sensors: Sensors,
    line: CommandLine,
    command: Vec<f64>,
    loss: f64,
    /// Velocities of the base and torques of the arm in this period.
    obeyed: Vec<f64>,
    model: Model,
    /// Configuration of a robot that brakes by itself, and its gravity.
    position: Vec<f64>,
    gravity: Vec<f64>,
    measured: JointMeasurement,
    /// True if the last command was taken; `None` before the first.
    took_command: Option<bool>,
}

impl DynamicRobot {
    /// Creates a robot at rest at `position`, n \[m or rad\], that supports itself.
    ///
    /// # Errors
    /// [`Error::FloatingBase`]; [`Error::Robot`] for settings out of range.
    pub fn new(
        model: &Model,
        settings: &DynamicRobotSettings,
        position: &[f64],
    ) -> Result<Self, Error> {
        let n = check_plain(model)?;
        let base = JointDrive::Velocity { time_constant: settings.base_time_constant };
        let arm = JointDrive::Torque { rotor_inertia: settings.rotor_inertia };
        let drives: Vec<_> =
            (0..n).map(|index| if index < settings.base_joints { base } else { arm }).collect();
        let mut simulation = RigidBodySimulation::new(model, &drives, position)?;
        let mut command = vec![0.0; n];
        simulation.data_mut().pose(model, position)?.gravity_into(&mut command)?;
        command.iter_mut().take(settings.base_joints).for_each(|velocity| *velocity = 0.0);
        Ok(Self {
            sensors: Sensors::new(settings.sensors(n), position)?,
            line: CommandLine::new(&command, settings.base_joints, settings.stops_after)?,
            base_joints: settings.base_joints,
            loss: settings.loss,
            simulation,
            model: model.clone(),
            position: position.to_vec(),
            gravity: vec![0.0; n],
            measured: JointMeasurement::resting(position.to_vec(), n),
            took_command: None,
            obeyed: command.clone(),
            command,
        })
    }

    /// Measures the present state; see [`measured`](Self::measured).
    ///
    /// # Errors
    /// Never.
    pub fn measure(&mut self, random: &mut impl RandomSource) -> Result<(), Error> {
        self.sensors.measure(&self.simulation, random)?;
        self.measured.position.copy_from_slice(self.sensors.position());
        self.measured.velocity.copy_from_slice(self.sensors.velocity());
        let torques = self.measured.torque.iter_mut().zip(self.sensors.torque());
        torques.skip(self.base_joints).for_each(|(own, torque)| *own = Some(*torque));
        self.measured.robot = self.status();
        Ok(())
    }

    /// The last measurement, at rest at the beginning.
    pub fn measured(&self) -> &JointMeasurement {
        &self.measured
    }

    /// Moves the robot for `period` \[s\] under constant external wrenches. The base follows the command's velocities
    /// in the world's axes, the arm is driven by `torque`.
    ///
    /// # Errors
    /// [`Error::Robot`] for numbers that are not finite, or for wrong sizes.
    pub fn step(
        &mut self,
        command: &Command,
        torque: &[f64],
        external: &[ExternalWrench],
        period: f64,
        random: &mut impl RandomSource,
    ) -> Result<(), Error> {
        self.drive(&command.joint_velocity, torque, external, period, random)
    }

    /// Moves the robot for a period with the velocities of all joints in place of a command.
    ///
    /// # Errors
    /// As [`step`](Self::step).
    pub fn drive(
        &mut self,
        velocity: &[f64],
        torque: &[f64],
        external: &[ExternalWrench],
        period: f64,
        random: &mut impl RandomSource,
    ) -> Result<(), Error> {
        let all = velocity.iter().take(self.base_joints).chain(torque);
        for (own, value) in self.command.iter_mut().zip(all) {
            *own = *value;
        }
        let arrives = self.loss <= 0.0 || random.uniform() >= self.loss;
        self.go_on(arrives, external, period)
    }

    /// Moves the robot for `period` \[s\] without a command, as if it had been lost.
    ///
    /// # Errors
    /// As [`step`](Self::step).
    pub fn miss(&mut self, external: &[ExternalWrench], period: f64) -> Result<(), Error> {
        self.go_on(false, external, period)
    }

    fn go_on(
        &mut self,
        arrives: bool,
        external: &[ExternalWrench],
        period: f64,
    ) -> Result<(), Error> {
        let obeyed = self.line.pass(&self.command, arrives)?;
        self.took_command = Some(arrives && obeyed.is_some());
        match obeyed {
            Some(obeyed) => self.obeyed.copy_from_slice(obeyed),
            None => self.brake(period)?,
        }
        Ok(self.simulation.step(&self.obeyed, external, period)?)
    }

    /// Slows the base down at its limit, and brakes the arm by damping while it supports itself.
    fn brake(&mut self, period: f64) -> Result<(), Error> {
        let Self { model, simulation, position, gravity, obeyed, .. } = self;
        position.copy_from_slice(simulation.position());
        simulation.data_mut().pose(model, position)?.gravity_into(gravity)?;
        let joints = obeyed.iter_mut().zip(simulation.velocity()).zip(gravity).zip(model.limits());
        for (index, (((obeyed, velocity), gravity), limits)) in joints.enumerate() {
            if index < self.base_joints {
                let slower = obeyed.abs() - limits.acceleration * period;
                *obeyed = slower.max(0.0).copysign(*obeyed);
            } else {
                *obeyed = *gravity - BRAKE * velocity;
            }
        }
        Ok(())
    }

    /// Sets the share of commands that are lost.
    ///
    /// # Errors
    /// [`Error::Value`] for a share that is not from 0 to 1.
    pub fn lose(&mut self, share: f64) -> Result<(), Error> {
        check_settings([("loss", share)], "from 0 to 1", |share| (0.0..=1.0).contains(&share))?;
        self.loss = share;
        Ok(())
    }

    /// The status that the robot reports: whether it has stopped, and whether it took the last command.
    pub fn status(&self) -> RobotStatus {
        let stopped = self.line.is_stopped();
        let mode = if stopped { RobotMode::Stopped } else { RobotMode::Running };
        RobotStatus { mode: Some(mode), took_command: self.took_command, holds: None }
    }

    /// Recovers a robot that has stopped by itself, so that it takes commands again.
    pub fn recover(&mut self) {
        self.line.recover();
    }

    /// Attaches an object to the robot's frame `tool`.
    ///
    /// # Errors
    /// [`Error::Robot`], as [`Data::attach`](whole_body::Data::attach).
    pub fn attach(&mut self, tool: FrameId, object: &GraspedObject) -> Result<PayloadId, Error> {
        let (model, payload) = (self.simulation.model().clone(), object.payload(tool));
        Ok(self.simulation.data_mut().attach(&model, &payload)?)
    }

    /// The true state of the robot.
    pub fn simulation(&self) -> &RigidBodySimulation {
        &self.simulation
    }

    /// The simulation, to add contacts and payloads.
    pub fn simulation_mut(&mut self) -> &mut RigidBodySimulation {
        &mut self.simulation
    }
}
