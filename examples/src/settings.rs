//! Settings of the controller in one TOML file.
//!
//! [`RobotSettings::to_toml`] writes all of them with the documentation of their fields: meaning, unit and default.
//! [`SettingsFile::read`] reads a file with any part of them. Other settings keep their values.
//!
//! ```
//! use examples::settings::{RobotSettings, SettingsFile};
//!
//! let file = SettingsFile::parse("version = 1\n[controller.desired]\nvelocity = 0.3\n")?;
//! let slow = file.over(&RobotSettings::default())?;
//! assert_eq!(slow.controller.desired.velocity, 0.3);
//! assert_eq!(slow.controller.horizon, RobotSettings::default().controller.horizon);
//!
//! let wrong = SettingsFile::parse("version = 1\n[controller.desired]\nvelocty = 0.3\n");
//! assert!(wrong.unwrap_err().to_string().contains("controller.desired.velocity"));
//! # Ok::<(), examples::settings::SettingsError>(())
//! ```

mod camera_place;
mod error;
mod field;
mod file;
mod own_robot;
mod ranges;
mod robot;
mod scenario;
mod text;
mod version;

pub use camera_place::{CameraFrame, CameraPlace};
pub use error::SettingsError;
pub use file::SettingsFile;
pub use own_robot::OwnRobot;
pub use robot::RobotSettings;
pub use scenario::with_settings;
pub use version::SETTINGS_VERSION;
