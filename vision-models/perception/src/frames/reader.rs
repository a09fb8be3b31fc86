//! Reads a folder of frames, also one that grows.

use std::{
    fs::File,
    io::{BufRead, BufReader, Read},
    path::{Path, PathBuf},
    thread,
    time::{Duration, Instant},
};

use vision_models::{
    Camera, DepthImage,
    file::{Excerpt, read_text},
    read_depth,
};

use super::format::{CAMERA, CameraFile, EndLine, FrameEntry, INDEX};
use super::images::{FrameImages, Picture};
use crate::{error::Error, npy};

/// Interval between checks of a growing folder.
const LOOK: Duration = Duration::from_millis(5);

/// Longest line and largest camera file (bytes).
const LONGEST: u64 = 4096;
const LARGEST: u64 = 1 << 20;

/// The expected form of a camera file.
const CAMERA_WANTED: &str = concat!(
    r#"give the camera as {"format":"moca-frames","version":1,"width":640,"height":480,"fx":615.0,"fy":615.0,"#,
    r#""cx":319.5,"cy":239.5,"depth_scale":0.001,"position":[0.3,1.8,2.3],"quaternion":[x,y,z,w],"#,
    r#""noise":{"constant":0.001,"quadratic":0.00416},"gravity":null,"stature":null}"#
);

/// The expected form of a line.
const LINE_WANTED: &str = concat!(
    r#"a line is such as {"frame":12,"time":0.6,"arrived":0.64}, with "arrived" null where it is not known, "#,
    r#"and the last {"end":{"frames":13}}"#
);

/// A camera and its place in the world, as `camera.json` of a folder describes it.
#[derive(Clone, Copy, Debug)]
pub struct PlacedCamera {
    /// The camera.
    pub camera: Camera,
    /// Size of a unit of its depth images (m).
    pub depth_scale: f64,
    /// Stature of the person in front of it (m), if it is known.
    pub stature: Option<f64>,
}

impl PlacedCamera {
    /// Reads the file `camera.json` of a folder.
    ///
    /// # Errors
    /// Names the file, and the expected form.
    pub fn read(folder: &Path) -> Result<Self, Error> {
        let path = folder.join(CAMERA);
        let file = camera_file(&path)?;
        let camera = file.camera().map_err(unfit_camera(&path))?;
        Ok(Self { camera, depth_scale: file.depth_scale, stature: file.stature })
    }
}

/// Reads a camera's file, whatever place it has.
pub(super) fn camera_file(path: &Path) -> Result<CameraFile, Error> {
    let text = read_text(path, LARGEST).map_err(Error::read(path))?;
    let problem = |problem: String| Error::unfit(path.display(), problem, CAMERA_WANTED);
    let file: CameraFile =
        serde_json::from_str(&text).map_err(|error| problem(error.to_string()))?;
    if !file.is_known() {
        return Err(problem("it is of another format or version".to_owned()));
    }
    Ok(file)
}

/// Creates the error of a camera's file with this content.
pub(super) fn unfit_camera(path: &Path) -> impl Fn(vision_models::Error) -> Error {
    move |error| Error::unfit(path.display(), error, CAMERA_WANTED)
}

/// Reads the depth image in this PNG file, or in the array beside it.
pub(super) fn depth_image(png: &Path, scale: f64) -> Result<DepthImage, Error> {
    let array = png.with_extension("npy");
    if !array.exists() {
        return Ok(read_depth(png, scale)?);
    }
    let depths = npy::read_array(&array)?;
    let &[height, width] = depths.shape() else {
        let found = format!("its shape is {:?}, not rows × columns", depths.shape());
        return Err(Error::at(array.display(), found));
    };
    let depths = depths.iter().copied().collect();
    Ok(DepthImage::from_metres([width, height], depths)?)
}

