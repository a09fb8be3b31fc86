//! What can be wrong with what this crate is given.

use hrsw::FrameFault;
use thiserror::Error;

/// What was wrong, where, and what would be right.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum Error {
    /// The text is not a URDF.
    #[error("the URDF cannot be read: {reason}; give the text of a well-formed URDF file")]
    Urdf {
        /// What the reader said.
        reason: String,
    },

    /// A link is asked for that the URDF does not have.
    #[error("{role} `{link}` is no link of robot `{robot}`; its links are {known}")]
    UnknownLink {
        /// The name asked for.
        link: String,
        /// What it was to be.
        role: &'static str,
        /// The robot's name in the URDF.
        robot: String,
        /// The links that there are.
        known: String,
    },

    /// A joint is asked for that the URDF does not have.
    #[error("`{joint}`, named in `{list}`, is no joint of robot `{robot}`; its joints are {known}")]
    UnknownJoint {
        /// The name asked for.
        joint: String,
        /// The field of the description that names it.
        list: &'static str,
        /// The robot's name in the URDF.
        robot: String,
        /// The joints that there are.
        known: String,
    },

    /// Two links or two joints have one name.
    #[error("the URDF has more than one {element} named `{name}`; names must be unique")]
    DuplicateName {
        /// `link` or `joint`.
        element: &'static str,
        /// The name.
        name: String,
    },

    /// A link is the child of two joints.
    #[error(
        "link `{link}` is the child of joints `{first}` and `{second}`; a link hangs on one joint"
    )]
    TwoParents {
        /// The link.
        link: String,
        /// A joint that carries it.
        first: String,
        /// Another one.
        second: String,
    },

    /// The joints go round in a circle.
    #[error("the joints above link `{link}` form a loop; a robot is a tree")]
    Loop {
        /// A link from which going up does not end.
        link: String,
    },

    /// Going from the tool towards the root does not reach the root.
    #[error(
        "no path from root `{root}` to tool `{tool}`: going up from the tool ends at `{reached}`; \
         add the missing joint or name another root"
    )]
    NoPath {
        /// The root link.
        root: String,
        /// The tool link.
        tool: String,
        /// Where the way up from the tool ended.
        reached: String,
    },

    /// A joint's type is none that this crate can move.
    #[error(
        "joint `{joint}` is {kind}; use fixed, prismatic, revolute and continuous joints \
         (a planar or floating one is a chain of these), or hold a mimic joint at a position"
    )]
    UnsupportedJoint {
        /// The joint.
        joint: String,
        /// Its type in the URDF.
        kind: &'static str,
    },

    /// The listed joints are not those that move the tool.
    #[error(
        "the joints that move the tool are {expected}, from root to tool, but the description \
         lists {given}; list these in this order, or hold the others at a position"
    )]
    JointOrder {
        /// The movable joints from the root to the tool.
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

    /// No joint moves the tool.
    #[error("no joint moves tool `{tool}` against root `{root}`; a robot needs one at least")]
    NoJoints {
        /// The root link.
        root: String,
        /// The tool link.
        tool: String,
    },

    /// A joint's axis has no direction.
    #[error("the axis of joint `{joint}` is zero; give it a direction, such as xyz=\"0 0 1\"")]
    ZeroAxis {
        /// The joint.
        joint: String,
    },

    /// A number is NaN or infinite.
    #[error("{what} is {value}; it must be a finite number")]
    NotFinite {
        /// Which number.
        what: String,
        /// Its value.
        value: f64,
    },

    /// A mass is negative.
    #[error("link `{link}` has mass {mass} kg; a mass is zero or positive")]
    NegativeMass {
        /// The link.
        link: String,
        /// Its mass \[kg\].
        mass: f64,
    },

    /// A joint has no limits, neither in the URDF nor in the description.
    #[error(
        "joint `{joint}` has no limits; add <limit lower=… upper=… velocity=… effort=…/> to the \
         URDF or give them in the description"
    )]
    LimitsMissing {
        /// The joint.
        joint: String,
    },

    /// A joint's range of positions is empty.
    #[error(
        "joint `{joint}` may move from {lower} to {upper}; the lower limit must be below the \
         upper one (a joint that does not move is fixed or held)"
    )]
    PositionLimits {
        /// The joint.
        joint: String,
        /// Lower limit \[rad or m\].
        lower: f64,
        /// Upper limit \[rad or m\].
        upper: f64,
    },

    /// A limit or parameter that must be positive is not.
    #[error("{what} is {value}; it must be positive")]
    NotPositive {
        /// Which one.
        what: String,
        /// Its value.
        value: f64,
    },

    /// A limit or parameter is negative.
    #[error("{what} is {value}; it must be zero or positive")]
    Negative {
        /// Which one.
        what: String,
        /// Its value.
        value: f64,
    },

    /// A vector has the wrong number of elements.
    #[error("{what} has {got} elements; the robot needs {expected}")]
    WrongSize {
        /// Which vector.
        what: &'static str,
        /// How many it must have.
        expected: usize,
        /// How many it has.
        got: usize,
    },

    /// Data and model are not of the same robot.
    #[error(
        "the data has room for {got} joints and the model has {expected}; use RobotData::new(&model)"
    )]
    ForeignData {
        /// Joints of the model.
        expected: usize,
        /// Joints of the data.
        got: usize,
    },

    /// A link handle comes from another model.
    #[error(
        "link number {index} is none of the {count} links; get handles from this model's `link`"
    )]
    ForeignLink {
        /// The handle's number.
        index: usize,
        /// Links of the model.
        count: usize,
    },

    /// A setting of the controller is out of its range.
    #[error("setting {name} is {value}; it must be {expected}")]
    Setting {
        /// The setting.
        name: &'static str,
        /// Its value.
        value: f64,
        /// The range it must lie in.
        expected: &'static str,
    },

    /// The robot has another number of joints than the part that is to control it.
    #[error("{what} has {found} entries, but the robot has {expected} joints")]
    JointCount {
        /// The offending item.
        what: &'static str,
        /// How many entries it has.
        found: usize,
        /// The robot's joints.
        expected: usize,
    },

    /// A camera frame counts as no data, because of its time.
    #[error(
        "{fault}: it is stamped {stamp} s, {}; stamp frames when they are taken, on the clock of the \
         ticks, and give each once and in order",
        present(*now, *newest)
    )]
    Frame {
        /// What is wrong with it.
        fault: FrameFault,
        /// Its stamp \[s\].
        stamp: f64,
        /// The time of the last tick \[s\].
        now: Option<f64>,
        /// The stamp of the newest frame \[s\].
        newest: Option<f64>,
    },

    /// The hierarchy or a limit was refused.
    #[error(transparent)]
    Hierarchy(#[from] ahqp_core::Error),

    /// The shared workspace was refused.
    #[error(transparent)]
    Workspace(#[from] hrsw::Error),

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

/// An error unless `value` is finite; `what` is asked for only then.
pub(crate) fn check_finite(value: f64, what: impl FnOnce() -> String) -> Result<(), Error> {
    if value.is_finite() { Ok(()) } else { Err(Error::NotFinite { what: what(), value }) }
}

/// An error unless `slice` has `expected` elements.
pub(crate) fn check_size(what: &'static str, slice: &[f64], expected: usize) -> Result<(), Error> {
    if slice.len() == expected {
        Ok(())
    } else {
        Err(Error::WrongSize { what, expected, got: slice.len() })
    }
}

/// An error unless `found` is `expected`, the robot's number of joints.
pub(crate) fn check_count(what: &'static str, found: usize, expected: usize) -> Result<(), Error> {
    if found == expected { Ok(()) } else { Err(Error::JointCount { what, found, expected }) }
}

/// An error unless `value` is positive; infinity is.
pub(crate) fn check_positive(value: f64, what: &str) -> Result<(), Error> {
    if value > 0.0 { Ok(()) } else { Err(Error::NotPositive { what: what.to_owned(), value }) }
}
