//! Source of camera frames.

use std::path::Path;
use std::time::Duration;

use anyhow::{Result, ensure};
use human_perception::Error;
use human_perception::frames::{FrameEntry, FrameImages, FramesReader};
use vision_models::Camera;

#[cfg(feature = "ros2")]
use super::ros2::Ros2Source;

/// A source of camera frames.
#[derive(Debug)]
pub enum Source {
    /// A folder of files.
    Folder(Box<FolderSource>),
    /// A camera on the ROS 2 graph.
    #[cfg(feature = "ros2")]
    Ros2(Box<Ros2Source>),
}

/// A folder of files, of which a live program takes the newest.
#[derive(Debug)]
pub struct FolderSource {
    reader: FramesReader,
    is_live: bool,
    late: u64,
}

impl Source {
    /// Opens a folder. Its reader waits for so long for a further frame.
    ///
    /// # Errors
    /// Names the file of the folder that cannot be used.
    pub fn folder(folder: &Path, wait: Duration, is_live: bool) -> Result<Self> {
        let reader = FramesReader::open(folder, wait)?;
        Ok(Self::Folder(Box::new(FolderSource { reader, is_live, late: 0 })))
    }

    /// The camera.
    pub fn camera(&self) -> &Camera {
        match self {
            Self::Folder(folder) => folder.reader.camera(),
            #[cfg(feature = "ros2")]
            Self::Ros2(source) => source.camera(),
        }
    }

    /// Stature of the person \[m\], if the camera's file has it.
    pub fn stature(&self) -> Option<f64> {
        match self {
            Self::Folder(folder) => folder.reader.stature(),
            #[cfg(feature = "ros2")]
            Self::Ros2(source) => source.stature(),
        }
    }

    /// Checks that there can be images of a surface.
    ///
    /// # Errors
    /// A folder without them.
    pub fn check_surfaces(&self) -> Result<()> {
        let images = match self {
            Self::Folder(folder) => folder.reader.surfaces(),
            #[cfg(feature = "ros2")]
            Self::Ros2(_) => return Ok(()),
        };
        ensure!(images.is_dir(), "{}: there are no images of a surface", images.display());
        Ok(())
    }

    /// The next frame, or the newest one of a live source; `None` at the end, or once `stop` returns true. The images may
    /// be unusable.
    ///
    /// # Errors
    /// A source that ends by an error.
    pub fn next(
        &mut self,
        stop: impl Fn() -> bool,
    ) -> Result<Option<(FrameEntry, Result<FrameImages, Error>)>> {
        match self {
            Self::Folder(folder) => folder.next(stop),
            #[cfg(feature = "ros2")]
            Self::Ros2(source) => Ok(source.next(stop).map(|images| (images.entry, Ok(images)))),
        }
    }

    /// Number of frames that the camera lost.
    pub fn lost(&self) -> u64 {
        match self {
            Self::Folder(folder) => folder.reader.lost(),
            // Its report has them by topic.
            #[cfg(feature = "ros2")]
            Self::Ros2(_) => 0,
        }
    }

    /// Number of frames that a newer one overtook.
    pub fn late(&self) -> u64 {
        match self {
            Self::Folder(folder) => folder.late,
            #[cfg(feature = "ros2")]
            Self::Ros2(source) => source.overtaken(),
        }
    }
}

impl FolderSource {
    fn next(
        &mut self,
        stop: impl Fn() -> bool,
    ) -> Result<Option<(FrameEntry, Result<FrameImages, Error>)>> {
        let entry = if self.is_live {
            let newest = self.reader.newest_entry(stop)?;
            newest.map(|(entry, left_out)| {
                self.late += left_out;
                entry
            })
        } else {
            self.reader.next_entry(stop)?
        };
        Ok(entry.map(|entry| (entry, self.reader.images(&entry))))
    }
}
