//! Networks that find people's joints in an image.

use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use vision_models::{
    BlazePoseSettings, GroupingSettings, Landmark, ObservedBody, Passes, PersonBox,
};

use super::arrays::{depth, image, points};
use super::body::ImageBody;
use super::camera::Camera;
use super::tensorflow_lite::open;
use super::weights::{Weights, options};
use crate::arrays::{numbers, to_vector};
use crate::failure::{Failure, Result};
use crate::shared::Shared;

/// BlazePose: thirty-three landmarks of each person, in the image and in metres. People are followed from image to image.
///
/// `BlazePose(detector, landmarks, *, most=1, detection=0.5, presence=0.5, threads=1)`
///
/// Parameters
/// ----------
/// detector : path or bytes
///     `pose_solution_packed_assets.data` of the npm package `@mediapipe/pose` (Apache-2.0).
/// landmarks : path or bytes
///     `pose_landmark_lite.tflite`, `pose_landmark_full.tflite` or `pose_landmark_heavy.tflite` of that package.
/// most : int
///     Largest number of people who are followed.
/// detection : float
///     Smallest score of a person whom the detector finds, from 0 to 1.
/// presence : float
///     Smallest score of a person who is followed, from 0 to 1.
/// threads : int
///     Threads that share the work.
///
/// The package `ahqp` contains no weights: `npm pack @mediapipe/pose` has these. Images are arrays of uint8, (height, width,
/// 3): red, green, blue. OpenCV has blue first.
#[pyclass(frozen, module = "ahqp.vision")]
pub(crate) struct BlazePose(Shared<vision_models::BlazePose>);

#[pymethods]
impl BlazePose {
    #[new]
    #[pyo3(signature = (detector, landmarks, *, most=1, detection=0.5, presence=0.5, threads=1))]
    fn new(
        py: Python<'_>,
        detector: &Bound<'_, PyAny>,
        landmarks: &Bound<'_, PyAny>,
        most: usize,
        detection: f64,
        presence: f64,
        threads: usize,
    ) -> Result<Self> {
        let settings = BlazePoseSettings { most, detection, presence };
        let (detector, landmarks) = (open("detector", detector)?, open("landmarks", landmarks)?);
        let network = py.detach(|| {
            vision_models::BlazePose::load(detector, landmarks, settings, options(threads))
        })?;
        Ok(Self(Shared::new("BlazePose", network)))
    }

    /// People in the next image of a camera; `time` is its time stamp [s].
    fn estimate(
        &self,
        py: Python<'_>,
        image: &Bound<'_, PyAny>,
        time: f64,
    ) -> Result<Vec<Landmarks>> {
        if !time.is_finite() {
            return Err(Failure::value(format!("time is {time}; it must be a finite number [s]")));
        }
        let image = self::image("image", image)?;
        let mut network = self.0.lock()?;
        let network = &mut *network;
        let people = py.detach(|| network.estimate(time, image.view()))?;
        Ok(people.into_iter().map(Landmarks).collect())
    }

    /// Forgets all people, to begin with other images.
    fn forget(&self) -> Result<()> {
        self.0.lock()?.forget();
        Ok(())
    }
}

/// A person as BlazePose sees them: thirty-three points.
///
/// They are the nose; the inner corner, middle and outer corner of the left eye, then of the right one; the ears, the corners
/// of the mouth, shoulders, elbows, wrists, little fingers, index fingers, thumbs, hips, knees, ankles, heels and tips of the
/// feet. Left is before right, as the person has them.
#[pyclass(frozen, module = "ahqp.vision")]
pub(crate) struct Landmarks(vision_models::Landmarks);

impl Landmarks {
    fn each<'py>(
        &self,
        py: Python<'py>,
        number: fn(&Landmark) -> f64,
    ) -> Bound<'py, PyArray1<f64>> {
        to_vector(py, &self.0.points.each_ref().map(number))
    }
}

#[pymethods]
impl Landmarks {
    /// Positions in the image [pixels], (33, 2); 0, 0 is the centre of the pixel at the top left.
    #[getter]
    fn positions<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        points::<2>(py, self.0.points.map(|point| Some(point.position.coords.into())))
    }

    /// Depths behind the middle of the hips, (33,), in pixels at the distance of the hips.
    #[getter]
    fn depths<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.each(py, |point| point.depth)
    }

    /// Positions from the middle of the hips [m], (33, 3): x to the right in the image, y downwards, z away from the camera.
    #[getter]
    fn metric<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        points::<3>(py, self.0.points.map(|point| Some(point.metric.coords.into())))
    }

    /// Probabilities that the points are in the image and not hidden, (33,).
    #[getter]
    fn visibility<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.each(py, |point| point.visibility.value())
    }

    /// Probabilities that the points are in the image, (33,).
    #[getter]
    fn presence<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.each(py, |point| point.presence.value())
    }

    /// Probability that there is a person.
    #[getter]
    fn score(&self) -> f64 {
        self.0.score.value()
    }

    /// The person's joints, in the image and in metres.
    #[getter]
    fn body(&self) -> ImageBody {
        ImageBody(self.0.body())
    }

    fn __repr__(&self) -> String {
        format!("<ahqp.vision.Landmarks: score {:.2}>", self.score())
    }
}

