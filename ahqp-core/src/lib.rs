//! Hierarchical quadratic programming with strict priorities, and augmented closed-loop inverse
//! kinematics built on it.
//!
//! A [`Hierarchy`] has bounded variables and [`Level`]s, highest priority first. A [`Solver`] finds
//! the point that is best for the first level, among those the best for the second level, and so
//! on. In a control loop the data are rewritten in place, and the solver starts from its last
//! solution.
//!
//! In this example an arm on a slide brings its tool to 0.4 m. Below that it moves the arm back to
//! its middle. [`Limits`] bound position, velocity and acceleration:
//!
//! ```
//! use ahqp_core::nalgebra::{self, dmatrix};
//! use ahqp_core::{Hierarchy, Level, Limits, MotionState, Rows, Settings, Solver};
//!
//! const PERIOD: f64 = 1e-3; // s
//! let limits = [Limits::new(-0.5, 0.5, 0.2, 1.0)?, Limits::new(-0.3, 0.3, 1.0, 5.0)?];
//! let mut joints = [MotionState { position: 0.0, velocity: 0.0 }; 2]; // slide, arm
//!
//! // The variables are the velocities of slide and arm; the first level is the tool's, the second the arm's.
//! let mut hierarchy = Hierarchy::new(2)?;
//! let tool = Level::least_squares(Rows::equalities(&dmatrix![1.0, 1.0], &[0.0])?);
//! let tool = hierarchy.push(tool.named("tool"))?;
//! let middle = Level::least_squares(Rows::equalities(&dmatrix![0.0, 1.0], &[0.0])?);
//! let middle = hierarchy.push(middle.named("arm in the middle"))?;
//! let mut solver = Solver::new(&hierarchy, Settings::default())?;
//!
//! for _tick in 0..8000 {
//!     let (lower, upper) = hierarchy.bounds_mut();
//!     for (i, (limits, joint)) in limits.iter().zip(joints).enumerate() {
//!         let interval = limits.velocity_interval(joint, PERIOD);
//!         (lower[i], upper[i]) = (interval.lower, interval.upper);
//!     }
//!     let position = joints[0].position + joints[1].position;
//!     hierarchy.rows_mut(tool)?.set_targets(&[2.0 * (0.4 - position)])?;
//!     hierarchy.rows_mut(middle)?.set_targets(&[-2.0 * joints[1].position])?;
//!     let velocities = solver.solve(&hierarchy)?.optimum()?;
//!     for (joint, &velocity) in joints.iter_mut().zip(velocities) {
//!         *joint = MotionState { position: joint.position + PERIOD * velocity, velocity };
//!     }
//! }
//! assert!((joints[0].position - 0.4).abs() < 1e-3 && joints[1].position.abs() < 1e-3);
//! # Ok::<(), ahqp_core::Error>(())
//! ```

mod certificate;
mod error;
mod kinematics;
mod limits;
mod linalg;
mod problem;
#[cfg(feature = "reference")]
mod reference;
mod solver;
#[cfg(feature = "testing")]
pub mod testing;

pub use certificate::{Certificate, CertificateResiduals};
pub use error::Error;
pub use kinematics::clik::{
    AugmentedClik, AugmentedRow, AugmentedState, Clik, PoseAxes, integrate_pose, pose_error,
};
pub use kinematics::rotation::{left_jacobian_inverse, rotation_log};
pub use limits::{AcceleratedState, JerkLimits, Limits, MotionState, VelocityInterval};
pub use nalgebra;
pub use problem::hierarchy::Hierarchy;
pub use problem::ids::LevelId;
pub use problem::level::{Level, Objective};
pub use problem::matrix::CoefficientMatrix;
pub use problem::rows::{Rows, Values};
pub use problem::source::{ConstraintSource, Names};
#[cfg(feature = "reference")]
pub use reference::solve_reference;
pub use solver::Solver;
pub use solver::budget::Budget;
pub use solver::settings::{Settings, Stacking, WarmStart};
pub use solver::solution::Solution;
pub use solver::status::Status;

/// Compiles the program of the crate's README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
