//! Errors of this crate.

use std::fmt;

use crate::excerpt::Excerpt;

/// A value that this crate rejects. It says where the value is and what would be right.
///
/// ```
/// use vision_models::{Action, Error};
///
/// let error = Action::from_name("Juggling").unwrap_err();
/// assert!(matches!(&error, Error::Name { what: "action", got, .. } if got == "Juggling"));
/// assert!(error.to_string().contains("Using The Drill"));
/// ```
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A number, an index or a pose that is out of range or not finite.
    #[error("{what} is {got}: give {wanted}")]
    Value {
        /// The setting, the element of an array, or another value.
        what: String,
        /// The given value.
        got: String,
        /// The right values.
        wanted: String,
    },
    /// An array, an image, a clip or a list of the wrong size.
    #[error("{what} has {} {unit}: give {wanted}", sizes(.got))]
    Size {
        /// The object with this size.
        what: String,
        /// The size along each axis.
        got: Vec<usize>,
        /// The unit of the size.
        unit: &'static str,
        /// The right size.
        wanted: String,
    },
    /// An unknown name.
    #[error("unknown {what} \"{}\": give {wanted}", Excerpt(.got))]
    Name {
        /// The kind of name.
        what: &'static str,
        /// The given name.
        got: String,
        /// The right names.
        wanted: &'static str,
    },
    /// A text, a file or a set of samples whose parts do not fit together.
    #[error("{what}: {problem}")]
    Malformed {
        /// The text, file or set, with the line if there are lines.
        what: String,
        /// The problem, and what would fit.
        problem: String,
    },
    /// A checkpoint of another network. The message has only the first few names.
    #[cfg(feature = "inference")]
    #[error("{}", WeightsMessage { network, found, lists: [missing, surplus, misshapen] })]
    Weights {
        /// The network that was to be loaded, if it belongs to this crate.
        network: Option<Box<str>>,
        /// The network that the checkpoint holds, if it is known.
        found: Option<Box<str>>,
        /// Names and shapes of tensors that the network needs and the checkpoint lacks.
        missing: Vec<String>,
        /// Names of tensors that the network does not use.
        surplus: Vec<String>,
        /// Names of tensors of the wrong shape, with both shapes.
        misshapen: Vec<String>,
    },
    /// A layer that does not fit the activations that it reads and writes.
    #[error("layer {layer} cannot be planned: {problem}")]
    Layer {
        /// The layer's name in the checkpoint, or its kind.
        layer: String,
        /// The problem.
        problem: String,
    },
    /// Weights or activations that are too large for f32.
    #[error("{what} overflows f32: {cause}")]
    Overflow {
        /// The layer's weight, or the image or clip of the batch whose activations overflow.
        what: String,
        /// The probable cause.
        cause: &'static str,
    },
    /// Threads that cannot be started: none, more than
    /// [`Options::MAX_THREADS`](crate::Options::MAX_THREADS), or more than the operating system
    /// allows.
    #[error("{threads} threads cannot be started: {reason}")]
    Threads {
        /// The requested number.
        threads: usize,
        /// The limit, or the operating system's reason.
        reason: String,
    },
    /// A file that the operating system cannot read or write.
    #[error("{}{reason}", place(.path))]
    File {
        /// The path. Empty if the reader is not a file.
        path: String,
        /// The operating system's reason.
        reason: String,
    },
    /// A checkpoint file that is rejected. None of its contents is used.
    #[error("{place}: {problem}")]
    Checkpoint {
        /// The part of the file.
        place: String,
        /// The problem in that part.
        problem: String,
    },
    /// An image file that cannot be decoded.
    #[error("{}no JPEG or PNG image that can be read: {reason}", place(.path))]
    Image {
        /// The path. Empty for bytes in memory.
        path: String,
        /// The decoder's reason.
        reason: String,
    },
    /// A video or a folder without frames.
    #[error("no frames: give at least one, or a folder with JPEG or PNG files")]
    NoFrames,
}

impl Error {
    pub(crate) fn value(what: &str, got: impl fmt::Display, wanted: &str) -> Self {
        Self::Value { what: what.into(), got: got.to_string(), wanted: wanted.into() }
    }

    pub(crate) fn size(what: &str, got: &[usize], unit: &'static str, wanted: &str) -> Self {
        Self::Size { what: what.into(), got: got.into(), unit, wanted: wanted.into() }
    }

    pub(crate) fn unknown(what: &'static str, got: &str, wanted: &'static str) -> Self {
        Self::Name { what, got: got.into(), wanted }
    }

    #[cfg(feature = "inference")]
    pub(crate) fn malformed(what: &str, problem: impl Into<String>) -> Self {
        Self::Malformed { what: what.into(), problem: problem.into() }
    }
}

/// Formats sizes as in "480 × 640 × 3".
fn sizes(sizes: &[usize]) -> String {
    sizes.iter().map(usize::to_string).collect::<Vec<_>>().join(" × ")
}

/// Returns the beginning of a message about a file.
fn place(path: &str) -> String {
    if path.is_empty() { String::new() } else { format!("{path}: ") }
}

/// The problems of a checkpoint in a few lines.
#[cfg(feature = "inference")]
struct WeightsMessage<'a> {
    network: &'a Option<Box<str>>,
    found: &'a Option<Box<str>>,
    /// Missing, surplus and misshapen tensors.
    lists: [&'a [String]; 3],
}

#[cfg(feature = "inference")]
impl fmt::Display for WeightsMessage<'_> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        const SHOWN: usize = 3;
        if let Some(found) = self.found {
            write!(formatter, "the checkpoint is a {found}")?;
            return match self.network {
                Some(network) => write!(formatter, ", not a {network}"),
                None => Ok(()),
            };
        }
        match self.network {
            Some(network) => write!(formatter, "the checkpoint does not fit a {network}")?,
            None => write!(formatter, "the checkpoint does not fit the network")?,
        }
        for (what, names) in ["missing", "surplus", "misshapen"].into_iter().zip(self.lists) {
            if names.is_empty() {
                continue;
            }
            write!(formatter, "; {what}: ")?;
            for (index, name) in names.iter().take(SHOWN).enumerate() {
                let separator = if index > 0 { ", " } else { "" };
                write!(formatter, "{separator}{}", Excerpt(name))?;
            }
            if let Some(more) = names.len().checked_sub(SHOWN).filter(|&more| more > 0) {
                write!(formatter, " and {more} more")?;
            }
        }
        Ok(())
    }
}