/// A folder of frames.
#[derive(Debug)]
pub struct FramesReader {
    folder: PathBuf,
    camera: Camera,
    scale: f64,
    stature: Option<f64>,
    index: BufReader<File>,
    /// The beginning of a line that is still being written.
    begun: Vec<u8>,
    line: usize,
    previous: Option<FrameEntry>,
    frames: u64,
    lost: u64,
    wait: Duration,
    ended: bool,
}

impl FramesReader {
    /// Opens a folder. If the index is not closed, the reader waits up to `wait` for a further
    /// frame at its end.
    ///
    /// All existing lines are checked at once: their order, and the existence of the depth images.
    ///
    /// # Errors
    /// [`Error`] with the file and the line.
    pub fn open(folder: &Path, wait: Duration) -> Result<Self, Error> {
        let begin = |wait| Self::begin(folder, wait);
        let mut check = begin(Duration::ZERO)?;
        while check.next_entry(|| false)?.is_some() {}
        if check.frames == 0 && (wait.is_zero() || check.ended) {
            let index = folder.join(INDEX);
            return Err(Error::at(index.display(), "it has no frame"));
        }
        begin(wait)
    }

    fn begin(folder: &Path, wait: Duration) -> Result<Self, Error> {
        let PlacedCamera { camera, depth_scale: scale, stature } = PlacedCamera::read(folder)?;
        let index = folder.join(INDEX);
        let file = File::open(&index).map_err(Error::read(&index))?;
        Ok(Self {
            folder: folder.to_owned(),
            scale,
            stature,
            camera,
            index: BufReader::new(file),
            begun: Vec::new(),
            line: 0,
            previous: None,
            frames: 0,
            lost: 0,
            wait,
            ended: false,
        })
    }

    /// Returns the camera.
    pub fn camera(&self) -> &Camera {
        &self.camera
    }

    /// Returns the person's stature (m), if the camera's file has it.
    pub fn stature(&self) -> Option<f64> {
        self.stature
    }

    /// Returns how many frame numbers were missing so far. These frames were lost by the camera.
    pub fn lost(&self) -> u64 {
        self.lost
    }

    /// Returns the next frame. `None` at the end, or if `stop` returns true while the reader waits
    /// for a frame.
    ///
    /// # Errors
    /// [`Error`] with the line.
    pub fn next_entry(&mut self, stop: impl Fn() -> bool) -> Result<Option<FrameEntry>, Error> {
        let started = Instant::now();
        while !self.ended {
            if let Some(text) = self.next_line()? {
                if let Some(entry) = self.parse(&text)? {
                    return Ok(Some(entry));
                }
            } else if started.elapsed() >= self.wait || stop() {
                break;
            } else {
                thread::sleep(LOOK);
            }
        }
        Ok(None)
    }

    /// Returns the newest frame that is there, and the number of older ones that are left out for it. Waits for one as
    /// [`next_entry`](Self::next_entry) does.
    ///
    /// # Errors
    /// Those of [`next_entry`](Self::next_entry).
    pub fn newest_entry(
        &mut self,
        stop: impl Fn() -> bool,
    ) -> Result<Option<(FrameEntry, u64)>, Error> {
        let Some(mut newest) = self.next_entry(stop)? else { return Ok(None) };
        let mut left_out = 0;
        while let Some(entry) = self.next_entry(|| true)? {
            (newest, left_out) = (entry, left_out + 1);
        }
        Ok(Some((newest, left_out)))
    }

    /// Returns the depth image of a frame.
    ///
    /// # Errors
    /// Names the file that cannot be used.
    pub fn depth(&self, entry: &FrameEntry) -> Result<DepthImage, Error> {
        depth_image(&entry.file(&self.folder.join("depth"), "png"), self.scale)
    }

    /// Returns the path of the colour image of a frame.
    pub fn colour(&self, entry: &FrameEntry) -> PathBuf {
        let folder = self.folder.join("colour");
        let jpeg = entry.file(&folder, "jpg");
        if jpeg.exists() { jpeg } else { entry.file(&folder, "png") }
    }

