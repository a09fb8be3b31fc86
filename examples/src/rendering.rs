//! A small software renderer: what a colour camera with depth sees of the simulated person, the
//! object that the robot holds, the tool and the room.
//!
//! Bodies are capsules and boxes with one light; depth has the noise of a stereo camera, correlated
//! in time and among neighbouring pixels, and is wrong or missing along edges. It is for testing
//! perception, not for looking at.

mod appearance;
mod body;
mod film;
mod image;
mod noise;
mod on_board;
mod scene;
mod shape;
mod skeleton;
mod view;

pub use appearance::Appearance;
pub use film::{Film, Shot};
pub use image::RenderedImage;
pub use noise::DepthSensor;
pub use scene::{Scene, SceneState};
pub use skeleton::{PoseEstimator, SkeletonSettings};
pub use view::{Viewpoint, render, simulated_camera};
