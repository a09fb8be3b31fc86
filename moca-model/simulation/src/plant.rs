//! A controller and its simulated robot, driven by torque or by velocities alone.
//!
//! ```
//! use ergo_map::ErgonomicsQuadratic;
//! use moca_simulation::plant::{Drive, Plant};
//! use moca_model::{Controller, ControllerSettings, MOCA_HOME, moca};
//! use nalgebra::{Matrix3, Vector3};
//!
//! let ergonomics = ErgonomicsQuadratic::new(Matrix3::identity(), Vector3::zeros(), 1.0)?;
//! let controller = Controller::new(moca()?, ergonomics, ControllerSettings::default(), &MOCA_HOME)?;
//! let mut plant = Plant::new(Drive::Torque, controller, 1)?;
//! for tick in 0..100_u32 {
//!     plant.step(1e-3 * f64::from(tick))?;
//!     plant.act(&Vector3::zeros())?;
//! }
//! assert!((plant.configuration()[6] - MOCA_HOME[6]).abs() < 1e-3); // the arm carries itself
//! # Ok::<(), moca_simulation::Error>(())
//! ```

mod judged;

use std::time::Instant;

use moca_model::whole_body::control_loop::JointMeasurement;
use moca_model::whole_body::simulation::RandomSource;
use moca_model::whole_body::state::{ExternalWrench, PayloadId};
use moca_model::whole_body::torque::Compensation;
use moca_model::whole_body::{Data, FrameId, Model};
use moca_model::{
    Command, Controller, ControllerSettings, DynamicRobot, DynamicRobotSettings, GraspedObject,
    Scene, SimulatedRobot, TorqueController, TorqueLoopSettings,
};
use nalgebra::{Isometry3, Translation3, Vector3, Vector6};
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;
use serde::{Deserialize, Serialize};

use crate::error::Error;
use crate::judges::TorqueMonitor;
pub(crate) use judged::{rod, separation_monitor};

/// The robot's dynamics.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Drive {
    /// The arm moves as rigid bodies under torques, with friction and noise. The base follows velocities with a lag.
    #[default]
    Torque,
    /// Joints that follow velocities exactly and at once.
    Kinematic,
}

/// Settings of a plant.
#[derive(Clone, Debug, PartialEq)]
pub struct PlantSettings {
    /// Dynamics of the robot.
    pub drive: Drive,
    /// The controller.
    pub controller: ControllerSettings,
    /// Settings of the torque loop below it.
    pub torques: TorqueLoopSettings,
}

/// Creates the settings of a robot under torques whose motors compensate nothing.
impl Default for PlantSettings {
    fn default() -> Self {
        Self {
            drive: Drive::default(),
            controller: ControllerSettings::default(),
            torques: TorqueLoopSettings::new(Compensation::BARE),
        }
    }
}

/// Random stream of a plant.
const STREAM: u64 = 100;

/// The measurement that the controller gets in a tick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Heard {
    /// A true measurement.
    #[default]
    Measurement,
    /// No measurement.
    Nothing,
    /// The measurement of the tick before, as if it were new.
    Frozen,
}

/// The closed loop of controller and robot.
#[derive(Clone, Debug)]
pub struct Plant {
    robot: Robot,
    model: Model,
    data: Data,
    /// True pose of the tool.
    tool: Isometry3<f64>,
    random: RobotNoise,
    period: f64,
    /// Configuration at which the command begins \[m, rad\].
    reference: Vec<f64>,
    /// The measurement that the controller got.
    measured: JointMeasurement,
    monitor: TorqueMonitor,
    breaks_torque: bool,
    /// Place where the object is pushed, in the tool's frame \[m\].
    face: Vector3<f64>,
    /// Other wrenches on the robot.
    pushes: Vec<ExternalWrench>,
    /// Payload that the robot was not told of.
    load: Option<PayloadId>,
}

#[derive(Clone, Debug)]
enum Robot {
    Torque(Box<(TorqueController, DynamicRobot)>),
    Kinematic(Box<(Controller, SimulatedRobot)>),
}

/// Random numbers of a simulated robot's noise.
#[derive(Clone, Debug)]
pub struct RobotNoise(ChaCha8Rng);

impl RobotNoise {
    /// Creates a random stream with this seed.
    pub fn new(seed: u64) -> Self {
        Self(simulated_people::generator(seed, STREAM))
    }
}

impl RandomSource for RobotNoise {
    fn normal(&mut self) -> f64 {
        self.0.sample(StandardNormal)
    }

    fn uniform(&mut self) -> f64 {
        self.0.random()
    }
}

impl Plant {
    /// Creates a loop with a controller that has not made a step, and the robot at its configuration.
    ///
    /// # Errors
    /// A robot that cannot be simulated.
    pub fn new(drive: Drive, controller: Controller, seed: u64) -> Result<Self, Error> {
        let torques = TorqueLoopSettings::new(Compensation::BARE);
        Self::with_torques(drive, controller, torques, &DynamicRobotSettings::default(), seed)
    }

