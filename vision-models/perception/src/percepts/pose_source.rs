//! Sources of the joints in the image.

use std::{
    ffi::OsStr,
    path::{Path, PathBuf},
};

use vision_models::{
    Camera, DepthImage, ImageBody, JointFrame, PersonBox, file::read_bytes, is_hidden,
};

use crate::{
    error::Error,
    frames::{FrameEntry, Picture},
};

/// Largest skeleton file that is read (bytes).
const LARGEST: u64 = 16 << 20;

/// The data of a frame in which people are searched.
#[derive(Clone, Copy, Debug)]
pub struct Frame<'a> {
    /// Number and times.
    pub entry: &'a FrameEntry,
    /// The colour image.
    pub colour: &'a Picture,
    /// The depth image.
    pub depth: &'a DepthImage,
    /// The camera.
    pub camera: &'a Camera,
    /// The box in which the engaged person is expected.
    pub expected: Option<PersonBox>,
}

/// A source of people in frames.
pub trait PoseSource: std::fmt::Debug {
    /// Returns the people in a frame, or `None` if the frame was not searched.
    ///
    /// # Errors
    /// The reason why the frame cannot be searched, with the file.
    fn people(&mut self, frame: &Frame<'_>) -> Result<Option<Vec<ImageBody>>, Error>;

    /// Returns the expected file of the people in a frame, if they come from files.
    fn expected(&self, _frame: u64) -> Option<PathBuf> {
        None
    }
}

/// A folder with a file of joints for each frame, as [`JointFrame::from_json`] reads them: `000012_keypoints.json` for frame
/// 12, or with the name and the digits that OpenPose gives by itself, as in `video_000000000012_keypoints.json`. Other
/// programs' are called `000012.json`, with a name before and as many digits as they like.
#[derive(Clone, Debug)]
pub struct SkeletonFolder {
    folder: PathBuf,
    /// The name before the number in the first file.
    prefix: String,
    /// Number of digits in the first file.
    digits: usize,
    /// Ending of names behind the number.
    end: &'static str,
}

/// The ends of the files' names, OpenPose's first.
const ENDS: [&str; 2] = ["_keypoints.json", ".json"];

impl SkeletonFolder {
    /// Checks that the folder has at least one skeleton, and takes the form of the names from it.
    ///
    /// # Errors
    /// Names the folder.
    pub fn open(folder: &Path) -> Result<Self, Error> {
        let refuse = |source| Error::Read { path: folder.to_owned(), source };
        let mut first: Option<(String, &str)> = None;
        for entry in folder.read_dir().map_err(refuse)? {
            let name = entry.map_err(refuse)?.file_name();
            let stem = |name: &OsStr| {
                let name = name.to_str().filter(|_| !is_hidden(name))?;
                ENDS.iter().find_map(|end| Some((name.strip_suffix(end)?.to_owned(), *end)))
            };
            if let Some(found) = stem(&name)
                && found.0.ends_with(|last: char| last.is_ascii_digit())
                && first.as_ref().is_none_or(|first| found < *first)
            {
                first = Some(found);
            }
        }
        let (first, end) = first.ok_or_else(|| {
            let wanted = format!("give a folder with OpenPose's 000000{}", ENDS[0]);
            Error::unfit(folder.display(), "no skeletons", wanted)
        })?;
        let prefix = first.trim_end_matches(|last: char| last.is_ascii_digit()).to_owned();
        let digits = first.len() - prefix.len();
        Ok(Self { folder: folder.to_owned(), prefix, digits, end })
    }

    /// Returns the possible paths of the skeletons of a frame.
    fn places(&self, frame: u64) -> [PathBuf; 2] {
        let Self { folder, prefix, digits, end } = self;
        [format!("{prefix}{frame:0digits$}{end}"), format!("{frame:06}{end}")]
            .map(|name| folder.join(name))
    }
}

impl PoseSource for SkeletonFolder {
    fn people(&mut self, frame: &Frame<'_>) -> Result<Option<Vec<ImageBody>>, Error> {
        for path in self.places(frame.entry.frame) {
            let bytes = match read_bytes(&path, LARGEST) {
                Err(error) if error.kind() == std::io::ErrorKind::NotFound => continue,
                bytes => bytes.map_err(Error::read(&path))?,
            };
            let size = frame.camera.intrinsics().size();
            let frames =
                JointFrame::from_json(&bytes, Some(size)).map_err(Error::content(&path))?;
            let people = frames.into_iter().flat_map(|frame| frame.people);
            return Ok(Some(people.map(|person| person.image).collect()));
        }
        Ok(None)
    }

    fn expected(&self, frame: u64) -> Option<PathBuf> {
        let [place, _] = self.places(frame);
        Some(place)
    }
}
