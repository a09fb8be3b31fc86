//! Hierarchical quadratic programming with strict priorities, and the augmented closed-loop
//! inverse kinematics built on it.
//!
//! ```
//! use ahqp_core::{Hierarchy, Level, Rows, Settings, Solver};
//! use nalgebra::{dmatrix, dvector};
//!
//! let mut hierarchy = Hierarchy::new(2)?;
//! hierarchy.push(Level::least_squares(Rows::equalities(&dmatrix![1.0, 1.0], &dvector![2.0])?))?;
//! let mut solver = Solver::new(&hierarchy, Settings::default())?;
//! let x = solver.solve(&hierarchy)?.optimum()?;
//! assert!((x[0] - 1.0).abs() < 1e-12 && (x[1] - 1.0).abs() < 1e-12);
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
mod stack;
#[cfg(feature = "testing")]
pub mod testing;

pub use certificate::{Certificate, CertificateResiduals};
pub use error::Error;
pub use kinematics::clik::{
    AugmentedClik, AugmentedState, Clik, PoseAxes, integrate_pose, pose_error,
};
pub use kinematics::damping::Damping;
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
pub use solver::settings::{Settings, WarmStart};
pub use solver::solution::Solution;
pub use solver::status::Status;
pub use stack::{CertifiedPart, ContinuousStack, Part, Place};

/// The example of the repository's front page.
#[cfg(doctest)]
#[doc = include_str!("../../README.md")]
struct FrontPage;

/// The examples of the book's page on this crate.
#[cfg(doctest)]
#[doc = include_str!("../../docs/src/ahqp-core.md")]
struct BookPage;
