//! Ergonomics of a person (draft docs).

mod body_segment;
mod error;
mod joints;
mod kinematics;
mod map;
mod person;
mod person_pose;
mod placement;
mod posture;
mod predict;
mod quadratic;
mod reba;
mod region;
mod rula;
mod side;
mod skeleton;
mod steps;

pub use body_segment::BodySegment;
pub use error::{Error, MapFileProblem, Unreachable};
pub use joints::{JointAngles, JointRanges};
pub use map::{
    ErgonomicsMap, MapNode, MapOptions, MapSample, MeasuredOptions, MeasuredSample, Validation,
    read_samples,
};
pub use person::{Person, Segments};
pub use person_pose::PersonPose;
pub use placement::{Placement, PlacementLimits};
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
