//! What can be wrong with a recording.

use std::{io, path::PathBuf};

/// Why a recording cannot be read or written: where, what was found, and what would be right.
/// Lines count from 1, the header included.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RecordingError {
    /// The file cannot be opened.
    #[error("cannot open the recording {path}: {source}", path = path.display())]
    Open {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// The system cannot read or write on.
    #[error("line {line}: cannot read or write on: {source}")]
    Io {
        /// The line that failed.
        line: usize,
        /// What the system says.
        source: io::Error,
    },
    /// There is no camera frame.
    #[error(
        "the recording is empty: it has {lines} line(s) and no camera frame; the first line is the \
         header, every further line a frame (the `record` command makes a recording)"
    )]
    Empty {
        /// How many lines there are.
        lines: usize,
    },
    /// Something is wrong with the keypoints of a person beside the one who works with the robot.
    #[error("{source} (of other person {person} in the frame)")]
    Other {
        /// Which of them, from 1.
        person: usize,
        /// What is wrong.
        source: Box<RecordingError>,
    },
    /// Something was known before it was seen, or seen after its frame, or long before.
    #[error(
        "line {line}: the {of} of the frame of {time} s was captured at {captured} s and arrived at \
         {arrived} s: it is captured no later than the frame and arrives no earlier, both within \
         {limit} s"
    )]
    Stamp {
        /// The line.
        line: usize,
        /// What it is of.
        of: &'static str,
        /// When it was seen (s).
        captured: f64,
        /// When it was known (s).
        arrived: f64,
        /// The frame's time (s).
        time: f64,
        /// The longest time between them (s).
        limit: f64,
    },
    /// A line that cannot be a frame.
    #[error(
        "line {line} is longer than {limit} bytes: a frame takes about 1000; write one JSON object \
         a line"
    )]
    LineTooLong {
        /// The line.
        line: usize,
        /// The most that is read (bytes).
        limit: usize,
    },
    /// The first line is no header.
    #[error(
        "line {line}: {problem}; the first line of a recording is its header, such as \
         {{\"format\":\"moca-recording\",\"version\":2,\"frame\":\"world\",\"rate\":20.0,\
         \"stature\":1.75}}"
    )]
    Header {
        /// The line.
        line: usize,
        /// What was found.
        problem: String,
    },
    /// The input ends before the closing line.
    #[error(
        "line {line}: the recording is cut off here, after {frames} whole camera frame(s): a whole \
         one ends with a closing line such as {{\"end\":{{\"frames\":{frames},\"complete\":true}}}}"
    )]
    Cut {
        /// The last line, or the one that is missing.
        line: usize,
        /// How many whole frames there are.
        frames: u64,
    },
    /// The closing line says that the recording was interrupted.
    #[error(
        "line {line}: the recording is partial: it was interrupted after {frames} camera frame(s)"
    )]
    Interrupted {
        /// The closing line.
        line: usize,
        /// How many frames there are.
        frames: u64,
    },
    /// A closing line that is none.
    #[error(
        "line {line}: {problem}; the closing line of a recording of version 2 is such as \
         {{\"end\":{{\"frames\":1119,\"complete\":true}}}}"
    )]
    End {
        /// The line.
        line: usize,
        /// What was found.
        problem: String,
    },
    /// The closing line gives another number of frames than there are.
    #[error(
        "line {line}: the closing line gives {said} camera frame(s), and there are {found}: lines \
         were lost or added"
    )]
    FrameCount {
        /// The closing line.
        line: usize,
        /// What it says.
        said: u64,
        /// How many there are.
        found: u64,
    },
    /// Something comes after the closing line.
    #[error("line {line} comes after the closing line: a file holds one recording")]
    AfterEnd {
        /// The line.
        line: usize,
    },
    /// A line is not the JSON that a frame has.
    #[error(
        "line {line}, column {column}: {problem}; a frame is one JSON object with the fields time, \
         keypoints, action and surface, and null stands for what was not seen (JSON has no NaN)"
    )]
    Json {
        /// The line.
        line: usize,
        /// The column, in bytes from 1.
        column: usize,
        /// What was found.
        problem: String,
    },
    /// The wrong number of keypoints.
    #[error(
        "line {line}: {found} keypoints: give the 25 of BODY_25 in OpenPose's order, null for those \
         that were not seen"
    )]
    KeypointCount {
        /// The line.
        line: usize,
        /// How many there are.
        found: usize,
    },
    /// A keypoint that is no position with confidence.
    #[error(
        "line {line}: keypoint {index} ({joint}) is {found}: give [x, y, z, confidence] with the \
         position in metres, or null if it was not seen"
    )]
    Keypoint {
        /// The line.
        line: usize,
        /// The index in `BODY_25`.
        index: usize,
        /// The joint's name.
        joint: &'static str,
        /// What stands there.
        found: String,
    },
    /// A keypoint that is in no room.
    #[error(
        "line {line}: keypoint {index} ({joint}) has the coordinate {value} m: give finite positions \
         in metres, within {limit} m of the origin"
    )]
    Coordinate {
        /// The line.
        line: usize,
        /// The index in `BODY_25`.
        index: usize,
        /// The joint's name.
        joint: &'static str,
        /// The coordinate (m).
        value: f64,
        /// The largest that is right (m).
        limit: f64,
    },
    /// A confidence outside [0, 1].
    #[error("line {line}: the confidence of {of} is {value}: give a probability in [0, 1]")]
    Confidence {
        /// The line.
        line: usize,
        /// What it is the confidence of.
        of: String,
        /// The value.
        value: f64,
    },
    /// A time stamp that is NaN or infinite.
    #[error("line {line}: the time stamp is {time}: give finite seconds")]
    Time {
        /// The line.
        line: usize,
        /// The time stamp (s).
        time: f64,
    },
    /// Time goes backwards or stands still.
    #[error(
        "line {line}: the time stamp {time} s is not later than {previous} s on the line before: \
         give the frames in the order in which the camera took them"
    )]
    TimeOrder {
        /// The line.
        line: usize,
        /// The time stamp (s).
        time: f64,
        /// The time stamp before (s).
        previous: f64,
    },
    /// A pause that is no pause.
    #[error(
        "line {line}: {gap} s without a frame before the time stamp {time} s: time stamps are in \
         seconds, and pauses of more than {limit} s belong in recordings of their own"
    )]
    TimeGap {
        /// The line.
        line: usize,
        /// The time stamp (s).
        time: f64,
        /// The time since the frame before (s).
        gap: f64,
        /// The longest pause that is right (s).
        limit: f64,
    },
    /// An action or a surface with an unknown name.
    #[error("line {line}: {source}")]
    Name {
        /// The line.
        line: usize,
        /// Which name.
        source: vision_models::Error,
    },
}

impl RecordingError {
    /// Returns true if the recording is sound as far as it goes, but ends early: it is cut off, or
    /// its writer was interrupted.
    pub fn is_early_end(&self) -> bool {
        matches!(self, Self::Cut { .. } | Self::Interrupted { .. })
    }
}
