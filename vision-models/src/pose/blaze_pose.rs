//! The landmarks of everyone in the images of a camera, one after the other.

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

/// BlazePose: thirty-three landmarks of each person, in the image and in metres. V. Bazarevsky et al., "BlazePose:
/// on-device real-time body pose tracking", 2020. Both networks are MediaPipe's files (Apache-2.0), which the npm package
/// `@mediapipe/pose` holds.
///
/// A detector finds people; in later images each is looked for around where their landmarks were, and the detector
/// runs only while fewer people are followed than [`BlazePoseSettings::most`]. Regions are steadied over time as
/// MediaPipe's are; landmarks are as they are seen.
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
    /// What the networks see.
    inputs: [Array4<f32>; 2],
}

/// A person who is looked for where they are expected.
#[derive(Debug)]
struct Followed {
    region: PoseRegion,
    steady: Steady,
}

/// Whom BlazePose looks for. The defaults are MediaPipe's.
///
/// ```
/// use vision_models::BlazePoseSettings;
///
/// assert!(BlazePoseSettings { most: 3, ..BlazePoseSettings::default() }.validate().is_ok());
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BlazePoseSettings {
    /// The most people who are followed: at least one.
    pub most: usize,
    /// The least score of a person whom the detector finds, from 0 to 1.
    pub detection: f64,
    /// The least score of a person in their region, from 0 to 1.
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
    /// [`Error::Value`].
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

/// Regions that share so much of their area are of one person.
const OVERLAP: f64 = 0.5;

/// The outputs of the network of landmarks that are read: points, score, maps, metric points.
const READ: [usize; 4] = [0, 1, 3, 4];

impl BlazePose {
    /// Takes the detector and any of the networks of landmarks (lite, full, heavy).
    ///
    /// # Errors
    /// [`Error::Malformed`] for another network; [`Error::Value`] for a setting; as of [`TensorFlowLite::load`].
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

    /// Runs on other threads from now on, which networks may share.
    ///
    /// # Errors
    /// As of [`Network::share_threads`].
    pub fn share_threads(&mut self, threads: &Threads) -> Result<(), Error> {
        self.detector.share_threads(threads)?;
        self.landmarks.share_threads(threads)
    }

    /// The people in the next image of a camera, height × width × 3: red, green, blue; `time` is when it was taken (s).
    ///
    /// # Errors
    /// [`Error::Size`] for an image without pixels or of other channels, [`Error::Overflow`] if activations overflow.
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

    /// Expects nobody any more: what comes next are other images.
    pub fn forget(&mut self) {
        self.followed.clear();
    }

    /// The regions of all people whom the detector finds, the surest first.
    ///
    /// # Errors
    /// As of [`Self::estimate`].
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

    /// The person in a region, whatever their score.
    ///
    /// # Errors
    /// As of [`Self::estimate`]; [`Error::Value`] for a region that is none.
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

/// Whether a file holds the network that is asked for.
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
