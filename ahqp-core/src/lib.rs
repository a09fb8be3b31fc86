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
//! let x = solver.solve(&hierarchy)?.x();
//! assert!((x[0] - 1.0).abs() < 1e-12 && (x[1] - 1.0).abs() < 1e-12);
//! # Ok::<(), ahqp_core::Error>(())
//! ```

mod active_set;
mod basis;
mod certificate;
mod clik;
mod continuous_stack;
mod damping;
mod error;
mod factorisation;
mod habits;
mod hierarchy;
mod kernels;
mod least_squares;
mod limits;
mod list;
mod proof;
mod pulled;
mod quadratic;
#[cfg(feature = "reference")]
mod reference;
mod rotation;
mod rows;
mod search;
mod settings;
mod settle;
mod solution;
mod solver;
mod table;
mod tall;
#[cfg(feature = "testing")]
pub mod testing;
mod tolerances;
mod vector;
mod verification;

pub use certificate::{Certificate, CertificateResiduals};
pub use clik::{AugmentedClik, AugmentedState, integrate_pose, pose_error};
pub use continuous_stack::{CertifiedPart, ContinuousStack, LevelId, Part, Place};
pub use damping::Damping;
pub use error::Error;
pub use hierarchy::{ConstraintSource, Hierarchy, Level, Objective};
pub use limits::{AcceleratedState, JerkLimits, Limits, MotionState, VelocityInterval};
#[cfg(feature = "reference")]
pub use reference::solve_reference;
pub use rotation::{left_jacobian_inverse, rotation_log};
pub use rows::Rows;
pub use settings::{Settings, WarmStart};
pub use solution::{Solution, Status};
pub use solver::Solver;

/// The example of the repository's front page.
#[cfg(doctest)]
#[doc = include_str!("../../README.md")]
struct FrontPage;

/// The examples of the book's page on this crate.
#[cfg(doctest)]
#[doc = include_str!("../../docs/src/ahqp-core.md")]
struct BookPage;
