//! Where the joints in the image come from.

use std::{
    fs::File,
    io::Read,
    path::{Path, PathBuf},
};

use anyhow::{Context, Result, ensure};
use vision_models::{Camera, DepthImage, ImageBody, PersonBox};

use crate::frames::FrameEntry;

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
}

/// A folder of OpenPose's JSON, `000012_keypoints.json` for frame 12.
#[derive(Clone, Debug)]
pub struct SkeletonFolder {
    folder: PathBuf,
}

impl SkeletonFolder {
    /// Checks that the folder has a skeleton at least.
    ///
    /// # Errors
    /// With the folder's name.
    pub fn open(folder: &Path) -> Result<Self> {
        let shown = folder.display();
        let mut names = folder.read_dir().with_context(|| format!("{shown}"))?;
        let is_skeleton = |name: &str| name.ends_with("_keypoints.json");
        let any = names.any(|entry| {
            entry.is_ok_and(|entry| entry.file_name().to_str().is_some_and(is_skeleton))
        });
        ensure!(any, "{shown}: no skeletons: give a folder with OpenPose's 000000_keypoints.json");
        Ok(Self { folder: folder.to_owned() })
    }
}

impl PoseSource for SkeletonFolder {
    fn people(&mut self, frame: &Frame<'_>) -> Result<Option<Vec<ImageBody>>> {
        let path = self.folder.join(format!("{:06}_keypoints.json", frame.entry.frame));
        let mut bytes = Vec::new();
        match File::open(&path) {
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(None),
            Err(error) => Err(error),
            Ok(file) => file.take(LARGEST + 1).read_to_end(&mut bytes),
        }
        .with_context(|| path.display().to_string())?;
        let people = ImageBody::from_openpose(&bytes);
        people.map(Some).with_context(|| path.display().to_string())
    }
}
