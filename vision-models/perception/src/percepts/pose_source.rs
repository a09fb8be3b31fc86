//! Sources of the joints in the image.

use std::path::{Path, PathBuf};

use vision_models::{Camera, DepthImage, ImageBody, PersonBox, file::read_bytes, is_hidden};

use crate::{error::Error, frames::format::FrameEntry};

/// Largest skeleton file that is read (bytes).
const LARGEST: u64 = 16 << 20;

/// The data of a frame in which people are searched.
#[derive(Clone, Copy, Debug)]
pub struct Frame<'a> {
    /// Number and times.
    pub entry: &'a FrameEntry,
    /// File of the colour image.
    pub colour: &'a Path,
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

/// A folder of OpenPose's JSON. The file of frame 12 is `000012_keypoints.json`, or has the name
/// and the digits that OpenPose writes, as in `000000000012_keypoints.json` and
/// `video_000000000012_keypoints.json`.
#[derive(Clone, Debug)]
pub struct SkeletonFolder {
    folder: PathBuf,
    /// The name before the number in the first file.
    prefix: String,
    /// Number of digits in the first file.
    digits: usize,
}

/// The end of the files' names.
const END: &str = "_keypoints.json";

impl SkeletonFolder {
    /// Checks that the folder has at least one skeleton, and takes the form of the names from it.
    ///
    /// # Errors
    /// Names the folder.
    pub fn open(folder: &Path) -> Result<Self, Error> {
        let refuse = |source| Error::Read { path: folder.to_owned(), source };
        let mut first: Option<String> = None;
        for entry in folder.read_dir().map_err(refuse)? {
            let name = entry.map_err(refuse)?.file_name();
            if let Some(name) = name.to_str().and_then(|name| name.strip_suffix(END))
                && !is_hidden(name.as_ref())
                && name.ends_with(|last: char| last.is_ascii_digit())
                && first.as_deref().is_none_or(|first| name < first)
            {
                first = Some(name.to_owned());
            }
        }
        let first = first.ok_or_else(|| {
            let wanted = format!("give a folder with OpenPose's 000000{END}");
            Error::unfit(folder.display(), "no skeletons", wanted)
        })?;
        let prefix = first.trim_end_matches(|last: char| last.is_ascii_digit()).to_owned();
        let digits = first.len() - prefix.len();
        Ok(Self { folder: folder.to_owned(), prefix, digits })
    }

    /// Returns the possible paths of the skeletons of a frame.
    fn places(&self, frame: u64) -> [PathBuf; 2] {
        let Self { folder, prefix, digits } = self;
        [format!("{prefix}{frame:0digits$}{END}"), format!("{frame:06}{END}")]
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
            let people = ImageBody::from_openpose(&bytes);
            return people.map(Some).map_err(Error::content(&path));
        }
        Ok(None)
    }

    fn expected(&self, frame: u64) -> Option<PathBuf> {
        let [place, _] = self.places(frame);
        Some(place)
    }
}
