//! Errors of a URDF.

use thiserror::Error;

/// Error of a URDF with its line, and what would be right.
///
/// Lines count from 1.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum UrdfError {
    /// The text is not well-formed XML.
    #[error("line {line}: the XML is broken: {reason}")]
    Xml {
        /// The line.
        line: usize,
        /// Report of the XML reader.
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
        /// The line.
        line: usize,
        /// Content that stands there.
        found: String,
    },

    /// The file is not UTF-8 text.
    #[error("the file is {found} text; save it as UTF-8")]
    Encoding {
        /// Encoding of the file.
        found: &'static str,
    },

    /// A required element or attribute is missing.
    #[error("line {line}: {owner} has no {missing}")]
    Missing {
        /// Line on which the owner begins.
        line: usize,
        /// The element that should have it.
        owner: String,
        /// Part that it should have.
        missing: &'static str,
    },

    /// An attribute has a wrong value.
    #[error("line {line}: {what} is \"{got}\"; it must be {wanted}")]
    Attribute {
        /// The line.
        line: usize,
        /// Attribute and its element.
        what: String,
        /// Value given.
        got: String,
        /// The right form.
        wanted: &'static str,
    },

    /// A link is the child of two joints.
    #[error(
        "line {line}: link `{link}` is the child of joints `{first}` and `{second}`; a link hangs \
         on one joint"
    )]
    TwoParents {
        /// Line on which the second joint begins.
        line: usize,
        /// The link.
        link: String,
        /// A joint that carries it.
        first: String,
        /// Another one.
        second: String,
    },

    /// The joints form a loop.
    #[error(
        "line {line}: the joints above link `{link}` form a loop, joint `{joint}` among them; a \
         robot is a tree"
    )]
    Loop {
        /// Line on which the joint begins.
        line: usize,
        /// A link of the loop.
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

    /// Two links have no parent joint.
    #[error(
        "links `{first}` (line {first_line}) and `{second}` (line {second_line}) both hang on no \
         joint; join them, or name the one to start from as the description's `root`"
    )]
    TwoRoots {
        /// A link without a parent.
        first: String,
        /// Line on which it begins.
        first_line: usize,
        /// Another one.
        second: String,
        /// Line on which it begins.
        second_line: usize,
    },

    /// A joint has a type that this crate does not move.
    #[error(
        "line {line}: joint `{joint}` is {kind}; use fixed, prismatic, revolute and continuous \
         joints, hold the joint at a position, or start from the link that it carries with a \
         planar or floating base"
    )]
    UnsupportedJoint {
        /// Line on which the joint begins.
        line: usize,
        /// The joint.
        joint: String,
        /// Type in the URDF.
        kind: String,
    },

    /// A joint mimics itself by way of others.
    #[error("line {line}: joint `{joint}` mimics itself; a mimic joint follows a joint that moves")]
    MimicLoop {
        /// Line on which the joint begins.
        line: usize,
        /// The joint.
        joint: String,
    },

    /// A joint's axis is zero.
    #[error(
        "line {line}: the axis of joint `{joint}` is zero; give it a direction, such as \
         xyz=\"0 0 1\""
    )]
    ZeroAxis {
        /// Line on which the joint begins.
        line: usize,
        /// The joint.
        joint: String,
    },

    /// A joint has limits neither in the URDF nor in the description.
    #[error(
        "line {line}: joint `{joint}` has no {missing}; add <limit lower=… upper=… velocity=… \
         effort=…/> to the URDF, or give the limit in the description"
    )]
    LimitsMissing {
        /// Line on which the joint begins.
        line: usize,
        /// The joint.
        joint: String,
        /// Name of the missing limit.
        missing: &'static str,
    },
}
