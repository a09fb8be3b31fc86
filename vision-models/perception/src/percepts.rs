//! Converts camera frames to percepts: the sources of joints in the image, and their processing.

mod action_network;
mod action_thread;
mod chain;
mod pipeline;
mod pose_network;
mod pose_source;
mod posture;
mod quantiles;
mod sighting;
mod summary;
mod surface_network;
mod truth;

pub use action_network::{ActionNetwork, ActionSettings};
pub use chain::{Perceiver, PerceiverSettings};
pub use pipeline::{Perceived, Pipeline, StageTimes};
pub use pose_network::PoseNetwork;
pub use pose_source::{Frame, PoseSource, SkeletonFolder};
pub use posture::{Assessor, MeasuredAssessment, PostureSettings, assess};
pub use quantiles::Quantiles;
pub use summary::{Summary, Tally};
pub use surface_network::{SurfaceDecision, SurfaceNetwork};
pub use truth::AgainstTruth;
