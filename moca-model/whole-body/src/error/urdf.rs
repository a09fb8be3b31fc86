//! What can be wrong with a URDF.

use thiserror::Error;

/// What is wrong with a URDF, on which line, and what would be right.
///
/// Lines count from 1.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum UrdfError {
    /// The text is no well-formed XML.
    #[error("line {line}: the XML is broken: {reason}")]
    Xml {
        /// Where.
        line: usize,
        /// What the reader said.
        reason: String,
    },

    /// The text ends before the robot does.
    #[error("line {line}: the text ends within <{element}>; the file may have been cut")]
    Truncated {
        /// The last line.
        line: usize,
        /// The element that is not closed.
        element: String,
    },

    /// The document has no robot, or something beside it.
    #[error("line {line}: {found}; a URDF is one <robot> element")]
    NotAUrdf {
        /// Where.
        line: usize,
        /// What stands there.
        found: String,
    },

    /// The file is not of UTF-8 text.
    #[error("the file is {found} text; save it as UTF-8")]
    Encoding {
        /// What it is.
        found: &'static str,
    },

    /// An element or attribute that is needed is not there.
    #[error("line {line}: {owner} has no {missing}")]
    Missing {
        /// Where the owner begins.
        line: usize,
        /// The element that should have it.
        owner: String,
        /// What it should have.
        missing: &'static str,
    },

    /// An attribute is not what it must be.
    #[error("line {line}: {what} is \"{value}\"; it must be {expected}")]
    Attribute {
        /// Where.
        line: usize,
        /// Which one, of which element.
        what: String,
        /// What it is.
        value: String,
        /// What it must be.
        expected: &'static str,
    },

    /// A link is the child of two joints.
    #[error(
        "line {line}: link `{link}` is the child of joints `{first}` and `{second}`; a link hangs \
         on one joint"
    )]
    TwoParents {
        /// Where the second joint begins.
        line: usize,
        /// The link.
        link: String,
        /// A joint that carries it.
        first: String,
        /// Another one.
        second: String,
    },

    /// The joints go round in a circle.
    #[error(
        "line {line}: the joints above link `{link}` form a loop, joint `{joint}` among them; a \
         robot is a tree"
    )]
    Loop {
        /// Where the joint begins.
        line: usize,
        /// A link from which going up does not end.
        link: String,
        /// The joint that carries it.
        joint: String,
    },

    /// The URDF has no link.
    #[error("robot `{robot}` has no link")]
    NoLinks {
        /// The robot's name.
        robot: String,
    },

    /// Two links hang on no joint.
    #[error(
        "links `{first}` (line {first_line}) and `{second}` (line {second_line}) both hang on no \
         joint; join them, or name the one to start from as the description's `root`"
    )]
    TwoRoots {
        /// A link without a parent.
        first: String,
        /// Where it begins.
        first_line: usize,
        /// Another one.
        second: String,
        /// Where it begins.
        second_line: usize,
    },

    /// A joint's type is none that this crate can move.
    #[error(
        "line {line}: joint `{joint}` is {kind}; use fixed, prismatic, revolute and continuous \
         joints, hold the joint at a position, or start from the link that it carries with a \
         planar or floating base"
    )]
    UnsupportedJoint {
        /// Where the joint begins.
        line: usize,
        /// The joint.
        joint: String,
        /// Its type in the URDF.
        kind: String,
    },

    /// A joint mimics one that, in the end, mimics it.
    #[error("line {line}: joint `{joint}` mimics itself; a mimic joint follows a joint that moves")]
    MimicLoop {
        /// Where the joint begins.
        line: usize,
        /// The joint.
        joint: String,
    },

    /// A joint's axis has no direction.
    #[error(
        "line {line}: the axis of joint `{joint}` is zero; give it a direction, such as \
         xyz=\"0 0 1\""
    )]
    ZeroAxis {
        /// Where the joint begins.
        line: usize,
        /// The joint.
        joint: String,
    },

    /// A joint has no limits, neither in the URDF nor in the description.
    #[error(
        "line {line}: joint `{joint}` has no {missing}; add <limit lower=… upper=… velocity=… \
         effort=…/> to the URDF, or give the limit in the description"
    )]
    LimitsMissing {
        /// Where the joint begins.
        line: usize,
        /// The joint.
        joint: String,
        /// Which limit.
        missing: &'static str,
    },
}
