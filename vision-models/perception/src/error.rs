//! Errors of this crate.

use std::{fmt::Display, io, path::Path, path::PathBuf};

use percept_recording::RecordingError;
use vision_models::NetworkKind;

/// Reason why frames, files or trained models cannot be used: the place, what was found, and what would be
/// right.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The system cannot read a file.
    #[error("{path}: {source}", path = path.display())]
    Read {
        /// The file or the folder.
        path: PathBuf,
        /// The system's error.
        source: io::Error,
    },
    /// The system cannot write a file.
    #[error("cannot write {path}: {source}", path = path.display())]
    Write {
        /// The file or the folder.
        path: PathBuf,
        /// The system's error.
        source: io::Error,
    },
    /// Something does not have the expected form.
    #[error("{place}: {found}{}{wanted}", if .wanted.is_empty() { "" } else { ": " })]
    Unfit {
        /// The file, the folder, or another place.
        place: String,
        /// The problem that was found there.
        found: String,
        /// The right form. Empty if it is obvious.
        wanted: String,
    },
    /// The weights belong to another network than the requested one.
    #[error("{path}: this is a {found}", path = path.display())]
    OtherNetwork {
        /// The checkpoint.
        path: PathBuf,
        /// The network to which its tensors belong.
        found: NetworkKind,
    },
    /// The checkpoint of a trained model's network was not given.
    #[error("give the model's weights: the checkpoint with {identity}")]
    NoWeights {
        /// The identity of the checkpoint.
        identity: String,
    },
    /// `vision-models` rejects a file.
    #[error("{path}: {source}", path = path.display())]
    Content {
        /// The file or the folder.
        path: PathBuf,
        /// The error of its content.
        source: Box<vision_models::Error>,
    },
    /// A file of one frame cannot be used. The next frame may be usable.
    #[error(transparent)]
    Frame(Box<Error>),
    /// `vision-models` rejects values.
    #[error(transparent)]
    Vision(#[from] vision_models::Error),
    /// A recording of the truth cannot be used.
    #[error("{path}: {source}", path = path.display())]
    Truth {
        /// The recording.
        path: PathBuf,
        /// The error of the recording.
        source: Box<RecordingError>,
    },
    /// No posture has these angles.
    #[error(transparent)]
    Posture(#[from] ergo_map::Error),
    /// The call-back stopped the work before there was any result to keep.
    #[error("interrupted, and nothing is kept")]
    Stopped,
}

impl Error {
    /// Creates the error of something that does not have the expected form.
    pub(crate) fn unfit(place: impl Display, found: impl Display, wanted: impl Display) -> Self {
        let (place, found, wanted) = (place.to_string(), found.to_string(), wanted.to_string());
        Self::Unfit { place, found, wanted }
    }

    /// Creates the same error if what would be right is obvious.
    pub(crate) fn at(place: impl Display, found: impl Display) -> Self {
        Self::unfit(place, found, "")
    }

    /// Creates the error of reading this file.
    pub(crate) fn read(path: impl AsRef<Path>) -> impl FnOnce(io::Error) -> Self {
        move |source| Self::Read { path: path.as_ref().to_owned(), source }
    }

    /// Creates the error of writing this file.
    pub(crate) fn write(path: impl AsRef<Path>) -> impl FnOnce(io::Error) -> Self {
        move |source| Self::Write { path: path.as_ref().to_owned(), source }
    }

    /// Creates the error of the content of this file.
    pub(crate) fn content(path: &Path) -> impl Fn(vision_models::Error) -> Self {
        move |source| match source {
            // These contain the file's name already.
            vision_models::Error::File { .. } | vision_models::Error::Image { .. } => {
                Self::Vision(source)
            }
            vision_models::Error::NoFrames => {
                Self::unfit(path.display(), "no JPEG or PNG files", "")
            }
            source => Self::Content { path: path.to_owned(), source: Box::new(source) },
        }
    }

    /// Creates the error of loading a network from this checkpoint.
    pub(crate) fn weights(path: &Path) -> impl Fn(vision_models::Error) -> Self {
        move |source| match source {
            vision_models::Error::Weights { found: Some(ref name), .. } => {
                let mut kinds = NetworkKind::all().into_iter();
                match kinds.find(|kind| kind.to_string() == **name) {
                    Some(found) => Self::OtherNetwork { path: path.to_owned(), found },
                    None => Self::content(path)(source),
                }
            }
            source @ vision_models::Error::Threads { .. } => Self::Vision(source),
            source => Self::content(path)(source),
        }
    }

    /// Wraps the error in [`Error::Frame`], if it is about a file of images or joints.
    pub(crate) fn of_frame(self) -> Self {
        use vision_models::Error::{File, Image, Malformed};
        let is_of_file = match &self {
            Self::Read { .. } => true,
            Self::Vision(source) => matches!(source, File { .. } | Image { .. }),
            Self::Content { source, .. } => matches!(**source, Malformed { .. }),
            _ => false,
        };
        if is_of_file { Self::Frame(Box::new(self)) } else { self }
    }
}
