//! Errors of this crate.

pub(crate) mod urdf;

use std::borrow::Cow;
use std::path::PathBuf;

use thiserror::Error;

use self::urdf::UrdfError;

/// Error with its place, and what would be right.
///
/// Lines count from 1.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum Error {
    /// A file cannot be read.
    #[error("{}: the file cannot be read: {source}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// Error of the operating system.
        source: std::io::Error,
    },

    /// The content of a file is wrong.
    #[error("{}: {source}", path.display())]
    InFile {
        /// The file.
        path: PathBuf,
        /// Error behind it.
        source: Box<Error>,
    },

    /// A URDF is wrong.
    #[error(transparent)]
    Urdf(#[from] UrdfError),

    /// Two links, two joints or two frames have the same name.
    #[error("{}there is more than one {element} named `{name}`; names must be unique", at_line(*line))]
    DuplicateName {
        /// Line on which the second one begins, if the URDF has it.
        line: Option<usize>,
        /// `link` or `joint`.
        element: &'static str,
        /// The name.
        name: String,
    },

    /// The robot has no link, frame or joint of this name.
    #[error(
        "{}{role} `{name}` is no {element} of robot `{robot}`; its {element}s are {known}",
        at_line(*line)
    )]
    UnknownName {
        /// Line on which the joint of the URDF that gives the name begins, if there is one.
        line: Option<usize>,
        /// `link`, `frame` or `joint`.
        element: &'static str,
        /// The name asked for.
        name: String,
        /// The role of the element that was asked for.
        role: &'static str,
        /// The robot's name in the URDF.
        robot: String,
        /// The names that exist, the most similar first.
        known: String,
    },

    /// The path from a tip towards the root does not reach the root.
    #[error(
        "no path from root `{root}` to tip `{tip}`: going up from the tip ends at `{reached}`; \
         add the missing joint or name another root"
    )]
    NoPath {
        /// The root link.
        root: String,
        /// The tip link.
        tip: String,
        /// Link at which the path from the tip ended.
        reached: String,
    },

    /// The listed joints are not the joints that move.
    #[error(
        "the joints that move are {wanted}, but the description lists {got}; list these in \
         this order, or hold the others at a position"
    )]
    JointOrder {
        /// Names that the description lists.
        got: String,
        /// The joints that move, in the order of q.
        wanted: String,
    },

    /// A joint is listed both as moving and as locked.
    #[error(
        "joint `{joint}` is listed among the moving joints and locked at a position; do either"
    )]
    LockedAndMoving {
        /// The joint.
        joint: String,
    },

    /// No joint moves.
    #[error(
        "no joint of robot `{robot}` moves below root `{root}`; a robot on a fixed base needs one"
    )]
    NoJoints {
        /// The robot's name in the URDF.
        robot: String,
        /// The root link.
        root: String,
    },

    /// A limit of a joint is out of its range.
    #[error("{}the {what} limit of joint `{joint}` is {got}; it must be {wanted}", at_line(*line))]
    Limit {
        /// Line on which the joint begins, if the URDF has it.
        line: Option<usize>,
        /// The joint.
        joint: String,
        /// Name of the limit: `upper`, where the range of positions is empty, `velocity`, `acceleration`, `jerk` or
        /// `effort`.
        what: &'static str,
        /// The limit, in units of its kind: rad or m, their rates, or Nm or N.
        got: f64,
        /// The allowed range.
        wanted: Cow<'static, str>,
    },

    /// The effort limit of a joint that is driven by torque is not known.
    #[error(
        "the effort limit of joint `{joint}` is not known, for its URDF states 0 or none; torques need \
         it: give it among the description's limits"
    )]
    UnknownEffort {
        /// The joint.
        joint: String,
    },

    /// A vector or matrix has the wrong size.
    #[error("{what} has {got} elements; the robot needs {wanted}")]
    Size {
        /// Name of the vector.
        what: &'static str,
        /// Number it has.
        got: usize,
        /// Number it must have.
        wanted: usize,
    },

    /// Data and model are not of the same robot.
    #[error("the data was made for another model than `{robot}`; use Data::new(&model)")]
    ForeignData {
        /// The model's robot.
        robot: String,
    },

    /// The data have not been given a configuration.
    #[error("the data have not been given a configuration yet; call Data::pose first")]
    NeverPosed,

    /// An id comes from another model.
    #[error("the id of a {element} is of another model than `{robot}`; ask this model for it")]
    ForeignId {
        /// `frame`, `joint` or `payload`.
        element: &'static str,
        /// The model's robot.
        robot: String,
    },

    /// There is no room for another payload.
    #[error("{limit} payloads are attached already; detach one first")]
    TooManyPayloads {
        /// The largest number of payloads.
        limit: usize,
    },

    /// Forces do not determine the motion, because a joint moves no inertia.
    #[error(
        "the mass matrix is not positive definite at joint `{joint}`: what it moves has no inertia, \
         or one of no body (see `Model::warnings`); give its links a mass or hold the joint"
    )]
    NoInertia {
        /// The joint.
        joint: String,
    },

    /// A task or a limit cannot do what it is asked.
    #[error("task `{task}` of level `{level}`: {source}")]
    InTask {
        /// The task.
        task: String,
        /// Level; `limits` for a hard limit.
        level: String,
        /// Error behind it.
        source: Box<Error>,
    },

    /// A task has no target.
    #[error("its target was never set; set it before the first step, or hold what there is")]
    TargetMissing,

    /// A number is out of its range.
    #[error("{what} is {got}; it must be {wanted}")]
    Value {
        /// Name of the number.
        what: String,
        /// Value given.
        got: f64,
        /// The range it must lie in.
        wanted: Cow<'static, str>,
    },

    /// The robot cannot do what is asked of it.
    #[error("{what}; {remedy}")]
    Unsuitable {
        /// Reason why the robot cannot do it.
        what: String,
        /// Remedy.
        remedy: &'static str,
    },

    /// A stack, a level or a task has nothing to do.
    #[error("{what}; give at least one")]
    Nothing {
        /// Name of the part that has nothing.
        what: String,
    },

    /// The system does not grant what was asked for a thread.
    #[error("the system refuses {what} ({reason}); {remedy}")]
    Refused {
        /// Request that failed.
        what: &'static str,
        /// Reason that the system gives.
        reason: String,
        /// Remedy.
        remedy: &'static str,
    },

    /// A level has both tasks of rows and tasks of quadratics.
    #[error(
        "level `{level}` has tasks of rows and quadratic ones; push them on levels of their own"
    )]
    MixedLevel {
        /// The level.
        level: String,
    },

    /// Two levels, or two tasks of one level, have the same name.
    #[error("there is a {element} named `{name}` already; names must be unique")]
    NameTaken {
        /// `level`, `task` or `limit`.
        element: &'static str,
        /// The name.
        name: String,
    },

    /// There is no task with this id.
    #[error("the id of a task is of another stack; take the one that `push` returned")]
    UnknownTask,

    /// The solver refused the problem.
    #[error(transparent)]
    Hierarchy(#[from] ahqp_core::Error),
}