    /// Creates a loop with these settings of the torque loop and of the simulated robot, which a kinematic robot does
    /// not use.
    ///
    /// # Errors
    /// A robot that cannot be simulated, and settings that the loop refuses.
    pub fn with_torques(
        drive: Drive,
        controller: Controller,
        torques: TorqueLoopSettings,
        robot: &DynamicRobotSettings,
        seed: u64,
    ) -> Result<Self, Error> {
        let model = controller.robot().model().clone();
        let start = controller.command().joint_position.clone();
        let period = controller.settings().period;
        let monitor = TorqueMonitor::new(&model, &torques, period);
        let robot = match drive {
            Drive::Torque => {
                let robot = DynamicRobot::new(&model, robot, &start)?;
                Robot::Torque(Box::new((TorqueController::new(controller, torques)?, robot)))
            }
            Drive::Kinematic => {
                Robot::Kinematic(Box::new((controller, SimulatedRobot::new(&model, &start)?)))
            }
        };
        let mut plant = Self {
            data: Data::new(&model),
            tool: Isometry3::identity(),
            random: RobotNoise::new(seed),
            measured: JointMeasurement::resting(start.clone(), model.velocity_count()),
            reference: start,
            breaks_torque: false,
            face: Vector3::zeros(),
            pushes: Vec::new(),
            load: None,
            robot,
            model,
            period,
            monitor,
        };
        plant.place_tool()?;
        Ok(plant)
    }

    /// Lets the robot hold an object, which the controller knows of.
    ///
    /// # Errors
    /// An object that cannot be held.
    pub fn grasp(&mut self, object: &GraspedObject) -> Result<(), Error> {
        match &mut self.robot {
            Robot::Torque(both) => {
                let (controller, robot) = &mut **both;
                controller.grasp(object.clone())?;
                robot.attach(controller.controller().robot().tool(), object)?;
            }
            Robot::Kinematic(both) => both.0.grasp(object.clone())?,
        }
        self.face = object.tool_from_face()?;
        Ok(())
    }

    /// The controller of velocities.
    pub fn controller(&self) -> &Controller {
        match &self.robot {
            Robot::Torque(both) => both.0.controller(),
            Robot::Kinematic(both) => &both.0,
        }
    }

    /// The controller of velocities, to place the workspace.
    pub fn controller_mut(&mut self) -> &mut Controller {
        match &mut self.robot {
            Robot::Torque(both) => both.0.controller_mut(),
            Robot::Kinematic(both) => &mut both.0,
        }
    }

    /// Gives the controller a camera frame.
    ///
    /// # Errors
    /// Those of [`Controller::observe`].
    pub fn observe(&mut self, scene: impl Into<Scene>) -> Result<(), Error> {
        Ok(self.controller_mut().observe(scene)?)
    }

    /// Measures the robot and makes a step of the controller. Returns the time that it took \[µs\].
    ///
    /// # Errors
    /// Those of the controller.
    pub fn step(&mut self, now: f64) -> Result<f64, Error> {
        self.step_measuring(now, Heard::Measurement, |_| {})
    }

    /// Makes a step in which the controller gets another measurement, and `spoil` changes the measured positions \[m,
    /// rad\]. Only a controller of torques knows the age of a measurement.
    ///
    /// # Errors
    /// Those of the controller.
    pub fn step_measuring(
        &mut self,
        now: f64,
        heard: Heard,
        spoil: impl FnOnce(&mut [f64]),
    ) -> Result<f64, Error> {
        let told = &mut self.measured;
        told.age = if heard == Heard::Nothing { told.age + self.period } else { 0.0 };
        let started = match &mut self.robot {
            Robot::Torque(both) => {
                let (controller, robot) = &mut **both;
                robot.measure(&mut self.random)?;
                if heard == Heard::Measurement {
                    if robot.status().is_stopped() {
                        controller.controller_mut().robot_stopped();
                    }
                    told.take(robot.measured());
                    spoil(&mut told.position);
                }
                let started = Instant::now();
                controller.step(now, told)?;
                started
            }
            Robot::Kinematic(both) => {
                let (controller, robot) = &mut **both;
                if heard == Heard::Measurement {
                    told.position.copy_from_slice(robot.position());
                    spoil(&mut told.position);
                }
                let started = Instant::now();
                // No force acts on a robot without mass.
                controller.set_external_force(0.0);
                controller.step(now, &told.position)?;
                started
            }
        };
        let time = started.elapsed().as_secs_f64() * 1e6;
        self.breaks_torque = match &self.robot {
            Robot::Torque(both) => self.monitor.check(both.0.torque()),
            Robot::Kinematic(_) => false,
        };
        self.refer();
        Ok(time)
    }

    /// Updates where the command begins: where it ends, minus its motion in a period.
    fn refer(&mut self) {
        match &self.robot {
            Robot::Torque(both) => {
                let command = both.0.controller().command();
                let joints = command.joint_position.iter().zip(&command.joint_velocity);
                for (reference, (position, velocity)) in self.reference.iter_mut().zip(joints) {
                    *reference = position - velocity * self.period;
                }
            }
            Robot::Kinematic(both) => self.reference.copy_from_slice(both.1.position()),
        }
    }

