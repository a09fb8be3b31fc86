//! Reasons why messages are refused.

use crate::command_limits::CommandRefusal;

/// Reason why a message is refused. The last accepted message stays valid until it is too old.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Refusal {
    /// Another node uses another message type on the topic.
    #[error("somebody has the type {found} there, expected {expected}")]
    Type {
        /// Type of the other node.
        found: String,
        /// Type of the topic.
        expected: String,
    },
    /// The bytes are no message of this type.
    #[error("bytes that are no such message: {reason}")]
    Bytes {
        /// Reason that the decoder gives.
        reason: String,
    },
    /// A list has the wrong length.
    #[error("{found} numbers of {what}, expected {expected}")]
    Size {
        /// Contents of the list.
        what: &'static str,
        /// Length of the list.
        found: usize,
        /// Expected length.
        expected: usize,
    },
    /// A joint of the robot is missing.
    #[error("no joint {joint:?} among {found:?}")]
    MissingJoint {
        /// Joint.
        joint: String,
        /// Joints in the message.
        found: Vec<String>,
    },
    /// A joint of the robot is in the message more than once.
    #[error("joint {joint:?} more than once")]
    RepeatedJoint {
        /// Joint.
        joint: String,
    },
    /// A number is NaN or infinite.
    #[error("{what}: a number that is not finite")]
    NotFinite {
        /// Name of the quantity.
        what: &'static str,
    },
    /// The quaternion is no rotation.
    #[error("an orientation of norm {norm}, expected 1")]
    Orientation {
        /// Norm of the quaternion.
        norm: f64,
    },
    /// The message has another frame.
    #[error("in the frame {found:?}, expected {expected:?}")]
    Frame {
        /// Frame of the message.
        found: String,
        /// Expected frame.
        expected: &'static str,
    },
    /// The stamp is zero: the publisher does not stamp its messages.
    #[error("no stamp; give it the time of the system clock")]
    NoStamp,
    /// The stamp is no valid time.
    #[error("a stamp with {nanosec} ns, expected less than a second")]
    Stamp {
        /// Nanoseconds of the stamp.
        nanosec: u32,
    },
    /// The message is too old, or another clock stamped it.
    #[error(
        "stamped {age:.3} s ago, expected at most {oldest} s: late, or by a clock that is behind this machine's"
    )]
    Old {
        /// Age by this machine's clock \[s\].
        age: f64,
        /// Largest allowed age \[s\].
        oldest: f64,
    },
    /// The stamp lies in the future: another clock stamped it.
    #[error(
        "stamped {ahead:.3} s in the future, expected at most {most} s: by a clock that is ahead of this machine's"
    )]
    Future {
        /// Time until the stamp by this machine's clock \[s\].
        ahead: f64,
        /// Largest allowed value \[s\].
        most: f64,
    },
    /// A newer message came before this one.
    #[error("stamped no later than the message before")]
    Overtaken,
    /// No odometry is recent enough for the joint states.
    #[error("no odometry in the last {oldest} s; base and arm are measured together")]
    NoOdometry {
        /// Largest allowed age of odometry \[s\].
        oldest: f64,
    },
    /// No valid transforms tie a frame to another.
    #[error(
        "in the frame {frame:?}, which nothing ties to {to:?}, neither on /tf_static nor on /tf in the last {oldest} s"
    )]
    NoTransform {
        /// Frame of the message.
        frame: String,
        /// Frame that is needed.
        to: &'static str,
        /// Largest allowed age of a transform on `/tf` \[s\].
        oldest: f64,
    },
    /// Others name too many frames.
    #[error("more than {most} frames")]
    Frames {
        /// Largest number of frames.
        most: usize,
    },
    /// The name of the mode is unknown.
    #[error("the mode {found:?}, expected one of running, stopped, reflex, user_stop")]
    Mode {
        /// Name that was found.
        found: String,
    },
    /// The confidence is not between 0 and 1.
    #[error("a confidence of {value}, expected 0 to 1")]
    Confidence {
        /// Value of the confidence.
        value: f64,
    },
    /// The id of a person is no whole number from 0 to 2⁵³.
    #[error("a person's id of {value}, expected a whole number from 0 to 2^53, or NaN")]
    Id {
        /// Value of the id.
        value: f64,
    },
    /// The robot refuses the command.
    #[error(transparent)]
    Command(#[from] CommandRefusal),
    /// The name is none of the thirty actions.
    #[error("{0}")]
    Action(String),
    /// The name is neither of the two surfaces.
    #[error("{0}")]
    Surface(String),
    /// The image has another encoding.
    #[error("an image in {found:?}, expected {expected}")]
    Encoding {
        /// Encoding of the image.
        found: String,
        /// Encodings that are understood.
        expected: &'static str,
    },
    /// The image does not have the size of the camera.
    #[error(
        "an image of {} × {} pixels, expected {} × {}, as the colour camera's information says", found[0], found[1],
        expected[0], expected[1]
    )]
    Pixels {
        /// Width and height of the image.
        found: [usize; 2],
        /// Width and height of the camera's images.
        expected: [usize; 2],
    },
    /// The camera did not say yet how its images are made.
    #[error("no information about the camera yet")]
    NoCamera,
    /// The numbers of the camera are not those of a camera.
    #[error("{0}")]
    Camera(String),
    /// The images are not rectified.
    #[error(
        "the lens moves pixels by up to {pixels:.1}, expected at most 1: give rectified images"
    )]
    Lens {
        /// Largest distance by which the lens moves a pixel at the border.
        pixels: f64,
    },
    /// The camera changed its geometry.
    #[error("the camera has another geometry than before")]
    OtherCamera,
}