impl Error {
    /// Creates the error for a number out of its range.
    pub(crate) fn value(
        what: impl Into<String>,
        got: f64,
        wanted: impl Into<Cow<'static, str>>,
    ) -> Self {
        Self::Value { what: what.into(), got, wanted: wanted.into() }
    }

    /// Creates the error for a number that is not positive.
    pub(crate) fn not_positive(what: impl Into<String>, value: f64) -> Self {
        Self::value(what, value, "positive")
    }

    /// Creates the error for a number that is NaN, infinite, or so large that results would be.
    pub(crate) fn not_finite(what: impl Into<String>, value: f64) -> Self {
        Self::value(what, value, "a finite number of magnitude 1e12 at most")
    }

    /// Creates the error for a gain that overshoots within a period.
    pub(crate) fn too_high(gain: f64, period: f64) -> Self {
        let what = format!("a gain at a control period of {period} s");
        Self::value(what, gain, "1/period at most [1/s], or it overshoots")
    }

    /// Creates the error for a robot that cannot do what is asked of it.
    pub(crate) fn unsuitable(what: impl Into<String>, remedy: &'static str) -> Self {
        Self::Unsuitable { what: what.into(), remedy }
    }

    /// Creates the error for a joint of six degrees of freedom where one is needed.
    pub(crate) fn floating_joint(joint: &str) -> Self {
        let what = format!("joint `{joint}` has six degrees of freedom");
        Self::unsuitable(what, "name joints that turn or slide")
    }

    /// Returns whether the error is about a limit that cannot be meant. Such a limit counts as unlimited under
    /// [`UnusableLimits::Ignore`](crate::robot::UnusableLimits::Ignore). Programs name their own option for that.
    pub fn is_unusable_limit(&self) -> bool {
        match self {
            Self::InFile { source, .. } => source.is_unusable_limit(),
            Self::Limit { line, what, .. } => {
                line.is_some() && ["upper", "velocity", "effort"].contains(what)
            }
            Self::Urdf(UrdfError::LimitsMissing { .. }) => true,
            _ => false,
        }
    }
}

fn at_line(line: Option<usize>) -> String {
    line.map_or_else(String::new, |line| format!("line {line}: "))
}

/// Larger numbers are refused, so that their squares and products stay finite.
const LARGEST: f64 = 1e12;

/// Returns true if `value` is finite and of sensible size.
#[inline]
pub(crate) fn is_sensible(value: f64) -> bool {
    value.abs() <= LARGEST
}

/// Returns an error unless `value` is finite and of sensible size. `what` is called only then.
#[inline]
pub(crate) fn check_finite(value: f64, what: impl FnOnce() -> String) -> Result<(), Error> {
    if is_sensible(value) { Ok(()) } else { Err(Error::not_finite(what(), value)) }
}

/// Returns an error unless `got` is `wanted`.
#[inline]
pub(crate) fn check_size(what: &'static str, got: usize, wanted: usize) -> Result<(), Error> {
    if got == wanted { Ok(()) } else { Err(Error::Size { what, got, wanted }) }
}
