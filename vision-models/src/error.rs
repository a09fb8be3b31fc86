//! What can be wrong with what is given to this crate.

/// A value that this crate refuses, with the place and what would be right.
///
/// ```
/// use vision_models::{Action, Error};
///
/// let error = Action::from_name("Juggling").unwrap_err();
/// assert_eq!(error, Error::UnknownAction { name: "Juggling".into() });
/// assert!(error.to_string().contains("Using The Drill"));
/// ```
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A name that is none of the thirty classes.
    #[error(
        "unknown action \"{name}\": give one of the thirty HRI30 class names exactly as they are \
         written, such as \"Using The Drill\" (vision_models::Action::ALL lists them)"
    )]
    UnknownAction {
        /// The name that was given.
        name: String,
    },
    /// A name that is no surface.
    #[error("unknown surface \"{name}\": give \"smooth\" or \"drilled\"")]
    UnknownSurface {
        /// The name that was given.
        name: String,
    },
    /// A confidence that is no probability.
    #[error("confidence {value} is not in [0, 1]")]
    Confidence {
        /// The value that was given.
        value: f64,
    },
    /// A time stamp that is NaN or infinite.
    #[error("time stamp {time} s is not finite")]
    Time {
        /// The time stamp that was given (s).
        time: f64,
    },
    /// A percept that is not younger than the one before.
    #[error(
        "time stamp {time} s is not later than {previous} s of the percept before: \
         give percepts in the order in which the camera took them"
    )]
    TimeOrder {
        /// The time stamp that was given (s).
        time: f64,
        /// The time stamp of the percept before (s).
        previous: f64,
    },
    /// A setting outside its range.
    #[error("setting {name} = {value}: give {expected}")]
    Setting {
        /// The field's name.
        name: &'static str,
        /// The value that was given.
        value: f64,
        /// The values that are right.
        expected: &'static str,
    },
}
