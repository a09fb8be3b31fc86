//! Errors of this crate.

use hrsw_safety::FrameFault;
use thiserror::Error;
use vision_models::ImpossibleBody;
use whole_body::{Base, Model};

use crate::box_side::BoxSide;

/// Error with its place, and what would be right.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum Error {
    /// A number is out of its range.
    #[error("{what} is {got}; it must be {wanted}")]
    Value {
        /// Name of the number; the path of a setting.
        what: String,
        /// Value given.
        got: f64,
        /// The range it must lie in.
        wanted: &'static str,
    },

    /// A vector has the wrong number of elements.
    #[error("{what} has {got} elements; the robot needs {wanted}")]
    Size {
        /// Name of the vector.
        what: &'static str,
        /// Number it has.
        got: usize,
        /// Number it must have.
        wanted: usize,
    },

    /// The robot has a floating base.
    #[error(
        "robot `{robot}` is on a floating base, whose q has more entries than its q̇; take a fixed or \
         a planar one"
    )]
    FloatingBase {
        /// The robot's name in the URDF.
        robot: String,
    },

    /// A body of the robot is on a link beside the chain to the tool.
    #[error(
        "the joints that move link `{link}` are not the first on the way to tool `{tool}`, so that \
         the tool's Jacobian does not say how a body on it moves; hold them, or leave the body out"
    )]
    BodyBesideTheWay {
        /// The link that carries the body.
        link: String,
        /// The tool.
        tool: String,
    },

    /// A link of a pair of own bodies has no body.
    #[error("no capsule is on link `{link}`, which is to stay away from another link; give it one")]
    NoBody {
        /// The link.
        link: String,
    },

    /// The object has no side to work on.
    #[error("the object has no face to work on; give it at least one")]
    NoFace,

    /// The object has two surfaces on one side.
    #[error("the object has two surfaces on its side {side:?}; give it one for each side")]
    TwoFacesOnOneSide {
        /// The side.
        side: BoxSide,
    },

    /// The robot responds to torques too late to be controlled.
    #[error(
        "the robot answers {:.1} ms late; springs and dampers swing beyond {:.1} ms, so shorten the line to the robot \
         or run the loop beside it",
        1e3 * delay, 1e3 * longest
    )]
    AnswersLate {
        /// The delay \[s\].
        delay: f64,
        /// The longest allowed delay \[s\].
        longest: f64,
    },

    /// The robot does not respond to torques.
    #[error(
        "joint `{joint}` does not move when {torque:.3} Nm push it; release its brakes, and check that the interface takes \
         torques"
    )]
    NoAnswer {
        /// The joint that was pushed.
        joint: String,
        /// The torque of the push \[Nm\].
        torque: f64,
    },

    /// A camera frame counts as no data because of its time.
    #[error(
        "{fault}: it is stamped {stamp} s, {}; stamp frames when they are taken, on the clock of the \
         ticks, and give each once and in order",
        present(*now, *newest)
    )]
    Frame {
        /// Fault of the frame.
        fault: FrameFault,
        /// Stamp of the frame \[s\].
        stamp: f64,
        /// The time of the last tick \[s\].
        now: Option<f64>,
        /// The stamp of the newest frame \[s\].
        newest: Option<f64>,
    },

    /// A camera frame counts as no data because it shows an impossible body.
    #[error("{fault}: {body}")]
    Body {
        /// Fault of the frame.
        fault: FrameFault,
        /// Fault of the body.
        body: ImpossibleBody,
    },

    /// The robot's URDF, its description or a configuration was refused.
    #[error(transparent)]
    Robot(#[from] whole_body::Error),

    /// The hierarchy or a limit was refused.
    #[error(transparent)]
    Hierarchy(#[from] ahqp_core::Error),

    /// The shared workspace was refused.
    #[error(transparent)]
    Workspace(#[from] hrsw::Error),

    /// A safety setting, a setting of the clock, or the people of a camera frame were refused.
    #[error(transparent)]
    Safety(#[from] hrsw_safety::Error),

    /// The ergonomics were refused.
    #[error(transparent)]
    Ergonomics(#[from] ergo_map::Error),

    /// A percept or the tracker's settings were refused.
    #[error(transparent)]
    Perception(#[from] vision_models::Error),
}

fn present(now: Option<f64>, newest: Option<f64>) -> String {
    let time = |time: Option<f64>| time.map_or("none yet".to_owned(), |time| format!("{time} s"));
    format!("the last tick {}, the newest frame {}", time(now), time(newest))
}

/// Returns an error unless `slice` has `wanted` elements.
pub(crate) fn check_size(what: &'static str, slice: &[f64], wanted: usize) -> Result<(), Error> {
    let got = slice.len();
    if got == wanted { Ok(()) } else { Err(Error::Size { what, got, wanted }) }
}

/// Returns an error for the first setting whose value is not what is `wanted`.
pub(crate) fn check_settings(
    settings: impl IntoIterator<Item = (&'static str, f64)>,
    wanted: &'static str,
    fits: impl Fn(f64) -> bool,
) -> Result<(), Error> {
    let wrong = settings.into_iter().find(|(_, value)| !fits(*value));
    wrong.map_or(Ok(()), |(name, got)| Err(Error::Value { what: name.to_owned(), got, wanted }))
}

/// Returns an error for the first setting that is not positive and finite.
pub(crate) fn check_positive(
    settings: impl IntoIterator<Item = (&'static str, f64)>,
) -> Result<(), Error> {
    check_settings(settings, "positive and finite", |value| value > 0.0 && value.is_finite())
}

/// Returns an error for the first setting that is negative or not finite.
pub(crate) fn check_not_negative(
    settings: impl IntoIterator<Item = (&'static str, f64)>,
) -> Result<(), Error> {
    let wanted = "finite and not negative";
    check_settings(settings, wanted, |value| value >= 0.0 && value.is_finite())
}

/// Returns n, the size of q and q̇, or an error if they differ.
pub(crate) fn check_plain(model: &Model) -> Result<usize, Error> {
    if model.base() == Base::Floating {
        return Err(Error::FloatingBase { robot: model.name().to_owned() });
    }
    Ok(model.velocity_count())
}
