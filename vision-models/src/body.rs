//! The person's body: its keypoints in one frame, and its track over time.

mod filter;
mod identity;
mod image_body;
mod joints;
mod keypoints;
mod lean;
mod lengths;
#[cfg(feature = "inference")]
mod openpose;
mod people;
mod pose;
mod possible;
mod seen;
mod segment;
mod settings;
mod track;
mod tracker;
mod two_models;

pub use image_body::{ImageBody, ImageKeypoint};
pub use joints::JointVelocity;
pub use keypoints::{Body, Body25, Keypoint};
pub use lengths::{SegmentLength, StatureEstimate};
pub use people::{People, PeopleSettings, PersonId, PersonTrack};
pub use pose::{TrackStatus, TrackedPerson};
pub use possible::ImpossibleBody;
pub use segment::BodySegment;
pub use settings::TrackerSettings;
pub use tracker::BodyTracker;
