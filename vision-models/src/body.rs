//! The person's body: its keypoints in one frame, and its track over time.

mod filter;
mod heading;
mod image_body;
mod keypoints;
mod pose;
mod settings;
mod stature;
mod tracker;

pub use image_body::{ImageBody, ImageKeypoint};
pub use keypoints::{Body, Body25, Keypoint};
pub use pose::{TrackStatus, TrackedPerson};
pub use settings::TrackerSettings;
pub use stature::StatureEstimate;
pub use tracker::BodyTracker;
