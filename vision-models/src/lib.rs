//! Perception: the results that it reports to the controller, and the tracking of the person.
//!
//! A [`Percept`] is the result for one camera frame: the recognised [`Action`], the [`Surface`]
//! that faces the on-board camera, and the [`Body`], each with its confidence. A [`BodyTracker`]
//! turns the bodies, which are noisy and sometimes missing, into a [`TrackedPerson`] that a control
//! loop can query at any time.
//!
//! The feature `inference`, on by default, computes percepts from images. It has the networks, [the
//! engine that runs them](engine), their weights, pre-processing, pose estimation and
//! classification. If it is off, the crate has percepts, bodies in images and tracking.
//!
//! Units are SI and radians. Positions are in the world frame: x and y on the floor, z up. The
//! person's frame has its origin on the floor below the pelvis, x forwards and y to the left.
//!
//! | you have | begin with |
//! |---|---|
//! | joints of one person in the world | [`BodyTracker`] |
//! | joints of several people | [`People`] |
//! | joints in an image, and a depth image | [`Lifter`] |
//! | the place of a camera, from points where a robot holds its tool | [`CameraPlacement`] |
//! | joints in images of several calibrated cameras | [`Triangulator`] |
//! | metric joints of one camera without depth | [`MonocularLifter`] |
//! | images of people | [`BlazePose`], [`SimpleBaseline`], [`OpenPose`] |
//! | clips of people | [`SlowOnly`], [`SlowOnlyStream`], [`SlowFast`] |
//! | images of surfaces | [`ResNet`] with a [`LinearSvm`] |
//! | weights in a file | [`Checkpoint`], [`TensorFlowLite`] |
//!
//! Example: features of a residual network, and a linear support vector machine that distinguishes
//! two surfaces.
//!
//! ```no_run
//! # #[cfg(feature = "inference")]
//! # fn main() -> Result<(), vision_models::Error> {
//! use vision_models::ndarray::{Axis, concatenate};
//! use vision_models::{
//!     Checkpoint, LinearSvm, Options, Preprocessing, ResNet, ResNetDepth, SvmSettings, read_image,
//! };
//!
//! let weights = Checkpoint::open("resnet50.pth")?; // as torch.save wrote it
//! let mut network = ResNet::load(ResNetDepth::Fifty, weights, [224, 224], Options::default())?;
//! let mut features = |file: &str| {
//!     let image = Preprocessing::SURFACE.image(read_image(file)?.view())?;
//!     Ok::<_, vision_models::Error>(network.infer(image.view())?.features.to_owned())
//! };
//!
//! let (smooth, drilled) = (features("smooth.png")?, features("drilled.png")?);
//! let samples = concatenate![Axis(0), smooth, drilled];
//! let classes = vec!["smooth".into(), "drilled".into()];
//! let (svm, _trainings) = LinearSvm::train(samples.view(), &[0, 1], classes, &SvmSettings::default())?;
//!
//! let class = svm.classify(features("new.png")?.row(0))?;
//! println!("{}", svm.classes()[class]);
//! # Ok(())
//! # }
//! # #[cfg(not(feature = "inference"))]
//! # fn main() {}
//! ```

mod action;
mod body;
mod camera;
mod confidence;
#[cfg(feature = "inference")]
pub mod engine;
mod error;
mod excerpt;
pub mod file;
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

pub use action::{Action, ActionGroup, Intention, Tool, WalkingDirection};
#[cfg(feature = "inference")]
pub use body::JointFrame;
pub use body::{
    Body, Body25, BodySegment, BodyTracker, Freshness, ImageBody, ImageKeypoint, ImpossibleBody,
    JointLayout, JointVelocity, Keypoint, MetricBody, Middle, ObservedBody, People, PeopleSettings,
    PersonId, PersonTrack, SegmentLength, StatureEstimate, TrackedPerson, TrackerSettings,
};
pub use camera::{
    CalibratedCamera, Camera, CameraPlacement, DepthImage, DepthNoise, Distortion, Intrinsics,
};
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
pub use lifting::{
    CrossSection, Lifter, LiftingSettings, MonocularLifter, MonocularSettings, PixelNoise,
    PlacedBody, SkinDepths, TriangulationSettings, Triangulator,
};
#[cfg(feature = "inference")]
pub use metrics::{ConfusionMatrix, softmax, top_k};
pub use nalgebra;
#[cfg(feature = "inference")]
pub use ndarray;
#[cfg(feature = "inference")]
pub use networks::{
    InflatedResNet, NetworkKind, OpenPoseForm, ResNet, ResNetDepth, ResNetForm, SimpleBaselineForm,
    SlowFast, SlowFastForm, SlowOnly, SlowOnlyForm, SlowOnlyStream, TensorFlowLite,
};
pub use percept::{Percept, RecognisedAction, RecognisedSurface};
#[cfg(feature = "inference")]
pub use pose::{
    BlazePose, BlazePoseSettings, Coco18, GroupingSettings, Landmark, Landmarks, OpenPose, Passes,
    PersonBox, PoseRegion, SimpleBaseline, group_parts,
};
#[cfg(feature = "inference")]
pub use preprocessing::{
    ClipSampling, Crops, ImageFolder, Library, Orientation, OtherFiles, Preprocessing, Resize,
    decode_image, decode_image_oriented, is_hidden, list_frames, read_image, read_image_oriented,
    resize_opencv, resize_pillow,
};
pub use surface::Surface;
#[cfg(feature = "inference")]
pub use svm::{Bias, ClassWeights, LinearSvm, Loss, SvmSettings, Training};
#[cfg(feature = "inference")]
pub use weights::{Checkpoint, ElementType, Format, Tensor, TensorInfo, TensorSource, Tensors};

/// The program of the crate's README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
