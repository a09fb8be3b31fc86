//! Writing a folder of frames.

use std::{
    fs::{self, File},
    io::{BufWriter, Write},
    path::{Path, PathBuf},
};

use serde::Serialize;
use vision_models::{Camera, DepthImage};

use super::{
    FrameEntry, FramesError,
    format::{CAMERA, CameraFile, End, EndLine, INDEX},
};
use crate::rendering::{RenderedImage, depth_png};

/// The unit of written depths (m).
const SCALE: f64 = 0.001;

/// A folder of frames that grows: a frame's images are there before its line in the index.
#[derive(Debug)]
pub struct FramesWriter {
    folder: PathBuf,
    index: BufWriter<File>,
    frames: u64,
}

impl FramesWriter {
    /// Begins a folder, which is made if it is not there.
    ///
    /// # Errors
    /// [`FramesError::Occupied`] or [`FramesError::File`].
    pub fn create(folder: &Path, camera: &Camera) -> Result<Self, FramesError> {
        let index = folder.join(INDEX);
        if index.exists() {
            return Err(FramesError::Occupied { path: folder.to_owned() });
        }
        for part in ["colour", "depth", "skeletons", "surface"] {
            let path = folder.join(part);
            fs::create_dir_all(&path).map_err(|source| FramesError::File { path, source })?;
        }
        let text = line(&CameraFile::new(camera, SCALE))?;
        write(&folder.join(CAMERA), text.as_bytes())?;
        let file = File::create(&index)
            .map_err(|source| FramesError::File { path: index.clone(), source })?;
        Ok(Self { folder: folder.to_owned(), index: BufWriter::new(file), frames: 0 })
    }

    /// Writes a frame: its images and that of the on-board camera, its skeletons in OpenPose's JSON, and its line.
    ///
    /// # Errors
    /// [`FramesError::File`].
    pub fn write(
        &mut self,
        entry: &FrameEntry,
        image: &RenderedImage,
        depth: &DepthImage,
        surface: &RenderedImage,
        skeletons: &str,
    ) -> Result<(), FramesError> {
        let place = |part: &str| entry.file(&self.folder.join(part), "png");
        for (path, png) in [
            (place("colour"), image.colour_png()),
            (place("depth"), depth_png(depth)),
            (place("surface"), surface.colour_png()),
        ] {
            let png = png.map_err(|error| FramesError::File {
                path: path.clone(),
                source: std::io::Error::other(error),
            })?;
            write(&path, &png)?;
        }
        let skeletons_path =
            self.folder.join("skeletons").join(format!("{:06}_keypoints.json", entry.frame));
        write(&skeletons_path, skeletons.as_bytes())?;
        self.frames += 1;
        self.push(&line(entry)?)
    }

    /// Closes the index.
    ///
    /// # Errors
    /// [`FramesError::File`].
    pub fn finish(mut self) -> Result<(), FramesError> {
        let end = line(&EndLine { end: End { frames: self.frames } })?;
        self.push(&end)
    }

    /// Writes a line that a reader sees at once.
    fn push(&mut self, text: &str) -> Result<(), FramesError> {
        let written = writeln!(self.index, "{text}").and_then(|()| self.index.flush());
        written.map_err(|source| FramesError::File { path: self.folder.join(INDEX), source })
    }
}

fn line(value: &impl Serialize) -> Result<String, FramesError> {
    serde_json::to_string(value)
        .map_err(|error| FramesError::File { path: PathBuf::from(INDEX), source: error.into() })
}

/// Writes a whole file, or none: what could not be written is taken away again.
fn write(path: &Path, bytes: &[u8]) -> Result<(), FramesError> {
    fs::write(path, bytes).map_err(|source| {
        // Whether it can be removed changes nothing in what is said.
        let _ = fs::remove_file(path);
        FramesError::File { path: path.to_owned(), source }
    })
}
