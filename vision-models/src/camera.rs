//! A colour camera with aligned depth: its geometry, its noise and its depth images.

mod depth_image;
mod depth_noise;
#[cfg(feature = "inference")]
mod files;
mod intrinsics;
mod placed;

pub use depth_image::DepthImage;
pub use depth_noise::DepthNoise;
#[cfg(feature = "inference")]
pub use files::{decode_depth, read_depth};
pub use intrinsics::Intrinsics;
pub use placed::Camera;
