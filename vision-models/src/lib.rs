//! What perception reports to the control side, and the tracking of the person in it.
//!
//! A camera frame becomes a [`Percept`]: the recognised [`Action`], the [`Surface`] that faces the
//! on-board camera and the [`Body`], each with its confidence. A [`BodyTracker`] turns the bodies,
//! noisy and sometimes missing, into a [`TrackedPerson`] that a control loop can ask for at any
//! time.
//!
//! Units are SI and radians. Positions are in the world frame: x and y on the floor, z up. The
//! person's frame has its origin on the floor below the pelvis, x forwards and y to the left.
//!
//! ```
//! use nalgebra::Point3;
//! use vision_models::{Body, Body25, BodyTracker, Confidence, Keypoint, Percept, TrackerSettings, TrackStatus};
//!
//! # fn main() -> Result<(), vision_models::Error> {
//! // A person at x = 2 m who faces the robot at the origin: the left side is at negative y.
//! let confidence = Confidence::new(0.9)?;
//! let mut body = Body::default();
//! for (joint, x, y, z) in [
//!     (Body25::LeftShoulder, 2.0, -0.2, 1.4),
//!     (Body25::RightShoulder, 2.0, 0.2, 1.4),
//!     (Body25::MidHip, 2.0, 0.0, 0.9),
//! ] {
//!     body.set(joint, Some(Keypoint { position: Point3::new(x, y, z), confidence }));
//! }
//!
//! let mut tracker = BodyTracker::new(TrackerSettings::default())?;
//! for frame in 0..10 {
//!     let time = 0.05 * f64::from(frame);
//!     tracker.update(&Percept { time, body: Some(body.clone()), action: None, surface: None })?;
//! }
//! let person = tracker.predict(0.451).expect("seen in ten frames");
//! assert_eq!(person.status, TrackStatus::Tracked);
//! assert!((person.floor - nalgebra::Point2::new(2.0, 0.0)).norm() < 1e-9);
//! assert!((person.heading.abs() - std::f64::consts::PI).abs() < 1e-9);
//! # Ok(())
//! # }
//! ```

mod action;
mod body;
mod confidence;
mod error;
mod file;
mod kernels;
mod labels;
mod layout;
mod metrics;
mod networks;
mod percept;
mod preprocessing;
mod surface;
mod svm;
mod weights;

pub use action::{Action, Tool, WalkingDirection};
pub use body::{
    Body, Body25, BodyTracker, ImageBody, ImageKeypoint, Keypoint, StatureEstimate, TrackStatus,
    TrackedPerson, TrackerSettings,
};
pub use confidence::Confidence;
pub use error::Error;
pub use kernels::InstructionSet;
pub use labels::ClassNames;
pub use metrics::{ConfusionMatrix, softmax, top_k, top_k_accuracy};
pub use networks::{
    NetworkKind, Options, ResNet, ResNetDepth, Scores, SlowFast, SlowOnly, SlowOnlyForm,
    SlowOnlyStream,
};
pub use percept::{Percept, RecognisedAction, RecognisedSurface};
pub use preprocessing::{
    ClipSampling, Crops, Library, Preprocessing, Resize, decode_image, list_frames, read_image,
    resize_opencv, resize_pillow,
};
pub use surface::Surface;
pub use svm::{Bias, LinearSvm, Loss, SvmSettings, Training};
pub use weights::{
    Checkpoint, CheckpointError, ElementType, Format, PickleProblem, Tensor, TensorInfo,
    TensorSource, Tensors,
};
