//! Converts joints in the image to joints in the world by aligned depth.

mod lifter;
mod section;
mod settings;
mod skin;
mod window;

pub use lifter::Lifter;
pub use section::CrossSection;
pub use settings::LiftingSettings;
pub use skin::SkinDepths;
