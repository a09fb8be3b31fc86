//! The version of settings files.

/// The version of settings files that is read and written.
pub const SETTINGS_VERSION: i64 = 1;
