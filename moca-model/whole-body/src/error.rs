//! What can be wrong with what this crate is given.

pub(crate) mod urdf;

use std::path::PathBuf;

use thiserror::Error;

use self::urdf::UrdfError;

/// What was wrong, where, and what would be right.
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
        /// What the operating system says.
        source: std::io::Error,
    },

    /// What a file says is wrong.
    #[error("{}: {source}", path.display())]
    InFile {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        source: Box<Error>,
    },

    /// A URDF is wrong.
    #[error(transparent)]
    Urdf(#[from] UrdfError),

    /// Two links, two joints or two frames have one name.
    #[error("{}there is more than one {element} named `{name}`; names must be unique", at_line(*line))]
    DuplicateName {
        /// Where the second one begins, if the URDF has it.
        line: Option<usize>,
        /// `link` or `joint`.
        element: &'static str,
        /// The name.
        name: String,
    },

    /// A link, frame or joint is asked for that the robot does not have.
    #[error(
        "{}{role} `{name}` is no {element} of robot `{robot}`; its {element}s are {known}",
        at_line(*line)
    )]
    UnknownName {
        /// Where the joint of the URDF begins that gives the name, if it is one.
        line: Option<usize>,
        /// `link`, `frame` or `joint`.
        element: &'static str,
        /// The name asked for.
        name: String,
        /// What it was to be.
        role: &'static str,
        /// The robot's name in the URDF.
        robot: String,
        /// The names that there are, the most similar first.
        known: String,
    },

    /// Going from a tip towards the root does not reach the root.
    #[error(
        "no path from root `{root}` to tip `{tip}`: going up from the tip ends at `{reached}`; \
         add the missing joint or name another root"
    )]
    NoPath {
        /// The root link.
        root: String,
        /// The tip link.
        tip: String,
        /// Where the way up from the tip ended.
        reached: String,
    },

    /// The listed joints are not those that move.
    #[error(
        "the joints that move are {expected}, but the description lists {given}; list these in \
         this order, or hold the others at a position"
    )]
    JointOrder {
        /// The joints that move, in the order of q.
        expected: String,
        /// What the description lists.
        given: String,
    },

    /// A joint is both listed as moving and held.
    #[error("joint `{joint}` is listed among the moving joints and held at a position; do either")]
    HeldAndMoving {
        /// The joint.
        joint: String,
    },

    /// Nothing moves.
    #[error(
        "no joint of robot `{robot}` moves below root `{root}`; a robot on a fixed base needs one"
    )]
    NoJoints {
        /// The robot's name in the URDF.
        robot: String,
        /// The root link.
        root: String,
    },

    /// A joint's range of positions is empty.
    #[error(
        "{}joint `{joint}` may move from {lower} to {upper}; the lower limit must be \
         below the upper one (a joint that does not move is fixed or held)",
        at_line(*line)
    )]
    PositionLimits {
        /// Where the joint begins, if the URDF has it.
        line: Option<usize>,
        /// The joint.
        joint: String,
        /// Lower limit \[rad or m\].
        lower: f64,
        /// Upper limit \[rad or m\].
        upper: f64,
    },

    /// A limit that must be positive is not.
    #[error(
        "{}the {limit} limit of joint `{joint}` is {value}; it must be positive",
        at_line(*line)
    )]
    LimitNotPositive {
        /// Where the joint begins, if the URDF has it.
        line: Option<usize>,
        /// The joint.
        joint: String,
        /// Which limit.
        limit: &'static str,
        /// Its value.
        value: f64,
    },

    /// The effort limit of a joint that torque drives is not known.
    #[error(
        "the effort limit of joint `{joint}` is not known, for its URDF states 0 or none; torques need \
         it: give it among the description's limits"
    )]
    UnknownEffort {
        /// The joint.
        joint: String,
    },

    /// A measured number is far beyond what the robot can reach.
    #[error("the {what} of {joint} is {value}, far beyond its {limit}; give {unit}")]
    Units {
        /// `position` or `velocity`.
        what: &'static str,
        /// The joint, or the base's axis.
        joint: String,
        /// Its value.
        value: f64,
        /// The limit that is next to it.
        limit: f64,
        /// What it should be in, and what it may be in.
        unit: &'static str,
    },

    /// A vector or matrix has the wrong size.
    #[error("{what} has {got} elements; the robot needs {expected}")]
    WrongSize {
        /// Which one.
        what: &'static str,
        /// How many it must have.
        expected: usize,
        /// How many it has.
        got: usize,
    },

    /// Data and model are not of the same robot.
    #[error("the data was made for another model than `{robot}`; use Data::new(&model)")]
    ForeignData {
        /// The model's robot.
        robot: String,
    },

    /// Data have not seen a configuration.
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

    /// There is no room for one more payload.
    #[error("{limit} payloads are attached already; detach one first")]
    TooManyPayloads {
        /// How many there may be.
        limit: usize,
    },

    /// No force moves the robot in a definite way, for a joint carries no inertia.
    #[error(
        "the mass matrix is not positive definite at joint `{joint}`: what it moves has no inertia, \
         or one of no body (see `Model::warnings`); give its links a mass or hold the joint"
    )]
    NoInertia {
        /// The joint.
        joint: String,
    },

    /// A task, or a limit, cannot do what it is asked.
    #[error("task `{task}` of level `{level}`: {source}")]
    InTask {
        /// The task.
        task: String,
        /// Its level; `limits` for a hard limit.
        level: String,
        /// What is wrong.
        source: Box<Error>,
    },

    /// A task does not know where to go.
    #[error("its target was never set; set it before the first step, or hold what there is")]
    TargetMissing,

    /// A number is out of its range.
    #[error("{what} is {value}; it must be {expected}")]
    Value {
        /// Which one.
        what: String,
        /// Its value.
        value: f64,
        /// The range it must lie in.
        expected: &'static str,
    },

    /// A robot cannot do what is asked of it.
    #[error("{what}; {remedy}")]
    Unsuitable {
        /// What stands against it.
        what: String,
        /// What would help.
        remedy: &'static str,
    },

    /// A stack, a level or a task has nothing to do.
    #[error("{what}; give at least one")]
    Nothing {
        /// What has nothing.
        what: String,
    },

    /// The system does not grant what a thread asks for.
    #[error("the system refuses {what} ({reason}); {remedy}")]
    Refused {
        /// What was asked for.
        what: &'static str,
        /// What the system says.
        reason: String,
        /// What would help.
        remedy: &'static str,
    },

    /// A row of velocities has bounds that leave nothing between them.
    #[error(
        "row {row} must lie from {lower} to {upper}; order the bounds, and use an infinite one for \
         a side that is free"
    )]
    RowRange {
        /// The row.
        row: usize,
        /// Its lower bound.
        lower: f64,
        /// Its upper bound.
        upper: f64,
    },

    /// A level has rows and quadratics to minimise.
    #[error(
        "level `{level}` has tasks of rows and quadratic ones; push them on levels of their own"
    )]
    MixedLevel {
        /// The level.
        level: String,
    },

    /// Two levels, or two tasks of one level, have one name.
    #[error("there is a {element} named `{name}` already; names must be unique")]
    NameTaken {
        /// `level`, `task` or `limit`.
        element: &'static str,
        /// The name.
        name: String,
    },

    /// There is no such task.
    #[error("the id of a task is of another stack; take the one that `push` returned")]
    UnknownTask,

    /// The measured state cannot be used; the robot brakes.
    #[error("the robot brakes: {source}")]
    Braking {
        /// What is wrong.
        source: Box<Error>,
    },

    /// What the solver refused.
    #[error(transparent)]
    Hierarchy(#[from] ahqp_core::Error),
}

