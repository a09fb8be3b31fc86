//! Errors around the work of a program.

use std::{
    io,
    path::{Path, PathBuf},
};

/// Reason why a program cannot go on.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ProgramError {
    /// The user or the system asked the program to stop before there were results.
    #[error("interrupted, and nothing is kept")]
    Interrupted,
    /// The folder of an output does not exist.
    #[error("cannot write {file}: there is no folder {folder}", file = file.display(), folder = folder.display())]
    NoFolder {
        /// The file that should go there.
        file: PathBuf,
        /// The folder.
        folder: PathBuf,
    },
    /// There is a folder in place of a file.
    #[error("cannot write {path}: it is a folder; give a file", path = path.display())]
    IsFolder {
        /// The folder.
        path: PathBuf,
    },
    /// There is a file in place of a folder.
    #[error("cannot write into {path}: it is a file; give a folder", path = path.display())]
    NotAFolder {
        /// The file.
        path: PathBuf,
    },
    /// The program may not write there.
    #[error("cannot write {path}: {source}", path = path.display())]
    Write {
        /// The file or the folder.
        path: PathBuf,
        /// Error of the operating system.
        source: io::Error,
    },
    /// Standard output cannot be written.
    #[error("cannot write to standard output: {0}")]
    StandardOutput(String),
    /// A signal handler or a thread cannot be created.
    #[error("the system refuses {what}: {source}")]
    Refused {
        /// Work that was asked for.
        what: &'static str,
        /// Error of the operating system.
        source: io::Error,
    },
}

impl ProgramError {
    pub(super) fn write(path: &Path, source: io::Error) -> Self {
        Self::Write { path: path.to_owned(), source }
    }

    /// Returns the same error as an error of writing, for code that only knows `std::io`.
    pub(super) fn into_io(self) -> io::Error {
        let kind = match &self {
            Self::Write { source, .. } => source.kind(),
            _ => io::ErrorKind::Other,
        };
        io::Error::new(kind, self)
    }
}
