//! Writes a folder of frames.

use std::{
    fs::{self, File},
    io::{self, BufWriter, Cursor, Write},
    path::{Path, PathBuf},
};

use image::{
    ExtendedColorType, ImageEncoder,
    codecs::png::{CompressionType, FilterType, PngEncoder},
};
use serde::Serialize;
use vision_models::{Camera, DepthImage};

use super::format::{CAMERA, CameraFile, End, EndLine, FrameEntry, INDEX};
use crate::error::Error;

/// The unit of written depths (m).
const SCALE: f64 = 0.001;

/// Red, green and blue of each pixel, row by row.
#[derive(Clone, Copy, Debug)]
pub struct ColourImage<'a> {
    /// Width and height (pixels).
    pub size: [usize; 2],
    /// Three bytes per pixel.
    pub pixels: &'a [u8],
}

/// A growing folder of frames. A frame's images are complete before its line in the index.
#[derive(Debug)]
pub struct FramesWriter {
    folder: PathBuf,
    index: BufWriter<File>,
    frames: u64,
}

impl FramesWriter {
    /// Creates the writer of a folder, and the folder itself if it does not exist.
    ///
    /// # Errors
    /// [`Error::Unfit`] if the folder already holds frames, [`Error::Read`] if it cannot be
    /// written.
    pub fn create(folder: &Path, camera: &Camera) -> Result<Self, Error> {
        let index = folder.join(INDEX);
        if index.exists() {
            let wanted = "give a folder without a frames.jsonl";
            return Err(Error::unfit(folder.display(), "it holds frames already", wanted));
        }
        for part in ["colour", "depth", "skeletons", "surface"] {
            let path = folder.join(part);
            fs::create_dir_all(&path).map_err(Error::read(path))?;
        }
        let text = line(&CameraFile::new(camera, SCALE))?;
        write(&folder.join(CAMERA), text.as_bytes())?;
        let file = File::create(&index).map_err(Error::read(index))?;
        Ok(Self { folder: folder.to_owned(), index: BufWriter::new(file), frames: 0 })
    }

    /// Writes a frame: its images, the on-board camera's image, its skeletons in OpenPose's JSON,
    /// and its line.
    ///
    /// # Errors
    /// [`Error::Read`] if a file cannot be written.
    pub fn write(
        &mut self,
        entry: &FrameEntry,
        image: ColourImage<'_>,
        depth: &DepthImage,
        surface: ColourImage<'_>,
        skeletons: &str,
    ) -> Result<(), Error> {
        let place = |part: &str| entry.file(&self.folder.join(part), "png");
        for (path, png) in [
            (place("colour"), image.png()),
            (place("depth"), depth_png(depth)),
            (place("surface"), surface.png()),
        ] {
            let png = png.map_err(|error| Error::read(&path)(io::Error::other(error)))?;
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
    /// [`Error::Read`] if the index cannot be written.
    pub fn finish(mut self) -> Result<(), Error> {
        let end = line(&EndLine { end: End { frames: self.frames } })?;
        self.push(&end)
    }

    /// Writes a line and flushes it, so that a reader sees it at once.
    fn push(&mut self, text: &str) -> Result<(), Error> {
        let written = writeln!(self.index, "{text}").and_then(|()| self.index.flush());
        written.map_err(Error::read(self.folder.join(INDEX)))
    }
}

fn line(value: &impl Serialize) -> Result<String, Error> {
    serde_json::to_string(value).map_err(|error| Error::read(INDEX)(error.into()))
}

/// Writes a complete file or none. A file that could not be written completely is removed.
fn write(path: &Path, bytes: &[u8]) -> Result<(), Error> {
    fs::write(path, bytes).map_err(|source| {
        // A failure of the removal does not change the error.
        let _ = fs::remove_file(path);
        Error::read(path)(source)
    })
}

impl ColourImage<'_> {
    /// Returns the image as a PNG file.
    fn png(self) -> Result<Vec<u8>, image::ImageError> {
        png(self.pixels, self.size, ExtendedColorType::Rgb8)
    }
}

/// Returns depths as a PNG file of 16 bits per pixel, in millimetres. 0 where there is none.
fn depth_png(depth: &DepthImage) -> Result<Vec<u8>, image::ImageError> {
    let bytes: Vec<u8> = depth
        .depths()
        .iter()
        .flat_map(|&metres| {
            let millimetres = (1e3 * metres).round().clamp(0.0, f32::from(u16::MAX));
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped")]
            let millimetres = millimetres as u16;
            // The encoder expects the machine's byte order.
            millimetres.to_ne_bytes()
        })
        .collect();
    png(&bytes, depth.size(), ExtendedColorType::L16)
}

fn png(
    bytes: &[u8],
    [width, height]: [usize; 2],
    colour: ExtendedColorType,
) -> Result<Vec<u8>, image::ImageError> {
    let mut file = Cursor::new(Vec::new());
    let side = |side: usize| u32::try_from(side).unwrap_or(u32::MAX);
    PngEncoder::new_with_quality(&mut file, CompressionType::Fast, FilterType::Sub).write_image(
        bytes,
        side(width),
        side(height),
        colour,
    )?;
    Ok(file.into_inner())
}
