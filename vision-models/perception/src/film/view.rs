//! View of people by a camera, image by image.

use std::path::Path;

use ndarray::Array3;
use vision_models::{
    BlazePose, BlazePoseSettings, JointFrame, ObservedBody, Options, TensorFlowLite,
    file::read_bytes, is_hidden,
};

use super::images::FilmImages;
use crate::error::Error;

/// The file of MediaPipe's package that holds BlazePose's detector.
const DETECTOR: &str = "pose_solution_packed_assets.data";

/// One camera's film: its images with BlazePose, or the joints that another program has found in them.
#[derive(Debug)]
pub struct View {
    source: Source,
    /// The next image, from 0.
    number: u64,
    /// Images a second.
    rate: f64,
}

#[derive(Debug)]
enum Source {
    Images {
        images: FilmImages,
        /// The first image, which told how large all are.
        first: Option<Array3<u8>>,
        size: [usize; 2],
        network: Box<BlazePose>,
    },
    Joints {
        frames: std::iter::Peekable<std::vec::IntoIter<JointFrame>>,
    },
}

impl View {
    /// Opens a folder of images or a video, so many a second, with the networks of BlazePose: the landmarks, and the
    /// detector, which is MediaPipe's file beside them if none is given. It finds so many people at most.
    ///
    /// # Errors
    /// A file that cannot be used, by its name.
    pub fn images(
        film: &Path,
        rate: f64,
        [landmarks, detector]: [Option<&Path>; 2],
        most: usize,
        threads: usize,
    ) -> Result<Self, Error> {
        let landmarks = landmarks.unwrap_or(Path::new("pose_landmark_full.tflite"));
        let beside = landmarks.with_file_name(DETECTOR);
        let detector = detector.unwrap_or(&beside);
        let open = |file: &Path| TensorFlowLite::open(file).map_err(Error::content(file));
        let settings = BlazePoseSettings { most, ..BlazePoseSettings::default() };
        let options = Options { threads, ..Options::default() };
        let network = BlazePose::load(open(detector)?, open(landmarks)?, settings, options);
        let network = Box::new(network.map_err(Error::content(landmarks))?);
        let mut images = FilmImages::open(film, rate)?;
        let first = images.next_image()?;
        let first = first.ok_or_else(|| Error::at(film.display(), "it has no images"))?;
        let (rows, columns, _) = first.dim();
        let source = Source::Images { images, first: Some(first), size: [columns, rows], network };
        Ok(Self { source, number: 0, rate })
    }

    /// Opens a file with the joints of a whole film, or a folder with a file of joints for each image. In a folder the names
    /// end in the image's number. There are so many images a second, of `size` in pixels: [`JointFrame::from_json`] says
    /// which files need it.
    ///
    /// # Errors
    /// A file that cannot be used, by its name.
    pub fn joints(path: &Path, rate: f64, size: Option<[usize; 2]>) -> Result<Self, Error> {
        let read = |path: &Path| {
            let bytes = read_bytes(path, JointFrame::LARGEST).map_err(Error::read(path))?;
            JointFrame::from_json(&bytes, size).map_err(Error::content(path))
        };
        let mut frames = Vec::new();
        if path.is_dir() {
            for entry in path.read_dir().map_err(Error::read(path))? {
                let file = entry.map_err(Error::read(path))?.path();
                let Some(number) = number(&file) else { continue };
                let people = read(&file)?.into_iter().flat_map(|frame| frame.people).collect();
                frames.push(JointFrame { number, people });
            }
            frames.sort_by_key(|frame| frame.number);
        } else {
            frames = read(path)?;
        }
        let first = frames.first().map(|frame| frame.number);
        let number = first.ok_or_else(|| Error::at(path.display(), "no joints of any image"))?;
        let frames = frames.into_iter().peekable();
        Ok(Self { source: Source::Joints { frames }, number, rate })
    }

    /// Size of the images, if there are images (pixels).
    pub fn size(&self) -> Option<[usize; 2]> {
        match self.source {
            Source::Images { size, .. } => Some(size),
            Source::Joints { .. } => None,
        }
    }

    /// The number of the next image.
    pub(super) fn number(&self) -> u64 {
        self.number
    }

    /// Begins no earlier than at this image.
    pub(super) fn skip_to(&mut self, number: u64) -> Result<(), Error> {
        while self.number < number && self.next_people()?.is_some() {}
        Ok(())
    }

    /// The people in the next image, where somebody was seen; `None` at the end.
    pub(super) fn next_people(&mut self) -> Result<Option<Vec<ObservedBody>>, Error> {
        let number = self.number;
        let time = number as f64 / self.rate;
        let people = match &mut self.source {
            Source::Images { images, first, network, .. } => {
                let image = match first.take() {
                    Some(image) => Some(image),
                    None => images.next_image()?,
                };
                let Some(image) = image else { return Ok(None) };
                let people = network.estimate(time, image.view())?;
                people.iter().map(vision_models::Landmarks::body).collect()
            }
            Source::Joints { frames } => {
                if frames.peek().is_none() {
                    return Ok(None);
                }
                let frame = frames.next_if(|frame| frame.number <= number);
                frame.map(|frame| frame.people).unwrap_or_default()
            }
        };
        self.number += 1;
        Ok(Some(people))
    }
}

/// The number at the end of a name such as `film_000012_keypoints.json`.
fn number(file: &Path) -> Option<u64> {
    let name = file.file_name()?;
    let stem = name.to_str().filter(|_| !is_hidden(name))?.strip_suffix(".json")?;
    let stem = stem.strip_suffix("_keypoints").unwrap_or(stem);
    stem[stem.trim_end_matches(|last: char| last.is_ascii_digit()).len()..].parse().ok()
}
