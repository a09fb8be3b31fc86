//! Lifting of joints in images to joints in the world: by aligned depth, by metric joints, or by several views.

mod hidden;
mod lifter;
mod monocular;
mod pixel_noise;
mod section;
mod settings;
mod skin;
mod triangulation;
mod views;
mod window;

pub use lifter::Lifter;
pub use monocular::{MonocularLifter, MonocularSettings, PlacedBody};
pub use pixel_noise::PixelNoise;
pub use section::CrossSection;
pub use settings::LiftingSettings;
pub use skin::SkinDepths;
pub use triangulation::{TriangulationSettings, Triangulator};
