//! The landmarks of all people in the successive images of a camera.

mod detection;
mod landmarks;
mod region;
mod steady;

use nalgebra::Point2;
use ndarray::{Array4, ArrayView3, Axis, s};

use crate::engine::{Network, Options, Threads, wrong_input};
use crate::error::Error;
use crate::networks::TensorFlowLite;

use super::sampling::check_image;
use landmarks::Numbers;
pub use landmarks::{Landmark, Landmarks};
use region::Edge;
pub use region::PoseRegion;
use steady::Steady;

/// BlazePose: thirty-three landmarks of each person, in the image and in metres. V. Bazarevsky et
/// al., "BlazePose: on-device real-time body pose tracking", 2020. Both networks are MediaPipe's
/// files (Apache-2.0) from the npm package `@mediapipe/pose`.
///
/// A detector finds people. In later images each person is searched near their previous landmarks.
/// The detector runs only while fewer people are tracked than [`BlazePoseSettings::most`]. Regions
/// are smoothed over time as in MediaPipe. Landmarks are not smoothed.
///
/// ```no_run
/// use vision_models::{BlazePose, BlazePoseSettings, Body25, Options, TensorFlowLite, read_image};
///
/// let detector = TensorFlowLite::open("pose_solution_packed_assets.data")?;
/// let landmarks = TensorFlowLite::open("pose_landmark_full.tflite")?;
/// let settings = BlazePoseSettings::default();
/// let mut network = BlazePose::load(detector, landmarks, settings, Options::default())?;
/// let image = read_image("frame.jpg")?;
/// for person in network.estimate(0.0, image.view())? {
///     println!("{:?}", person.body().image.get(Body25::RightWrist));
/// }
/// # Ok::<(), vision_models::Error>(())
/// ```
#[derive(Debug)]
pub struct BlazePose {
    detector: Network,
    landmarks: Network,
    settings: BlazePoseSettings,
    /// The people of the last image.
    followed: Vec<Followed>,
    /// The inputs of the networks.
    inputs: [Array4<f32>; 2],
}

/// A tracked person and the region in which they are expected.
#[derive(Debug)]
struct Followed {
    region: PoseRegion,
    steady: Steady,
}

/// The settings of BlazePose. The defaults are MediaPipe's.
///
/// ```
/// use vision_models::BlazePoseSettings;
///
/// assert!(BlazePoseSettings { most: 3, ..BlazePoseSettings::default() }.validate().is_ok());
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BlazePoseSettings {
    /// Largest number of people who are tracked, at least one.
    pub most: usize,
    /// Smallest score of a person whom the detector finds, from 0 to 1.
    pub detection: f64,
    /// Smallest score of a person in their region, from 0 to 1.
    pub presence: f64,
}

impl Default for BlazePoseSettings {
    fn default() -> Self {
        Self { most: 1, detection: 0.5, presence: 0.5 }
    }
}

impl BlazePoseSettings {
    /// Checks every setting.
    ///
    /// # Errors
    /// [`Error::Value`] names the first setting that is out of range.
    pub fn validate(&self) -> Result<(), Error> {
        let Self { most, detection, presence } = *self;
        for (name, value) in [("detection", detection), ("presence", presence)] {
            if !(0.0..=1.0).contains(&value) {
                return Err(Error::value(name, value, "a number from 0 to 1"));
            }
        }
        if most == 0 {
            return Err(Error::value("most", most, "one person at least"));
        }
        Ok(())
    }
}

/// Regions that share this part of their area belong to one person.
const OVERLAP: f64 = 0.5;

/// The outputs of the landmark network that are read: points, score, maps, metric points.
const READ: [usize; 4] = [0, 1, 3, 4];

impl BlazePose {
    /// Loads the detector and any of the landmark networks (lite, full, heavy).
    ///
    /// # Errors
    /// - [`Error::Malformed`] if a file holds another network.
    /// - [`Error::Value`] if a setting is out of range.
    /// - Those of [`TensorFlowLite::load`].
    pub fn load(
        detector: TensorFlowLite,
        landmarks: TensorFlowLite,
        settings: BlazePoseSettings,
        options: Options,
    ) -> Result<Self, Error> {
        settings.validate()?;
        let numbers = [detection::NUMBERS, 1];
        let outputs = numbers.map(|numbers| [numbers, 1, detection::COUNT]);
        check("detector of BlazePose", &detector, detection::INPUT, &outputs)?;
        let points = landmarks::COUNT;
        let pixel = |channels| [channels, 1, 1];
        let side = landmarks::INPUT;
        let outputs = [
            pixel(landmarks::NUMBERS * points),
            pixel(1),
            [1, side, side],
            [points, side / 4, side / 4],
            pixel(3 * points),
        ];
        check("network of BlazePose's landmarks", &landmarks, side, &outputs)?;
        let input = |side| Array4::zeros((1, 3, side, side));
        Ok(Self {
            detector: detector.load(options)?,
            landmarks: landmarks.keep(&READ)?.load(options)?,
            settings,
            followed: Vec::new(),
            inputs: [input(detection::INPUT), input(side)],
        })
    }