    /// Moves the robot for a period while `force` \[N, world\] pushes the grasped object. Only a robot under torques
    /// reacts to it.
    ///
    /// # Errors
    /// Commands that are not finite.
    pub fn act(&mut self, force: &Vector3<f64>) -> Result<(), Error> {
        let moment = (self.tool.rotation * self.face).cross(force);
        match &mut self.robot {
            Robot::Torque(both) => {
                let (controller, robot) = &mut **both;
                let wrench = Vector6::new(force.x, force.y, force.z, moment.x, moment.y, moment.z);
                let frame = controller.controller().robot().tool();
                let held = [ExternalWrench { frame, wrench }];
                let push: Vec<_> = held.into_iter().chain(self.pushes.iter().copied()).collect();
                let command = controller.controller().command();
                let torque = controller.torque();
                robot.step(command, torque, &push, self.period, &mut self.random)?;
            }
            Robot::Kinematic(both) => {
                let (controller, robot) = &mut **both;
                robot.step(&controller.command().joint_velocity, self.period)?;
            }
        }
        self.place_tool()
    }

    /// Pushes a robot under torques by these forces \[N, world\] at the origins of frames, until others do.
    pub fn push(&mut self, forces: &[(FrameId, Vector3<f64>)]) {
        let wrench = |force: &Vector3<f64>| force.push(0.0).push(0.0).push(0.0);
        let pushes = forces.iter();
        let pushes =
            pushes.map(|(frame, force)| ExternalWrench { frame: *frame, wrench: wrench(force) });
        self.pushes.clear();
        self.pushes.extend(pushes);
    }

    /// The tool of a robot under torques carries this mass \[kg\] besides, which nobody tells the controller; zero
    /// takes it off.
    ///
    /// # Errors
    /// A mass that nothing has.
    pub fn load(&mut self, mass: f64) -> Result<(), Error> {
        let Robot::Torque(both) = &mut self.robot else { return Ok(()) };
        let (controller, robot) = &mut **both;
        if let Some(load) = self.load.take() {
            robot.simulation_mut().data_mut().detach(&self.model, load)?;
        }
        if mass > 0.0 {
            let tool = controller.controller().robot().tool();
            let load = GraspedObject { mass, ..GraspedObject::default() };
            self.load = Some(robot.attach(tool, &load)?);
        }
        Ok(())
    }

    /// Loses this share of the commands on the way to a robot under torques, from now on.
    ///
    /// # Errors
    /// A share that is not from 0 to 1.
    pub fn lose_commands(&mut self, share: f64) -> Result<(), Error> {
        match &mut self.robot {
            Robot::Torque(both) => Ok(both.1.lose(share)?),
            Robot::Kinematic(_) => Ok(()),
        }
    }

    /// Recovers a robot that has stopped by itself, so that it takes commands again.
    pub fn recover(&mut self) {
        if let Robot::Torque(both) = &mut self.robot {
            both.1.recover();
        }
    }

    /// The last command.
    pub fn command(&self) -> &Command {
        self.controller().command()
    }

    /// The true configuration of the robot \[m, rad\].
    pub fn configuration(&self) -> &[f64] {
        match &self.robot {
            Robot::Torque(both) => both.1.simulation().position(),
            Robot::Kinematic(both) => both.1.position(),
        }
    }

    /// The true velocities of its joints \[m/s, rad/s\]; `None` for a robot that follows exactly.
    pub fn velocity(&self) -> Option<&[f64]> {
        match &self.robot {
            Robot::Torque(both) => Some(both.1.simulation().velocity()),
            Robot::Kinematic(_) => None,
        }
    }

    /// The configuration at which the last command begins \[m, rad\]. It is the true one if the robot follows at once.
    pub fn reference(&self) -> &[f64] {
        &self.reference
    }

    /// The true pose of the hand of the person who works on the grasped object; that of the tool if there is none.
    pub fn hand(&self) -> Isometry3<f64> {
        self.tool * Translation3::from(*self.controller().robot().tool_from_hand())
    }

    /// The true pose of the tool.
    pub fn tool(&self) -> &Isometry3<f64> {
        &self.tool
    }

    fn place_tool(&mut self) -> Result<(), Error> {
        let tool = self.controller().robot().tool();
        let configuration = match &self.robot {
            Robot::Torque(both) => both.1.simulation().position(),
            Robot::Kinematic(both) => both.1.position(),
        };
        self.tool = self.data.pose(&self.model, configuration)?.world_from(tool)?;
        Ok(())
    }

    /// True if the last torques violated a limit; `None` without torques.
    pub(crate) fn breaks_torque_limits(&self) -> Option<bool> {
        match &self.robot {
            Robot::Torque(_) => Some(self.breaks_torque),
            Robot::Kinematic(_) => None,
        }
    }
}
