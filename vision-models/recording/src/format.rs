//! The lines of a recording in JSON. Names and confidences are not checked here: the reader checks
//! them, to report where they are wrong.

use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::segments::MeasuredSegments;
use crate::timing::Stamp;

pub(super) const FORMAT: &str = "moca-recording";

/// Recordings of this version end with an [`EndLine`].
pub(super) const VERSION: u32 = 2;

/// Recordings of this version have no closing line.
pub(super) const UNMARKED_VERSION: u32 = 1;

/// Data of a whole recording.
///
/// ```
/// use percept_recording::{Frame, Header};
///
/// let header = Header { stature: Some(1.8), ..Header::default() };
/// assert_eq!((header.frame, header.rate), (Frame::World, 20.0));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Header {
    /// The frame of the keypoints.
    pub frame: Frame,
    /// Rate of the camera (Hz), for information only. The time stamps are decisive.
    pub rate: f64,
    /// The person's stature (m), if it is known.
    pub stature: Option<f64>,
    /// Lengths of the person's segments, if they were measured.
    pub segments: MeasuredSegments,
}

impl Default for Header {
    fn default() -> Self {
        Self {
            frame: Frame::World,
            rate: 20.0,
            stature: None,
            segments: MeasuredSegments::default(),
        }
    }
}

/// The frame of the keypoints.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum Frame {
    /// The world frame: x and y on the floor, z up. The robot's base starts at the origin and faces
    /// along x.
    World,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct HeaderLine {
    pub(super) format: String,
    pub(super) version: u32,
    pub(super) frame: Frame,
    pub(super) rate: f64,
    pub(super) stature: Option<f64>,
    #[serde(default, skip_serializing_if = "MeasuredSegments::is_empty")]
    pub(super) segments: MeasuredSegments,
}

/// The closing line.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct EndLine {
    pub(super) end: End,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct End {
    /// Number of camera frames.
    pub(super) frames: u64,
    /// False if the recording was interrupted.
    pub(super) complete: bool,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct FrameLine {
    pub(super) time: f64,
    pub(super) arrived: Option<f64>,
    pub(super) keypoints: Vec<Value>,
    #[serde(default)]
    pub(super) others: Vec<Vec<Value>>,
    /// Ids of the person of `keypoints`, then of `others`.
    pub(super) ids: Option<Vec<Option<u64>>>,
    pub(super) action: Option<Label>,
    pub(super) surface: Option<Label>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Label {
    pub(super) name: String,
    pub(super) confidence: f64,
    pub(super) captured: Option<f64>,
    pub(super) arrived: Option<f64>,
}

/// x, y, z (m) and confidence of the keypoints that were seen.
pub(super) type KeypointsOut = [Option<[f64; 4]>; 25];

/// [`FrameLine`] for writing.
#[derive(Serialize)]
pub(super) struct FrameLineOut {
    pub(super) time: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) arrived: Option<f64>,
    pub(super) keypoints: KeypointsOut,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub(super) others: Vec<KeypointsOut>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) ids: Option<Vec<Option<u64>>>,
    pub(super) action: Option<LabelOut>,
    pub(super) surface: Option<LabelOut>,
}

#[derive(Serialize)]
pub(super) struct LabelOut {
    pub(super) name: &'static str,
    pub(super) confidence: f64,
    #[serde(flatten)]
    pub(super) stamp: Stamp,
}
