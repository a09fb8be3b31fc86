//! What can be wrong with what is given to this crate.

use std::fmt;

#[cfg(feature = "inference")]
use crate::networks::NetworkKind;
use crate::weights::CheckpointError;

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
    /// A name that is none of the thirty classes of [`Action::ALL`](crate::Action::ALL).
    #[error(
        "unknown action \"{}\": give one of the thirty HRI30 class names exactly as they are \
         written, such as \"Using The Drill\"", Excerpt(.name)
    )]
    UnknownAction {
        /// The name that was given.
        name: String,
    },
    /// A name that is no surface.
    #[error("unknown surface \"{}\": give \"smooth\" or \"drilled\"", Excerpt(.name))]
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
    /// A depth image whose depths do not fill it.
    #[error(
        "a depth image of {} × {} pixels was given {found} depths: give one for each pixel",
        .size[0], .size[1]
    )]
    DepthSize {
        /// Width and height (pixels).
        size: [usize; 2],
        /// How many depths were given.
        found: usize,
    },
    /// An image of another size than the camera's.
    #[error(
        "the depth image has {} × {} pixels, and the camera's intrinsics are for {} × {}: give depth \
         that is aligned to the colour image, and the intrinsics of that size",
        .found[0], .found[1], .expected[0], .expected[1]
    )]
    ImageSize {
        /// Width and height of the image (pixels).
        found: [usize; 2],
        /// Width and height of the intrinsics (pixels).
        expected: [usize; 2],
    },
    /// A camera pose that is none.
    #[error("the camera's pose is not finite or has no direction: give a rigid motion")]
    CameraPose,
    /// A camera whose image would be upside down.
    #[error(
        "the camera is upside down: the bottom of its image points {:.0}° away from the floor; turn \
         the images, or correct the camera's pose", angle.to_degrees()
    )]
    UpsideDown {
        /// Between the image's downward direction and down (rad).
        angle: f64,
    },
    /// Gravity that the camera's pose contradicts.
    #[error(
        "gravity as the camera measures it is {:.0}° away from down as its pose has it, more than \
         {:.0}°: correct the camera's pose", angle.to_degrees(), limit.to_degrees()
    )]
    Gravity {
        /// Between measured gravity and down (rad).
        angle: f64,
        /// The most that is accepted (rad).
        limit: f64,
    },
    /// A file that is not `OpenPose`'s JSON.
    #[error(
        "no OpenPose JSON: {problem}; give an object with \"people\", each with \"pose_keypoints_2d\" of \
         75 (BODY_25) or 54 (COCO-18) numbers x, y, confidence"
    )]
    OpenPose {
        /// What was found, and where.
        problem: String,
    },
    /// A percept that arrived before it was taken.
    #[error(
        "a percept of time {time} s arrived at {arrived} s, before it was taken: give both times on \
         one clock"
    )]
    Arrival {
        /// When the camera took the frame (s).
        time: f64,
        /// When the percept arrived (s).
        arrived: f64,
    },
    /// A checkpoint that is not the network's. The message has the first few names only.
    #[cfg(feature = "inference")]
    #[error("{}", WeightsMessage { network, found, lists: [missing, surplus, misshapen] })]
    Weights {
        /// The network that was to be loaded, if it is one of this crate.
        network: Option<NetworkKind>,
        /// The network that the checkpoint holds, if it is a known one.
        found: Option<NetworkKind>,
        /// Names and shapes of tensors that the network needs and the checkpoint lacks.
        missing: Vec<String>,
        /// Names of tensors that the network has no place for.
        surplus: Vec<String>,
        /// Names of tensors of the wrong shape, with both shapes.
        misshapen: Vec<String>,
    },
    /// A weight that no network was trained to.
    #[error(
        "tensor \"{}\": element {index:?} is {value}: give {expected}", Excerpt(.name)
    )]
    Weight {
        /// The tensor's name.
        name: String,
        /// The element's index along each axis.
        index: Vec<usize>,
        /// Its value.
        value: f32,
        /// The values that are right.
        expected: &'static str,
    },
    /// A convolution whose weights are finite, but not after its batch norm was folded in.
    #[error(
        "layer \"{}\": with its batch norm folded in, a weight is too large for f32: the \
         checkpoint is damaged, or its training diverged", Excerpt(.layer)
    )]
    FoldedWeights {
        /// The convolution's name in the checkpoint.
        layer: String,
    },
    /// Activations that are too large for f32.
    #[error(
        "input {input}: the network's activations overflow f32, so that it has no scores: \
         normalise the input, and check that the weights are those of this network"
    )]
    Overflow {
        /// The image or clip of the batch.
        input: usize,
    },
    /// A layer that does not fit the activations which it reads and writes.
    #[error("layer {layer} cannot be planned: {problem}")]
    Layer {
        /// What the checkpoint calls it, or what it is.
        layer: String,
        /// What does not fit.
        problem: String,
    },
    /// Images or clips of the wrong shape.
    #[error(
        "an input of shape {shape:?} (N, channels, frames, height, width): give at least one image or \
         clip, of as many channels as the network takes, three as a rule"
    )]
    InputShape {
        /// The shape that was given, as N, channels, frames, height, width.
        shape: Vec<usize>,
    },
    /// Images or clips that are smaller than the network's kernels.
    #[error("frames, height and width {size:?} are too small for the network")]
    InputTooSmall {
        /// Frames, height and width.
        size: [usize; 3],
    },
    /// Images or clips that are beyond all memory.
    #[error("frames, height and width {size:?} are too large for the memory of this machine")]
    InputTooLarge {
        /// Frames, height and width.
        size: [usize; 3],
    },
    /// A clip with a number of frames that the network cannot take.
    #[error("a clip of {frames} frames: give {expected}")]
    FrameCount {
        /// The frames that were given.
        frames: usize,
        /// The frames that are right.
        expected: usize,
    },
    /// A last activation that is smaller than the windows of the head.
    #[error(
        "the last activation has length {length} along axis {axis} (frames, rows, columns), less \
         than the head's window of {window}: give more frames or larger images"
    )]
    PoolTooSmall {
        /// 0 for frames, 1 for rows, 2 for columns.
        axis: usize,
        /// The activation's length.
        length: usize,
        /// The window's length.
        window: usize,
    },
    /// A pixel that is NaN or infinite.
    #[error("pixel {index:?} (clip, channel, frame, row, column) is {value}: give finite values")]
    NotFinite {
        /// The value that was given.
        value: f32,
        /// Clip (or image), channel, frame, row and column.
        index: [usize; 5],
    },
    /// Threads that cannot be started: none, more than
    /// [`Options::MAX_THREADS`](crate::Options::MAX_THREADS), or more than the operating system
    /// gives.
    #[error("{threads} threads cannot be started: {reason}")]
    Threads {
        /// How many were asked for.
        threads: usize,
        /// The limit, or the operating system's reason.
        reason: String,
    },
    /// A tensor whose elements do not fill its shape.
    #[error("a tensor of shape {shape:?} was given {elements} elements: give one for each place")]
    TensorSize {
        /// The shape that was given.
        shape: Vec<usize>,
        /// How many elements were given.
        elements: usize,
    },
    /// A tensor name that came twice.
    #[error("tensor \"{}\" was given twice: a checkpoint has each name once", Excerpt(.name))]
    DuplicateTensor {
        /// The name.
        name: String,
    },
    /// A tensor that the weights do not have.
    #[error("the weights have no tensor \"{}\"", Excerpt(.name))]
    NoTensor {
        /// The name that was asked for.
        name: String,
    },
    /// A file that the operating system does not let us read or write.
    #[error("{}{reason}", place(.path))]
    File {
        /// The path; empty for a reader that is no file.
        path: String,
        /// What the operating system says.
        reason: String,
    },
    /// A checkpoint that is refused.
    #[cfg(feature = "inference")]
    #[error(transparent)]
    Checkpoint(#[from] CheckpointError),
    /// An image file that cannot be decoded.
    #[error("{}no JPEG or PNG image that can be read: {reason}", place(.path))]
    Image {
        /// The path; empty for bytes in memory.
        path: String,
        /// What the decoder says.
        reason: String,
    },
    /// A frame of another shape.
    #[error("a frame has the shape {shape:?}: give {expected}")]
    FrameShape {
        /// The shape that was given.
        shape: Vec<usize>,
        /// The shape that is right.
        expected: String,
    },
    /// A person's box that is none.
    #[error("a person's box at {left}, {top} of {width} × {height} pixels: give {expected}")]
    PersonBox {
        /// Its left edge (pixels).
        left: f64,
        /// Its upper edge (pixels).
        top: f64,
        /// Its width (pixels).
        width: f64,
        /// Its height (pixels).
        height: f64,
        /// What would be right.
        expected: &'static str,
    },
    /// Maps of joints and limbs of the wrong shape.
    #[error(
        "maps of shape {joints:?} for the joints and {limbs:?} for the limbs: give 19 (or 18) and 38 maps of one \
         size"
    )]
    PartMaps {
        /// The shape of the joints' maps.
        joints: Vec<usize>,
        /// The shape of the limbs' fields.
        limbs: Vec<usize>,
    },
    /// A value of such a map that is NaN or infinite.
    #[error("map {}, row {}, column {} is {value}: give finite numbers", .index[0], .index[1], .index[2])]
    PartMapsNotFinite {
        /// The value that was given.
        value: f32,
        /// Map, row and column.
        index: [usize; 3],
    },
    /// A crop that does not fit the resized frame.
    #[error("a crop of {crop} × {crop} does not fit a frame resized to {height} × {width}")]
    CropTooLarge {
        /// The crop's side (pixels).
        crop: usize,
        /// The frame's height after the resize (pixels).
        height: usize,
        /// The frame's width after the resize (pixels).
        width: usize,
    },
    /// A video or a folder without frames.
    #[error("no frames: give at least one, or a folder with JPEG or PNG files")]
    NoFrames,
    /// Samples, labels, classes and weights of a linear classifier that do not fit together.
    #[error("linear classifier: {problem}")]
    Samples {
        /// What does not fit, and what would.
        problem: String,
    },
    /// A feature, weight or bias that is NaN or infinite.
    #[error("row {row}, column {column} is {value}: give finite numbers")]
    Feature {
        /// The sample or plane.
        row: usize,
        /// The feature; of a plane, the bias comes after the weights.
        column: usize,
        /// The value that was given.
        value: f64,
    },
    /// The file of a linear machine that breaks the format.
    #[error("linear SVM file, line {line}: expected {expected}")]
    SvmFile {
        /// Counted from one.
        line: usize,
        /// What should be there.
        expected: String,
    },
    /// A label file that breaks the format.
    #[error("label file, line {line}: expected {expected}")]
    Labels {
        /// Counted from one.
        line: usize,
        /// What should be there.
        expected: &'static str,
    },
    /// Two class names of the same letters and digits.
    #[error(
        "label file, lines {} and {}: \"{}\" and \"{}\" are one name, as only letters and digits \
         count: give each class its own", .lines[0], .lines[1], Excerpt(&.names[0]), Excerpt(&.names[1])
    )]
    EqualNames {
        /// Both as they are written.
        names: [String; 2],
        /// Their lines, counted from one.
        lines: [usize; 2],
    },
    /// Names of classes that are not a network's.
    #[error("{names} class names for {classes} classes: give one for each")]
    ClassCount {
        /// How many names there are.
        names: usize,
        /// How many classes there are.
        classes: usize,
    },
    /// An input that a batch does not have.
    #[error("input {input} of a batch of {inputs}: count from zero")]
    BatchIndex {
        /// The input that was asked for.
        input: usize,
        /// How many there are.
        inputs: usize,
    },
    /// A class that does not exist.
    #[error("class {class} of {classes}: count from zero")]
    ClassIndex {
        /// The class that was given.
        class: usize,
        /// How many there are.
        classes: usize,
    },
}

/// What a message about a file starts with.
fn place(path: &str) -> String {
    if path.is_empty() { String::new() } else { format!("{path}: ") }
}

/// The start of a text from outside, so that no file makes a message long. Control characters are
/// escaped: the message stays on its line.
pub(crate) struct Excerpt<'a>(pub(crate) &'a str);

impl Excerpt<'_> {
    const LENGTH: usize = 120;
}

impl fmt::Display for Excerpt<'_> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        for character in self.0.chars().take(Self::LENGTH) {
            if character.is_control() {
                write!(formatter, "{}", character.escape_default())?;
            } else {
                write!(formatter, "{character}")?;
            }
        }
        if self.0.chars().nth(Self::LENGTH).is_some() { formatter.write_str("…") } else { Ok(()) }
    }
}

/// What is wrong with a checkpoint, in a few lines.
#[cfg(feature = "inference")]
struct WeightsMessage<'a> {
    network: &'a Option<NetworkKind>,
    found: &'a Option<NetworkKind>,
    /// Missing, surplus, misshapen.
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
