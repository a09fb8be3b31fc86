//! A colour camera with aligned depth: its geometry, its noise and its depth images.

mod calibration;
mod depth_image;
mod depth_noise;
mod distortion;
#[cfg(feature = "inference")]
mod files;
mod intrinsics;
mod placed;
mod placement;

pub use calibration::CalibratedCamera;
pub use depth_image::DepthImage;
pub use depth_noise::DepthNoise;
pub use distortion::Distortion;
#[cfg(feature = "inference")]
pub use files::{decode_depth, read_depth};
pub use intrinsics::Intrinsics;
pub use placed::Camera;
pub use placement::CameraPlacement;
