//! The person's body: its keypoints in one frame, and its track over time.

mod filter;
mod frame_noise;
mod freshness;
mod identity;
mod image_body;
#[cfg(feature = "inference")]
mod joint_files;
mod joint_layout;
mod joints;
mod keypoints;
mod lean;
mod lengths;
mod observed;
mod people;
mod pose;
mod possible;
mod seen;
mod segment;
mod settings;
mod track;
mod tracker;
mod two_models;

pub use freshness::Freshness;
pub use image_body::{ImageBody, ImageKeypoint};
#[cfg(feature = "inference")]
pub use joint_files::JointFrame;
pub use joint_layout::{JointLayout, Middle};
pub use joints::JointVelocity;
pub use keypoints::{Body, Body25, Keypoint};
pub use lengths::{SegmentLength, StatureEstimate};
pub use observed::{MetricBody, ObservedBody};
pub use people::{People, PeopleSettings, PersonId, PersonTrack};
pub use pose::TrackedPerson;
pub use possible::ImpossibleBody;
pub use segment::BodySegment;
pub use settings::TrackerSettings;
pub use tracker::BodyTracker;