impl Error {
    /// A number out of its range.
    pub(crate) fn value(what: impl Into<String>, value: f64, expected: &'static str) -> Self {
        Self::Value { what: what.into(), value, expected }
    }

    /// A number that is not positive.
    pub(crate) fn not_positive(what: impl Into<String>, value: f64) -> Self {
        Self::value(what, value, "positive")
    }

    /// A number that is NaN, infinite, or so large that results would be.
    pub(crate) fn not_finite(what: impl Into<String>, value: f64) -> Self {
        Self::value(what, value, "a finite number of magnitude 1e12 at most")
    }

    /// A gain that overshoots within a period.
    pub(crate) fn too_high(gain: f64, period: f64) -> Self {
        let what = format!("a gain at a control period of {period} s");
        Self::value(what, gain, "1/period at most [1/s], or it overshoots")
    }

    /// A robot that cannot do what is asked of it.
    pub(crate) fn unsuitable(what: impl Into<String>, remedy: &'static str) -> Self {
        Self::Unsuitable { what: what.into(), remedy }
    }

    /// A joint of six degrees of freedom, where one is needed.
    pub(crate) fn floating_joint(joint: &str) -> Self {
        let what = format!("joint `{joint}` has six degrees of freedom");
        Self::unsuitable(what, "name joints that turn or slide")
    }

    /// Whether it is about a limit that cannot be meant, which
    /// [`UnusableLimits::Ignore`](crate::robot::UnusableLimits::Ignore) takes for unlimited. Programs name their own option
    /// for that.
    pub fn is_unusable_limit(&self) -> bool {
        match self {
            Self::InFile { source, .. } => source.is_unusable_limit(),
            Self::PositionLimits { line, .. } => line.is_some(),
            Self::LimitNotPositive { line, limit, .. } => {
                line.is_some() && ["velocity", "effort"].contains(limit)
            }
            Self::Urdf(UrdfError::LimitsMissing { .. }) => true,
            _ => false,
        }
    }
}

fn at_line(line: Option<usize>) -> String {
    line.map_or_else(String::new, |line| format!("line {line}: "))
}

/// Numbers above this are refused: squares and products of them stay finite.
const LARGEST: f64 = 1e12;

/// Returns true if `value` is a number of sensible size.
#[inline]
pub(crate) fn is_sensible(value: f64) -> bool {
    value.abs() <= LARGEST
}

/// An error unless `value` is a number of sensible size; `what` is asked for only then.
#[inline]
pub(crate) fn check_finite(value: f64, what: impl FnOnce() -> String) -> Result<(), Error> {
    if is_sensible(value) { Ok(()) } else { Err(Error::not_finite(what(), value)) }
}

/// An error unless there are `expected` elements.
#[inline]
pub(crate) fn check_size(what: &'static str, got: usize, expected: usize) -> Result<(), Error> {
    if got == expected { Ok(()) } else { Err(Error::WrongSize { what, expected, got }) }
}