    /// Makes the networks run on other threads, which networks may share.
    ///
    /// # Errors
    /// Those of [`Network::share_threads`].
    pub fn share_threads(&mut self, threads: &Threads) -> Result<(), Error> {
        self.detector.share_threads(threads)?;
        self.landmarks.share_threads(threads)
    }

    /// Returns the people in the next image of a camera, height × width × 3 (red, green, blue).
    /// `time` is its time stamp (s).
    ///
    /// # Errors
    /// - [`Error::Size`] if the image has no pixels or not three channels.
    /// - [`Error::Overflow`] if activations overflow.
    pub fn estimate(
        &mut self,
        time: f64,
        image: ArrayView3<'_, u8>,
    ) -> Result<Vec<Landmarks>, Error> {
        let mut followed = std::mem::take(&mut self.followed);
        if followed.len() < self.settings.most {
            for region in self.detect(image)? {
                if !followed.iter().any(|person| person.region.overlap(&region) > OVERLAP) {
                    followed.push(Followed { region, steady: Steady::default() });
                }
            }
            followed.truncate(self.settings.most);
        }
        let mut people = Vec::with_capacity(followed.len());
        for Followed { region, mut steady } in followed {
            let person = self.landmarks(image, &region)?;
            if person.score.value() < self.settings.presence {
                continue;
            }
            let region = PoseRegion::around(&steady.update(time, person.circle));
            let is_seen = |other: &Followed| other.region.overlap(&region) > OVERLAP;
            if region.validate().is_ok() && !self.followed.iter().any(is_seen) {
                self.followed.push(Followed { region, steady });
                people.push(person);
            }
        }
        Ok(people)
    }

    /// Forgets all people, to begin with other images.
    pub fn forget(&mut self) {
        self.followed.clear();
    }

    /// Returns the regions of all people whom the detector finds, in falling order of score.
    ///
    /// # Errors
    /// Those of [`Self::estimate`].
    pub fn detect(&mut self, image: ArrayView3<'_, u8>) -> Result<Vec<PoseRegion>, Error> {
        let [rows, columns] = check_image(&image)?.map(|side| side as f64);
        let centre = Point2::new(0.5 * columns, 0.5 * rows);
        let whole = PoseRegion { centre, side: rows.max(columns), angle: 0.0 };
        let [input, _] = &mut self.inputs;
        let value = |level: f32| level / 127.5 - 1.0;
        whole.sample(&image, Edge::Black, value, input.index_axis_mut(Axis(0), 0));
        let inference = self.detector.infer(input.view().insert_axis(Axis(2)))?;
        let output = |index| {
            let map = inference.map(index)?;
            Some(map.slice_move(s![0, .., 0, 0, ..]).reversed_axes())
        };
        let (Some(boxes), Some(scores)) = (output(0), output(1)) else {
            return Err(wrong_input(image.shape()));
        };
        let found = detection::decode(boxes, scores, self.settings.detection);
        let regions = found.iter().map(|region| region.within(&whole));
        Ok(regions.filter(|region| region.validate().is_ok()).collect())
    }

    /// Returns the person in a region, whatever their score.
    ///
    /// # Errors
    /// Those of [`Self::estimate`], and [`Error::Value`] if the region is invalid.
    pub fn landmarks(
        &mut self,
        image: ArrayView3<'_, u8>,
        region: &PoseRegion,
    ) -> Result<Landmarks, Error> {
        check_image(&image)?;
        region.validate()?;
        let [_, input] = &mut self.inputs;
        let value = |level: f32| level / 255.0;
        region.sample(&image, Edge::Nearest, value, input.index_axis_mut(Axis(0), 0));
        let inference = self.landmarks.infer(input.view().insert_axis(Axis(2)))?;
        let pixel = |index| Some(inference.map(index)?.slice_move(s![0, .., 0, 0, 0]));
        let maps = inference.map(2).map(|maps| maps.slice_move(s![0, .., 0, .., ..]));
        let (Some(points), Some(score), Some(maps), Some(metric)) =
            (pixel(0), pixel(1), maps, pixel(3))
        else {
            return Err(wrong_input(image.shape()));
        };
        let score = score.first().copied().unwrap_or_default();
        Ok(Numbers { points, metric, maps, score }.decode(region))
    }
}

/// Checks that a file holds the expected network.
fn check(
    wanted: &'static str,
    network: &TensorFlowLite,
    side: usize,
    outputs: &[[usize; 3]],
) -> Result<(), Error> {
    let found: Vec<_> = network.outputs().collect();
    if network.input() == [3, side, side] && found == outputs {
        return Ok(());
    }
    let input = network.input();
    let problem = format!("{input:?} values go in and {found:?} come out, which is no {wanted}");
    Err(Error::malformed("network", problem))
}
