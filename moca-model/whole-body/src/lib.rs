//! Any robot by its URDF: kinematics and dynamics of trees, and tasks with strict priorities.
//!
//! A [`Model`] is read from a URDF and does not change; a [`Data`] is one thread's memory. Giving
//! the data a configuration returns a [`Posed`], which knows poses, Jacobians, gravity and
//! inertia; giving that a velocity returns a [`Moving`], which knows twists, J̇q̇ and dynamics. What
//! has not been computed cannot be read.
//!
//! An [`Ik`] turns levels of [`Task`]s into velocities within all limits; a [`Commanded`] turns
//! those into commands for a robot that may be held. Both stand on a [`TaskStack`], levels over q̇ and
//! further variables within bounds of your own.
//!
//! A [`TorqueControl`] turns velocities into torques, a [`MomentumObserver`] finds out who pushes, and a
//! [`RigidBodySimulation`] is a robot to try them on.
//!
//! SI units, radians. Twists and accelerations are linear then angular, forces are forces then
//! moments, all of a frame's origin in axes parallel to the world's unless [`Axes::Local`] is asked
//! for. The size of q is [`Model::position_count`], that of q̇ [`Model::velocity_count`]; they
//! differ for a floating base alone.
//!
//! A Panda's hand on a circle, its position before its orientation before the posture of the arm:
//!
//! ```
//! use whole_body::nalgebra::{self, vector};
//! use whole_body::{Description, Ik, Model, OrientationTask, PositionTask, PostureTask};
//!
//! let model = Model::from_urdf_file("examples/urdf/panda.urdf", &Description::default())?;
//! let hand = model.frame_id("panda_hand_tcp")?;
//! let mut q = vec![0.0, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785];
//! let mut builder = Ik::builder(&model);
//! let position = builder.push("position", PositionTask::new(hand)); // highest priority first
//! builder.push("orientation", OrientationTask::new(hand));
//! builder.push("posture", PostureTask::new());
//! let mut ik = builder.build_at(&q)?; // orientation and posture stay as they are there
//! let start = ik.pose(&q, hand)?.translation.vector;
//! for tick in 0..6000 {
//!     let angle = f64::min(1.57e-3 * f64::from(tick), std::f64::consts::TAU); // once round
//!     let target = start + 0.1 * vector![0.0, angle.sin(), angle.cos() - 1.0];
//!     ik.task_mut(position)?.set_target(target)?;
//!     let step = ik.step(&q, 1e-3)?; // within all limits of the joints
//!     step.integrate(&mut q)?; // or send step.velocity() to the robot
//! }
//! assert!((ik.pose(&q, hand)?.translation.vector - start).norm() < 1e-3);
//! # Ok::<(), whole_body::Error>(())
//! ```
//!
//! Kinematics by themselves, of an arm on a base that moves in the plane:
//!
//! ```
//! use whole_body::nalgebra::Matrix6xX;
//! use whole_body::{Axes, Base, Data, Description, Model};
//!
//! let urdf = r#"<robot name="arm">
//!   <link name="base"/> <link name="upper"/> <link name="lower"/>
//!   <joint name="shoulder" type="continuous">
//!     <parent link="base"/><child link="upper"/><axis xyz="0 0 1"/>
//!   </joint>
//!   <joint name="elbow" type="continuous">
//!     <origin xyz="0.5 0 0"/><parent link="upper"/><child link="lower"/><axis xyz="0 0 1"/>
//!   </joint>
//! </robot>"#;
//! let description = Description { base: Base::Planar, ..Description::default() };
//! let model = Model::from_urdf(urdf, &description)?;
//! let lower = model.frame_id("lower")?;
//!
//! let mut data = Data::new(&model);
//! let mut jacobian = Matrix6xX::zeros(model.velocity_count());
//! let posed = data.pose(&model, &[1.0, 2.0, 0.0, 0.3, -0.3])?; // x, y, yaw, shoulder, elbow
//! posed.jacobian_into(lower, Axes::World, &mut jacobian)?;
//! assert!((posed.world_from(lower)?.translation.x - 1.0 - 0.5 * 0.3_f64.cos()).abs() < 1e-12);
//!
//! let moving = posed.moving(&[0.1, 0.0, 0.0, 0.0, 1.0])?;
//! assert!((moving.twist(lower, Axes::World)?[0] - 0.1).abs() < 1e-12); // m/s
//! # Ok::<(), whole_body::Error>(())
//! ```

