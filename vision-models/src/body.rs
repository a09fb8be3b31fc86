//! The person's body: its keypoints in one frame, and its track over time.

mod body_25;
mod filter;
mod frame_noise;
mod freshness;
mod heading;
mod identity;
mod image_body;
#[cfg(feature = "inference")]
mod joint_files;
mod joint_layout;
mod joints;
mod keypoints;
mod lean;
mod lengths;
mod middle;
mod observed;
mod people;
mod person_id;
mod pose;
mod possible;
mod seen;
mod segment;
mod settings;
mod track;
mod tracker;
mod two_models;

pub use body_25::Body25;
pub use freshness::Freshness;
pub use image_body::{ImageBody, ImageKeypoint};
#[cfg(feature = "inference")]
pub use joint_files::JointFrame;
pub use joint_layout::JointLayout;
pub use joints::JointVelocity;
pub use keypoints::{Body, Keypoint};
pub use lengths::{SegmentLength, StatureEstimate};
pub use middle::Middle;
pub use observed::{MetricBody, ObservedBody};
pub use people::{People, PeopleSettings, PersonTrack};
pub use person_id::PersonId;
pub use pose::TrackedPerson;
pub use possible::ImpossibleBody;
pub use segment::BodySegment;
pub use settings::TrackerSettings;
pub use tracker::BodyTracker;
