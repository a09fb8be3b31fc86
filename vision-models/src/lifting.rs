//! From joints in the image and aligned depth to joints in the world.

mod lifter;
mod section;
mod settings;
mod skin;
mod window;

pub use lifter::Lifter;
pub use section::CrossSection;
pub use settings::LiftingSettings;
pub use skin::SkinDepths;
