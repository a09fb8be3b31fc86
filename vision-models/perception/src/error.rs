//! What can go wrong with what is given to this crate.

use std::{fmt::Display, io, path::Path, path::PathBuf};

use percept_recording::RecordingError;
use vision_models::NetworkKind;

/// Why frames, files or trained models cannot be used: where, what was found, and what would be right.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The system does not let a file be read.
    #[error("{path}: {source}", path = path.display())]
    Read {
        /// The file or the folder.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// The system does not let a file be written.
    #[error("cannot write {path}: {source}", path = path.display())]
    Write {
        /// The file or the folder.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// Something that is not as it should be.
    #[error("{place}: {found}{}{wanted}", if .wanted.is_empty() { "" } else { ": " })]
    Unfit {
        /// The file, the folder, or what else it is about.
        place: String,
        /// What was found there.
        found: String,
        /// What would be right; empty where that is plain.
        wanted: String,
    },
    /// Weights of another network than the one that was asked for.
    #[error("{path}: this is a {found}", path = path.display())]
    OtherNetwork {
        /// The checkpoint.
        path: PathBuf,
        /// The network that its tensors are of.
        found: NetworkKind,
    },
    /// A trained model whose network's checkpoint was not given.
    #[error("give the model's weights: the checkpoint with {identity}")]
    NoWeights {
        /// What tells the checkpoint from others.
        identity: String,
    },
    /// A file that `vision-models` refuses.
    #[error("{path}: {source}", path = path.display())]
    Content {
        /// The file or the folder.
        path: PathBuf,
        /// What is wrong with it.
        source: Box<vision_models::Error>,
    },
    /// A file of one frame that cannot be used: the next frame may be better.
    #[error(transparent)]
    Frame(Box<Error>),
    /// Values that `vision-models` refuses.
    #[error(transparent)]
    Vision(#[from] vision_models::Error),
    /// A recording of the truth that cannot be used.
    #[error("{path}: {source}", path = path.display())]
    Truth {
        /// The recording.
        path: PathBuf,
        /// What is wrong with it.
        source: Box<RecordingError>,
    },
    /// Angles that no posture has.
    #[error(transparent)]
    Posture(#[from] ergo_map::Error),
    /// The call-back ended the work before there was anything to keep.
    #[error("interrupted, and nothing is kept")]
    Stopped,
}

impl Error {
    /// Something that is not as it should be.
    pub(crate) fn unfit(place: impl Display, found: impl Display, wanted: impl Display) -> Self {
        let (place, found, wanted) = (place.to_string(), found.to_string(), wanted.to_string());
        Self::Unfit { place, found, wanted }
    }

    /// The same where what would be right is plain.
    pub(crate) fn at(place: impl Display, found: impl Display) -> Self {
        Self::unfit(place, found, "")
    }

    /// An error of reading this file.
    pub(crate) fn read(path: impl AsRef<Path>) -> impl FnOnce(io::Error) -> Self {
        move |source| Self::Read { path: path.as_ref().to_owned(), source }
    }

    /// An error of writing this file.
    pub(crate) fn write(path: impl AsRef<Path>) -> impl FnOnce(io::Error) -> Self {
        move |source| Self::Write { path: path.as_ref().to_owned(), source }
    }

    /// An error about the content of this file.
    pub(crate) fn content(path: &Path) -> impl Fn(vision_models::Error) -> Self {
        move |source| match source {
            // These have the name already.
            vision_models::Error::File { .. } | vision_models::Error::Image { .. } => {
                Self::Vision(source)
            }
            vision_models::Error::NoFrames => {
                Self::unfit(path.display(), "no JPEG or PNG files", "")
            }
            source => Self::Content { path: path.to_owned(), source: Box::new(source) },
        }
    }

    /// An error of loading a network from this checkpoint.
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

    /// The same as [`Error::Frame`], if it is about a file of images or joints.
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
