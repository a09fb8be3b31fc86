//! Errors of settings files.

use std::{io, path::PathBuf};

use super::version::SETTINGS_VERSION;

/// Reason why a settings file cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SettingsError {
    /// The file cannot be read.
    #[error("cannot read {path}: {source}", path = path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Error of the operating system.
        source: io::Error,
    },
    /// The file is not TOML.
    #[error("line {line}: {message}")]
    Syntax {
        /// Line number, from 1.
        line: usize,
        /// Fault at that place.
        message: String,
    },
    /// The file has no version.
    #[error("the file has no version; its first line should be: version = {SETTINGS_VERSION}")]
    NoVersion,
    /// The file has another version.
    #[error(
        "line {line}: the file is of version {found}, and this program reads version \
         {SETTINGS_VERSION}; write a new file with follow --write-settings, and carry your values over"
    )]
    Version {
        /// Line number, from 1.
        line: usize,
        /// The version that it has.
        found: String,
    },
    /// There is no such setting.
    #[error("line {line}: there is no setting {path}; the nearest is {nearest}")]
    Unknown {
        /// Line number, from 1.
        line: usize,
        /// The unknown path.
        path: String,
        /// The most similar known path.
        nearest: String,
    },
    /// A table has a single value.
    #[error(
        "line {line}: {path} is a table of settings; write [{path}], and the settings below it"
    )]
    NotATable {
        /// Line number, from 1.
        line: usize,
        /// The table.
        path: String,
    },
    /// A value has the wrong kind.
    #[error("line {line}: {path}: {reason}")]
    Value {
        /// Line number, from 1.
        line: usize,
        /// The setting.
        path: String,
        /// Fault of its value.
        reason: String,
    },
    /// A value is outside its range, or values do not fit together.
    #[error("{place}{reason}", place = line.map_or(String::new(), |line| format!("line {line}: ")))]
    Range {
        /// Line number from 1, if it is known.
        line: Option<usize>,
        /// Fault of the value.
        reason: String,
    },
    /// The settings cannot be written.
    #[error("these settings cannot be written as TOML: {0}")]
    Write(String),
}
