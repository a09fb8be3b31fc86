//! What perception reports to the control side, and the tracking of the person in it.
//!
//! A camera frame becomes a [`Percept`]: the recognised [`Action`], the [`Surface`] that faces the
//! on-board camera and the [`Body`], each with its confidence. A [`BodyTracker`] turns the bodies,
//! noisy and sometimes missing, into a [`TrackedPerson`] that a control loop can ask for at any
//! time.
//!
//! The feature `inference`, on by default, is what makes percepts of images: networks and [the engine that
//! runs them](engine), their weights, pre-processing, pose estimation and classification. Without it there are
//! percepts, bodies in images and tracking.
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
mod camera;
mod confidence;
#[cfg(feature = "inference")]
pub mod engine;
mod error;
#[cfg(feature = "inference")]
mod file;
#[cfg(feature = "inference")]
mod head;
#[cfg(feature = "inference")]
mod kernels;
#[cfg(feature = "inference")]
mod labels;
#[cfg(feature = "inference")]
mod layout;
mod lifting;
#[cfg(feature = "inference")]
mod metrics;
#[cfg(feature = "inference")]
mod networks;
mod percept;
#[cfg(feature = "inference")]
mod pose;
#[cfg(feature = "inference")]
mod preprocessing;
#[cfg(feature = "inference")]
mod random;
#[cfg(feature = "inference")]
mod samples;
mod surface;
#[cfg(feature = "inference")]
mod svm;
#[cfg(feature = "inference")]
mod weights;

pub use action::{Action, ActionGroup, Tool, WalkingDirection};
pub use body::{
    Body, Body25, BodySegment, BodyTracker, ImageBody, ImageKeypoint, Keypoint, People,
    PeopleSettings, PersonId, PersonTrack, SegmentLength, StatureEstimate, TrackStatus,
    TrackedPerson, TrackerSettings,
};
pub use camera::{Camera, DepthImage, DepthNoise, Intrinsics};
#[cfg(feature = "inference")]
pub use camera::{decode_depth, read_depth};
pub use confidence::Confidence;
#[cfg(feature = "inference")]
pub use engine::{Options, Scores};
pub use error::Error;
#[cfg(feature = "inference")]
pub use head::{Epoch, FeatureScaling, HeadSettings, HeadTrainer, LinearHead};
#[cfg(feature = "inference")]
pub use kernels::InstructionSet;
#[cfg(feature = "inference")]
pub use labels::ClassNames;
pub use lifting::{CrossSection, Lifter, LiftingSettings, SkinDepths};
#[cfg(feature = "inference")]
pub use metrics::{ConfusionMatrix, softmax, top_k, top_k_accuracy};
#[cfg(feature = "inference")]
pub use networks::{
    NetworkKind, OpenPoseForm, ResNet, ResNetDepth, ResNetForm, SimpleBaselineForm, SlowFast,
    SlowFastForm, SlowOnly, SlowOnlyForm, SlowOnlyStream,
};
pub use percept::{Percept, RecognisedAction, RecognisedSurface};
#[cfg(feature = "inference")]
pub use pose::{
    Coco18, GroupingSettings, OpenPose, Passes, PersonBox, SimpleBaseline, group_parts,
};
#[cfg(feature = "inference")]
pub use preprocessing::{
    ClipSampling, Crops, Library, Preprocessing, Resize, decode_image, list_frames, read_image,
    resize_opencv, resize_pillow,
};
pub use surface::Surface;
#[cfg(feature = "inference")]
pub use svm::{Bias, ClassWeights, LinearSvm, Loss, SvmSettings, Training};
#[cfg(feature = "inference")]
pub use weights::{
    Checkpoint, CheckpointError, ElementType, Format, PickleProblem, Tensor, TensorInfo,
    TensorSource, Tensors,
};
