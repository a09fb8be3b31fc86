//! Kinematics, dynamics and prioritised control of any robot that a URDF describes as a tree.
//!
//! A [`Model`] is read from a URDF and does not change. A [`Data`] is the memory of one thread. A configuration turns
//! the data into a [`Posed`], which gives poses, Jacobians, gravity and inertia. A velocity turns that into a
//! [`Moving`], which gives twists, J̇q̇ and dynamics. The types forbid reading what is not computed yet.
//!
//! An [`Ik`] turns levels of [`Task`]s into velocities within all limits.
//!
//! | module | holds |
//! |---|---|
//! | [`robot`] | joints, their limits, friction, and warnings about a URDF |
//! | [`state`] | payloads and external forces |
//! | [`tasks`] | the built-in tasks, and the traits for tasks of your own |
//! | [`stack`] | levels of tasks over q̇ and further variables; you set the bounds |
//! | [`limits`] | limits of joints, wheels and speeds of frames |
//! | [`ik`] | settings and results of an [`Ik`] |
//! | [`torque`] | torques that follow velocities, impedance control, and an observer of external torques |
//! | [`control_loop`] | the periodic loop with a real robot |
//! | [`simulation`] | rigid bodies, contacts and sensors for testing controllers |
//!
//! Units are SI and radians. Twists and accelerations are linear, then angular; wrenches are forces, then moments. All
//! refer to a frame's origin, in axes parallel to the world's unless [`Axes::Local`] is given. The size of q is
//! [`Model::position_count`], that of q̇ [`Model::velocity_count`]. They differ only for a floating base.
//!
//! - **Your robot** is read by [`Model::from_urdf_file`]. A [`Description`] adds what a URDF cannot hold. A joint that
//!   states no velocity limit is refused, unless it is continuous and has no `<limit>`. A missing acceleration limit is
//!   set so that the joint reaches its velocity limit in 0.25 s. Jerk is unlimited until you state it.
//! - **Your task** implements [`Task`]: rows lower ≤ A q̇ ≤ upper, whose violation its level minimises. The page of
//!   [`Task`] has an example. Push it like the others.
//! - **A real robot** takes [`Step::velocity`](ik::Step::velocity). Pass the commanded configuration, the integral of
//!   these velocities, to [`Ik::step`]. Call [`Ik::reset`] first if the robot already moves.
//! - **What holds:** position, velocity, acceleration and jerk limits of all joints, in every step and for any target.
//!   A joint that starts outside its range returns within its other limits. A lower task never makes a higher one worse.
//!   The book in the repository, `docs/src/guarantees.md`, has the tests and what is not guaranteed.
//!
//! This program moves a Panda's tool on a circle. The tool's position has priority over its orientation, and that over
//! the posture of the arm:
//!
//! ```
//! use whole_body::nalgebra::{self, vector};
//! use whole_body::tasks::{OrientationTask, PositionTask, PostureTask};
//! use whole_body::{Description, Ik, Model};
//!
//! let model = Model::from_urdf_file("examples/urdf/panda.urdf", &Description::default())?;
//! let tool = model.frame_id("panda_hand_tcp")?;
//! let mut q = vec![0.0, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785];
//! let mut builder = Ik::builder(&model);
//! let position = builder.push("position", PositionTask::new(tool)); // highest priority first
//! builder.push("orientation", OrientationTask::new(tool));
//! builder.push("posture", PostureTask::new());
//! let mut ik = builder.build_at(&q)?; // orientation and posture stay as they are there
//! let start = ik.pose(&q, tool)?.translation.vector;
//! for tick in 0..6000 {
//!     let angle = f64::min(1.57e-3 * f64::from(tick), std::f64::consts::TAU); // once round
//!     let target = start + 0.1 * vector![0.0, angle.sin(), angle.cos() - 1.0];
//!     ik.task_mut(position)?.set_target(target)?;
//!     let step = ik.step(&q, 1e-3)?; // within all limits of the joints
//!     step.integrate(&mut q)?; // send step.velocity() to a real robot as well
//! }
//! assert!((ik.pose(&q, tool)?.translation.vector - start).norm() < 1e-3);
//! # Ok::<(), whole_body::Error>(())
//! ```
//!
//! Kinematics work without tasks. This is an arm on a base that moves in the plane:
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

pub mod control_loop;
mod dynamics;
mod eigen;
mod error;
pub mod ik;
mod inertia;
mod kinematics;
pub mod limits;
pub mod robot;
pub mod simulation;
mod spatial;
pub mod stack;
pub mod state;
pub mod tasks;
pub mod torque;
mod urdf;
mod vector;

pub use error::Error;
pub use ik::differential::Ik;
pub use kinematics::jacobian::Axes;
pub use nalgebra;
pub use robot::description::{Base, Description};
pub use robot::frame::FrameId;
pub use robot::joint::JointId;
pub use robot::model::Model;
pub use state::data::Data;
pub use state::moving::Moving;
pub use state::posed::Posed;
pub use tasks::task::Task;

/// The program of the crate's README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