mod control_loop;
mod dynamics;
mod eigen;
mod error;
mod ik;
mod inertia;
mod kinematics;
mod limits;
mod robot;
mod simulation;
mod spatial;
mod stack;
mod state;
mod tasks;
mod torque;
mod urdf;
mod vector;

pub use ahqp_core::{Budget, PoseAxes, Settings, Solution, Status, VelocityInterval};
pub use control_loop::clock::{Clock, ManualClock, MonotonicClock};
pub use control_loop::deadlines::{DeadlineStatistics, TimeHistogram};
pub use control_loop::law::ControlLaw;
pub use control_loop::robot_side::{
    JointCommand, JointMeasurement, Received, RobotMode, RobotSide, RobotStatus,
};
pub use control_loop::run::{ControlLoop, LoopEnding, LoopError, StopCause};
#[cfg(all(feature = "real-time", target_os = "linux"))]
pub use control_loop::scheduling::Scheduling;
pub use control_loop::settings::LoopSettings;
pub use dynamics::external::ExternalWrench;
pub use error::Error;
pub use error::urdf::UrdfError;
pub use ik::commanded::{Command, Commanded};
pub use ik::differential::{ActiveLimit, ActiveRow, Ik, IkBuilder, LevelReport, Step};
pub use ik::leash::Leash;
pub use ik::settings::IkSettings;
pub use kinematics::jacobian::Axes;
pub use limits::frame_velocity::FrameVelocityLimit;
pub use limits::joint_intervals::{End, LimitKind};
pub use limits::wheels::WheelLimit;
pub use nalgebra;
pub use robot::description::{AddedFrame, Base, Description};
pub use robot::frame::FrameId;
pub use robot::friction::JointFriction;
pub use robot::joint::{Joint, JointId, JointKind, MimicJoint};
pub use robot::limits::{JointLimits, LimitOverride, MissingAcceleration, UnusableLimits};
pub use robot::model::Model;
pub use robot::warning::{InertiaFault, Warning};
pub use simulation::command_line::CommandLine;
pub use simulation::contact::Contact;
pub use simulation::rigid_body::{JointDrive, RigidBodySimulation};
pub use simulation::sensors::{RandomSource, SensorSettings, Sensors};
pub use simulation::transmission::Transmission;
pub use stack::task_level::{TaskId, TaskLevel};
pub use stack::task_stack::TaskStack;
pub use state::data::Data;
pub use state::moving::Moving;
pub use state::payload::{Payload, PayloadId};
pub use state::posed::Posed;
pub use tasks::augmented_frame::AugmentedFrameTask;
pub use tasks::axis::AxisTask;
pub use tasks::centre_of_mass::{CentreOfMass, CentreOfMassTask};
pub use tasks::curvature::Curvature;
pub use tasks::damping::DampingTask;
pub use tasks::feedback::Feedback;
pub use tasks::frame_pose::{FramePose, FrameTask};
pub use tasks::input::TaskInput;
pub use tasks::joint_coupling::JointCouplingTask;
pub use tasks::manipulability::ManipulabilityTask;
pub use tasks::mask::Axis;
pub use tasks::orientation::{FrameOrientation, OrientationTask};
pub use tasks::pose_task::{PoseQuantity, PoseTask};
pub use tasks::position::{FramePosition, PositionTask};
pub use tasks::posture::PostureTask;
pub use tasks::quadratic::{CloneQuadraticTask, QuadraticTask, TaskQuadratic};
pub use tasks::relative_frame::{RelativeFrameTask, RelativePose};
pub use tasks::rows::TaskRows;
pub use tasks::task::{CloneTask, Limit, Task};
pub use tasks::variables::{VariableLayout, Variables};
pub use tasks::vector_task::{VectorQuantity, VectorTask};
pub use tasks::velocity::VelocityTask;
pub use torque::contact_force::ContactForce;
pub use torque::control::{TorqueControl, TorqueSettings};
pub use torque::delay_probe::{DelayProbe, ProbeAnswer};
pub use torque::impedance::{ImpedanceSettings, JointImpedance, JointState};
pub use torque::measurement_watch::{MeasurementFault, MeasurementWatch};
pub use torque::momentum_observer::{MomentumObserver, ObservedFriction, ObserverSettings};
pub use torque::prediction::StatePrediction;
pub use torque::resynchronisation::{Following, Resynchronisation};
pub use torque::support::{CompensatedBy, Compensation, SupportTorque, SupportedMotion};

/// The program of the crate's README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
