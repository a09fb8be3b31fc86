//! Ergonomics of one person: from stature to a convex quadratic that a robot's controller can
//! minimise.
//!
//! ```text
//! Person ─▶ PosturePredictor ─▶ posture ─▶ REBA, e_s ─▶ ErgonomicsMap ─▶ ErgonomicsQuadratic
//! ```
//!
//! - [`Worksheet`], [`Reba`]: the integer REBA score with every sub-score, and [`RulaWorksheet`]
//!   for RULA.
//! - [`ContinuousReba`], [`ergonomics_score`]: two continuous scores from the same core. The second
//!   is the score `e_s` of Tassi et al. (2022), the mean of arms, trunk, legs and neck.
//! - [`Person`], [`Skeleton`], [`PosturePredictor`]: the posture of least effort that brings a hand
//!   to a position.
//! - [`ErgonomicsMap`]: postures and scores over the reachable volume, from predictions or
//!   recordings.
//! - [`ErgonomicsQuadratic`]: the convex fit with its [`FitReport`], placed at the person's
//!   position, and its terms for a controller, [`TaskTerms`].
//!
//! Units are SI and angles are in radians. The origin of the person's frame H is on the floor below
//! the pelvis of the person standing upright. x points forward, y left, and z up.
//!
//! The tables and the mathematics are tested against independent implementations. Postures, weights and scores have
//! **not** been validated on people. [`ErgonomicsMap::validate`] compares a map with your recordings.
//!
//! ```
//! use ergo_map::nalgebra::Vector3;
//! use ergo_map::{ErgonomicsMap, FitOptions, MapOptions, Person, PersonFrame};
//!
//! // Once per person.
//! let person = Person::new(1.68)?;
//! let options = MapOptions { spacing: 0.08, ..MapOptions::default() };
//! let map = ErgonomicsMap::build(&person, &options, None)?;
//! let (quadratic, report) = map.fit(&FitOptions::default())?;
//! assert!(report.eigenvalues.min() > 0.0);
//!
//! // A thousand times a second.
//! let standing = PersonFrame::new(Vector3::new(1.2, 0.4, 0.0), 3.0)?;
//! let hand = standing.to_world(&Vector3::new(0.5, -0.2, 1.3));
//! let terms = quadratic.placed(&standing).task_terms(&hand, 0.2)?;
//! assert!(terms.gradient.norm() > 0.0);
//! # Ok::<(), ergo_map::Error>(())
//! ```

mod error;
mod joints;
mod kinematics;
mod map;
mod measured_posture;
mod person;
mod person_frame;
mod posture;
mod predict;
mod quadratic;
mod reba;
mod region;
mod rula;
mod side;
mod skeleton;
mod steps;
mod upper_arm;

pub use error::Error;
pub use joints::{JointAngles, JointRanges};
pub use map::{
    ErgonomicsMap, MapNode, MapOptions, MapSample, MeasuredOptions, MeasuredSample, Validation,
    read_samples,
};
pub use measured_posture::{
    JointPositions, MeasuredPosture, NeutralEstimate, NeutralPosture, PostureFilter,
};
pub use nalgebra;
pub use person::{Person, Segments};
pub use person_frame::PersonFrame;
pub use posture::Posture;
pub use predict::{EffortWeights, HandTarget, PosturePredictor, Prediction};
pub use quadratic::{ErgonomicsQuadratic, FitOptions, FitReport, Regret, ScoredPoint, TaskTerms};
pub use reba::{
    ActionLevel, Conditions, ContinuousReba, Contributions, Coupling, LegSupport, Mode, Reba,
    RebaSubScores, Worksheet, ergonomics_score, ergonomics_score_gradient,
};
pub use region::Region;
pub use rula::{LoadPattern, Rula, RulaActionLevel, RulaSubScores, RulaWorksheet};
pub use side::Side;
pub use skeleton::{Landmarks, Skeleton};

/// Compiles the program of the crate's README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