    /// Returns the path of the on-board camera's image for a frame, which may not exist.
    pub fn surface(&self, entry: &FrameEntry) -> PathBuf {
        entry.file(&self.surfaces(), "png")
    }

    /// Returns all images of a frame. Colour images stay in their files.
    ///
    /// # Errors
    /// [`Error::Frame`] with the name of a depth image that cannot be used.
    pub fn images(&self, entry: &FrameEntry) -> Result<FrameImages, Error> {
        let started = Instant::now();
        let depth = self.depth(entry).map_err(|error| Error::Frame(Box::new(error)))?;
        let images = FrameImages::new(*entry, depth, Picture::File(self.colour(entry)));
        let surface = self.surface(entry);
        let surface = surface.exists().then_some(Picture::File(surface));
        Ok(FrameImages { surface, ..images.arrived_at(started) })
    }

    /// Returns the folder of the on-board camera's images.
    pub fn surfaces(&self) -> PathBuf {
        self.folder.join("surface")
    }

    /// Returns the next complete line.
    fn next_line(&mut self) -> Result<Option<String>, Error> {
        let path = self.folder.join(INDEX);
        let room = LONGEST.saturating_sub(self.begun.len() as u64);
        let read = self.index.by_ref().take(room).read_until(b'\n', &mut self.begun);
        read.map_err(Error::read(path))?;
        if self.begun.last() != Some(&b'\n') {
            let long = self.begun.len() as u64 >= LONGEST;
            return if long {
                Err(self.problem("a line of 4096 bytes".to_owned()))
            } else {
                Ok(None)
            };
        }
        self.line += 1;
        let text = String::from_utf8_lossy(&self.begun).into_owned();
        self.begun.clear();
        Ok(Some(text))
    }

    /// Returns the frame of a line, if it is one.
    fn parse(&mut self, text: &str) -> Result<Option<FrameEntry>, Error> {
        if text.trim().is_empty() {
            return Ok(None);
        }
        if text.trim_start().starts_with("{\"end\"") {
            let EndLine { end } =
                serde_json::from_str(text).map_err(|error| self.problem(error.to_string()))?;
            if end.frames != self.frames {
                let (said, found) = (end.frames, self.frames);
                return Err(
                    self.problem(format!("{said} frames at the end, and there are {found}"))
                );
            }
            self.ended = true;
            return Ok(None);
        }
        let entry: FrameEntry = serde_json::from_str(text)
            .map_err(|error| self.problem(Excerpt(&error.to_string()).to_string()))?;
        let FrameEntry { frame, time, arrived } = entry;
        if !time.is_finite() || arrived.is_some_and(|arrived| arrived.is_nan() || arrived < time) {
            return Err(self.problem(format!("taken at {time} s and arrived at {arrived:?} s")));
        }
        if let Some(previous) = self.previous {
            if frame <= previous.frame || time <= previous.time {
                let FrameEntry { frame: before, time: then, .. } = previous;
                return Err(self.at_line(
                    format!("frame {frame} of {time} s comes after frame {before} of {then} s"),
                    "a frame is there once, and frames are in the order of number and time",
                ));
            }
            self.lost += frame - previous.frame - 1;
        }
        let depth = self.folder.join("depth");
        if !["png", "npy"].iter().any(|extension| entry.file(&depth, extension).exists()) {
            let depth = entry.file(&depth, "").with_extension("");
            let depth = depth.display();
            return Err(self.at_line(
                format!(
                    "frame {frame} is listed, but there is neither {depth}.png nor {depth}.npy"
                ),
                "write a frame's images before its line",
            ));
        }
        self.previous = Some(entry);
        self.frames += 1;
        Ok(Some(entry))
    }

    fn problem(&self, problem: String) -> Error {
        self.at_line(problem, LINE_WANTED)
    }

    fn at_line(&self, found: String, wanted: &str) -> Error {
        let index = self.folder.join(INDEX);
        let place = format!("{}, line {}", index.display(), self.line.max(1));
        Error::unfit(place, found, wanted)
    }
}
