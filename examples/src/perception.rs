//! From camera frames to percepts: where joints in the image come from, and what becomes of them.

mod chain;
mod pose_source;
mod posture;
mod quantiles;

pub use chain::{Perceiver, PerceiverSettings, PerceptionError};
pub use pose_source::{PoseSource, SkeletonFolder};
pub use posture::{MeasuredAssessment, assess};
pub use quantiles::Quantiles;