/// The simple baseline, a ResNet-50 that finds the seventeen joints of COCO of the person in a box.
///
/// `SimpleBaseline(weights, *, mirrored=False, threads=1)`
///
/// Parameters
/// ----------
/// weights : path or dict of str to array_like
///     A file of Microsoft's or mmpose's form, or a state dict.
/// mirrored : bool
///     Take the mean with a second pass over the mirrored image, as published accuracies do.
/// threads : int
///     Threads that share the work.
#[pyclass(frozen, module = "ahqp.vision")]
pub(crate) struct SimpleBaseline(Shared<vision_models::SimpleBaseline>);

#[pymethods]
impl SimpleBaseline {
    #[new]
    #[pyo3(signature = (weights, *, mirrored=false, threads=1))]
    fn new(
        py: Python<'_>,
        weights: &Bound<'_, PyAny>,
        mirrored: bool,
        threads: usize,
    ) -> Result<Self> {
        let weights = Weights::read(weights)?;
        let passes = if mirrored { Passes::Mirrored } else { Passes::One };
        let network =
            py.detach(|| vision_models::SimpleBaseline::load(weights, passes, options(threads)))?;
        Ok(Self(Shared::new("SimpleBaseline", network)))
    }

    /// The person in a box of the image: left, top, width and height [pixels].
    fn estimate(
        &self,
        py: Python<'_>,
        image: &Bound<'_, PyAny>,
        r#box: &Bound<'_, PyAny>,
    ) -> Result<ImageBody> {
        let image = self::image("image", image)?;
        let [left, top, width, height] = numbers("box", r#box)?;
        let person = PersonBox { left, top, width, height };
        let mut network = self.0.lock()?;
        let network = &mut *network;
        let image = py.detach(|| network.estimate(image.view(), &person))?;
        Ok(ImageBody(ObservedBody { image, metric: None }))
    }
}

/// The box around the nearest person of a depth image: left, top, width, height [pixels]. It is that of an object as upright
/// and large as a person; None if there is none.
///
/// `depth`, (height, width), is uint16 in units of `unit` [m], or floats [m]; 0 or NaN where nothing was measured.
#[pyfunction]
#[pyo3(signature = (camera, depth, *, unit=0.001))]
pub(crate) fn nearest_person(
    py: Python<'_>,
    camera: &Camera,
    depth: &Bound<'_, PyAny>,
    unit: f64,
) -> Result<Option<(f64, f64, f64, f64)>> {
    let (camera, depth) = (camera.placed()?, self::depth(depth, unit)?);
    let (size, found) = (camera.intrinsics().size(), depth.size());
    if size != found {
        let ([width, height], [other_width, other_height]) = (size, found);
        return Err(Failure::value(format!(
            "depth has {other_width} × {other_height} pixels; the camera has {width} × {height}"
        )));
    }
    let found = py.detach(|| PersonBox::nearest(&camera, &depth));
    Ok(found.map(|PersonBox { left, top, width, height }| (left, top, width, height)))
}

/// OpenPose's body network, which finds all people in an image. Its weights are for non-commercial use.
///
/// `OpenPose(weights, *, height=368, width=496, threads=1)`
///
/// Parameters
/// ----------
/// weights : path or dict of str to array_like
///     `body_pose_model.pth` of its PyTorch ports, or a state dict.
/// height, width : int
///     The size to which images are scaled [pixels].
/// threads : int
///     Threads that share the work.
#[pyclass(frozen, module = "ahqp.vision")]
pub(crate) struct OpenPose(Shared<vision_models::OpenPose>);

#[pymethods]
impl OpenPose {
    #[new]
    #[pyo3(signature = (weights, *, height=368, width=496, threads=1))]
    fn new(
        py: Python<'_>,
        weights: &Bound<'_, PyAny>,
        height: usize,
        width: usize,
        threads: usize,
    ) -> Result<Self> {
        let weights = Weights::read(weights)?;
        let size = [height, width];
        let network =
            py.detach(|| vision_models::OpenPose::load(weights, size, options(threads)))?;
        Ok(Self(Shared::new("OpenPose", network)))
    }

    /// People in an image, the surest first.
    fn estimate(&self, py: Python<'_>, image: &Bound<'_, PyAny>) -> Result<Vec<ImageBody>> {
        let image = self::image("image", image)?;
        let mut network = self.0.lock()?;
        let network = &mut *network;
        let settings = GroupingSettings::default();
        let people = py.detach(|| network.estimate(image.view(), &settings))?;
        let body = |image| ImageBody(ObservedBody { image, metric: None });
        Ok(people.into_iter().map(body).collect())
    }
}
