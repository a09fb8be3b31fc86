//! A small software renderer. It shows what a colour camera with depth sees of the simulated person, the grasped object,
//! the tool and the room.
//!
//! Bodies are capsules and boxes with one light. Depth has the noise of a stereo camera, correlated in time and among
//! neighbouring pixels, and is wrong or missing along edges. The renderer is for testing perception.
//!
//! ```
//! use moca_simulation::people::WalkerSettings;
//! use moca_simulation::rendering::{Film, Viewpoint};
//!
//! let settings = WalkerSettings { duration: 1.0, ..WalkerSettings::default() };
//! let mut film = Film::new(settings, Viewpoint::Facing, [64, 48], 3.0)?;
//! let shot = film.next().expect("a first frame")?;
//! assert_eq!((shot.entry.frame, shot.image.size()), (0, [64, 48]));
//! # Ok::<(), moca_simulation::Error>(())
//! ```

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
pub use view::Viewpoint;
