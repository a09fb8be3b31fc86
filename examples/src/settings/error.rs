//! What can be wrong with a file of settings.

use std::{io, path::PathBuf};

use super::robot::SETTINGS_VERSION;

/// Why a file of settings cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SettingsError {
    /// The file cannot be read.
    #[error("cannot read {path}: {source}", path = path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// It is not TOML.
    #[error("line {line}: {message}")]
    Syntax {
        /// From 1.
        line: usize,
        /// What is wrong there.
        message: String,
    },
    /// It does not say which version it is of.
    #[error("the file has no version; its first line should be: version = {SETTINGS_VERSION}")]
    NoVersion,
    /// It is of another version.
    #[error(
        "line {line}: the file is of version {found}, and this program reads version \
         {SETTINGS_VERSION}; write a new file with follow --write-settings, and carry your values over"
    )]
    Version {
        /// From 1.
        line: usize,
        /// What stands there.
        found: String,
    },
    /// There is no such setting.
    #[error("line {line}: there is no setting {path}; the nearest is {nearest}")]
    Unknown {
        /// From 1.
        line: usize,
        /// What stands there.
        path: String,
        /// The known one that is nearest to it.
        nearest: String,
    },
    /// A single value stands in place of a table.
    #[error(
        "line {line}: {path} is a table of settings; write [{path}], and the settings below it"
    )]
    NotATable {
        /// From 1.
        line: usize,
        /// The table.
        path: String,
    },
    /// A value of the wrong kind.
    #[error("line {line}: {path}: {reason}")]
    Value {
        /// From 1.
        line: usize,
        /// The setting.
        path: String,
        /// What is wrong with its value.
        reason: String,
    },
    /// A value outside its range, or values that do not go together.
    #[error("{place}{reason}", place = line.map_or(String::new(), |line| format!("line {line}: ")))]
    Range {
        /// From 1, where it is known.
        line: Option<usize>,
        /// What is wrong with the value.
        reason: String,
    },
    /// Settings that cannot be written.
    #[error("these settings cannot be written as TOML: {0}")]
    Write(String),
}
