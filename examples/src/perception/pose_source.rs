//! Where the joints in the image come from.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use vision_models::{Camera, DepthImage, ImageBody, PersonBox, is_hidden};

use crate::{frames::FrameEntry, program::read_bytes};

/// The largest skeleton file that is read (bytes).
const LARGEST: u64 = 16 << 20;

/// What there is to find people in.
#[derive(Clone, Copy, Debug)]
pub struct Frame<'a> {
    /// Number and times.
    pub entry: &'a FrameEntry,
    /// The file of the colour image.
    pub colour: &'a Path,
    /// The depth image.
    pub depth: &'a DepthImage,
    /// The camera.
    pub camera: &'a Camera,
    /// Where the person who works with the robot is expected.
    pub expected: Option<PersonBox>,
}

/// What finds people in frames.
pub trait PoseSource: std::fmt::Debug {
    /// The people in a frame; `None` where nobody looked.
    ///
    /// # Errors
    /// What keeps it from looking, with the file.
    fn people(&mut self, frame: &Frame<'_>) -> Result<Option<Vec<ImageBody>>>;

    /// The file that is looked for with the people of a frame, if it takes them from files.
    fn expected(&self, _frame: u64) -> Option<PathBuf> {
        None
    }
}

/// A folder of OpenPose's JSON: `000012_keypoints.json` for frame 12, or with the name and the digits that OpenPose gives
/// by itself, as in `000000000012_keypoints.json` and `video_000000000012_keypoints.json`.
#[derive(Clone, Debug)]
pub struct SkeletonFolder {
    folder: PathBuf,
    /// What stands before the number in the first of the files.
    prefix: String,
    /// How many digits its number has.
    digits: usize,
}

/// The end of the files' names.
const END: &str = "_keypoints.json";

impl SkeletonFolder {
    /// Checks that the folder has a skeleton at least, and learns from it how the files are called.
    ///
    /// # Errors
    /// With the folder's name.
    pub fn open(folder: &Path) -> Result<Self> {
        let shown = folder.display();
        let mut first: Option<String> = None;
        for entry in folder.read_dir().with_context(|| format!("{shown}"))? {
            let name = entry.with_context(|| format!("{shown}"))?.file_name();
            if let Some(name) = name.to_str().and_then(|name| name.strip_suffix(END))
                && !is_hidden(name.as_ref())
                && name.ends_with(|last: char| last.is_ascii_digit())
                && first.as_deref().is_none_or(|first| name < first)
            {
                first = Some(name.to_owned());
            }
        }
        let first = first.with_context(|| {
            format!("{shown}: no skeletons: give a folder with OpenPose's 000000{END}")
        })?;
        let prefix = first.trim_end_matches(|last: char| last.is_ascii_digit()).to_owned();
        let digits = first.len() - prefix.len();
        Ok(Self { folder: folder.to_owned(), prefix, digits })
    }

    /// Where the skeletons of a frame may be.
    fn places(&self, frame: u64) -> [PathBuf; 2] {
        let Self { folder, prefix, digits } = self;
        [format!("{prefix}{frame:0digits$}{END}"), format!("{frame:06}{END}")]
            .map(|name| folder.join(name))
    }
}

impl PoseSource for SkeletonFolder {
    fn people(&mut self, frame: &Frame<'_>) -> Result<Option<Vec<ImageBody>>> {
        for path in self.places(frame.entry.frame) {
            let bytes = match read_bytes(&path, LARGEST) {
                Err(error) if error.kind() == std::io::ErrorKind::NotFound => continue,
                bytes => bytes.with_context(|| path.display().to_string())?,
            };
            let people = ImageBody::from_openpose(&bytes);
            return people.map(Some).with_context(|| path.display().to_string());
        }
        Ok(None)
    }

    fn expected(&self, frame: u64) -> Option<PathBuf> {
        let [place, _] = self.places(frame);
        Some(place)
    }
}
