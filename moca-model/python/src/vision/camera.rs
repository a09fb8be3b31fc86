//! Cameras, and where they stand.

use std::path::PathBuf;

use nalgebra::{Isometry3, Matrix3, Point2, Point3, Vector3};
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use vision_models::{CalibratedCamera, DepthNoise, Distortion, Intrinsics};

use super::arrays::{points, rows};
use crate::arrays::{numbers, pose, pose_to_array, to_array, to_vector, vector};
use crate::ergo::keywords::word;
use crate::failure::{Failure, Result, check_file};

/// A camera: its lens, and where it stands in the world if that is known.
///
/// `Camera(width, height, matrix, pose=None, *, distortion=None, model="radial", depth_noise=None, name="")`
///
/// Parameters
/// ----------
/// width, height : int
///     The size of its images [pixels].
/// matrix : array_like, shape (3, 3)
///     fx, 0, cx; 0, fy, cy; 0, 0, 1 [pixels]. The centre of the pixel at the top left is 0, 0.
/// pose : array_like, shape (4, 4), optional
///     Of its optical frame in the world: x to the right, y down, z forwards. The floor of the world is z = 0.
/// distortion : array_like, optional
///     Coefficients as OpenCV has them: 4, 5 or 8 of "radial", 4 of "fisheye". Rectified images have none.
/// model : str
///     "radial" (k1, k2, p1, p2, k3, k4, k5, k6) or "fisheye" (k1 to k4).
/// depth_noise : (float, float), optional
///     Standard deviation of depths: at distance zero [m], and its growth with the square of the distance [1/m]. That of a
///     RealSense D435i if not given.
/// name : str
///
/// >>> import numpy as np
/// >>> from ahqp.vision import Camera
/// >>> matrix = [[615.0, 0.0, 319.5], [0.0, 615.0, 239.5], [0.0, 0.0, 1.0]]
/// >>> camera = Camera.looking_at(640, 480, matrix, [0.0, 0.0, 1.5], [3.0, 0.0, 1.5])
/// >>> camera.project([[3.0, 0.0, 1.5], [-1.0, 0.0, 1.5]]).round(9).tolist()
/// [[319.5, 239.5], [nan, nan]]
#[pyclass(frozen, module = "ahqp.vision")]
pub(crate) struct Camera {
    pub(super) calibrated: CalibratedCamera,
    noise: DepthNoise,
}

impl Camera {
    /// Returns the camera in the world, for images without distortion.
    pub(super) fn placed(&self) -> Result<vision_models::Camera> {
        if self.calibrated.distortion != Distortion::None {
            let text = "the camera has a distortion; give rectified images, and a camera without";
            return Err(Failure::value(text));
        }
        let pose = self.known_pose()?;
        Ok(vision_models::Camera::new(self.calibrated.intrinsics, pose, self.noise)?)
    }

    fn known_pose(&self) -> Result<Isometry3<f64>> {
        let unknown = || Failure::value("the camera has no pose; camera.at(pose) gives it one");
        self.calibrated.world_from_camera.ok_or_else(unknown)
    }
}

#[pymethods]
impl Camera {
    #[new]
    #[pyo3(signature = (width, height, matrix, pose=None, *, distortion=None, model="radial", depth_noise=None, name=String::new()))]
    #[allow(clippy::too_many_arguments)] // keywords of Python
    fn new(
        width: usize,
        height: usize,
        matrix: &Bound<'_, PyAny>,
        pose: Option<&Bound<'_, PyAny>>,
        distortion: Option<&Bound<'_, PyAny>>,
        model: &str,
        depth_noise: Option<(f64, f64)>,
        name: String,
    ) -> Result<Self> {
        let noise = depth_noise
            .map_or(DepthNoise::D435I, |(constant, quadratic)| DepthNoise { constant, quadratic });
        let calibrated = CalibratedCamera {
            name,
            intrinsics: read_intrinsics([width, height], matrix)?,
            distortion: read_distortion(distortion, model)?,
            world_from_camera: pose.map(read_pose).transpose()?,
        };
        Ok(Self { calibrated, noise })
    }

    /// A camera at the point `eye`, (3,), that looks at the point `target`, (3,), of the world [m], with the top of its image
    /// upwards. It has no distortion.
    #[staticmethod]
    #[pyo3(signature = (width, height, matrix, eye, target, *, depth_noise=None, name=String::new()))]
    fn looking_at(
        width: usize,
        height: usize,
        matrix: &Bound<'_, PyAny>,
        eye: &Bound<'_, PyAny>,
        target: &Bound<'_, PyAny>,
        depth_noise: Option<(f64, f64)>,
        name: String,
    ) -> Result<Self> {
        let camera = Self::new(width, height, matrix, None, None, "radial", depth_noise, name)?;
        let (eye, target) = (numbers::<3>("eye", eye)?, numbers::<3>("target", target)?);
        let intrinsics = camera.calibrated.intrinsics;
        let placed =
            vision_models::Camera::looking_at(intrinsics, eye.into(), target.into(), camera.noise)?;
        Ok(camera.with_pose(Some(*placed.world_from_camera())))
    }

    /// Reads the cameras of a calibration: the YAML of a camera by OpenCV or ROS, or a `.qca.txt` of Qualisys.
    #[staticmethod]
    fn read(py: Python<'_>, path: PathBuf) -> Result<Vec<Self>> {
        check_file(&path)?;
        let cameras = py.detach(|| CalibratedCamera::read(&path))?;
        let camera = |calibrated| Self { calibrated, noise: DepthNoise::D435I };
        Ok(cameras.into_iter().map(camera).collect())
    }

    /// The same camera at another pose, (4, 4).
    fn at(&self, pose: &Bound<'_, PyAny>) -> Result<Self> {
        Ok(self.with_pose(Some(read_pose(pose)?)))
    }

    /// Pixels at which points of the world are seen: (n, 3) [m] gives (n, 2). They may lie outside the image. NaN stands for
    /// points that are not in front of the camera.
    fn project<'py>(
        &self,
        py: Python<'py>,
        points: &Bound<'py, PyAny>,
    ) -> Result<Bound<'py, PyArray2<f64>>> {
        self.known_pose()?;
        let seen = rows::<3>("points", points)?.into_iter().map(|point| {
            self.calibrated.project(&Point3::from(point)).map(|pixel| pixel.coords.into())
        });
        Ok(self::points::<2>(py, seen))
    }

    /// Pixels at which a pinhole sees what the lens shows at pixels, (n, 2). NaN stands for pixels where it shows nothing.
    fn undistort<'py>(
        &self,
        py: Python<'py>,
        pixels: &Bound<'py, PyAny>,
    ) -> Result<Bound<'py, PyArray2<f64>>> {
        let seen = rows::<2>("pixels", pixels)?.into_iter().map(|pixel| {
            self.calibrated.pinhole(&Point2::from(pixel)).map(|pixel| pixel.coords.into())
        });
        Ok(self::points::<2>(py, seen))
    }

    /// Checks that `gravity`, (3,), as the camera's accelerometer measures it in the optical frame, points down by the pose. It
    /// is along +y for a level camera, in any unit.
    ///
    /// Raises `Error` if they differ by more than 15°.
    fn check_gravity(&self, gravity: &Bound<'_, PyAny>) -> Result<()> {
        Ok(self.placed()?.check_gravity(&Vector3::from(numbers::<3>("gravity", gravity)?))?)
    }

    /// Width and height of the images [pixels].
    #[getter]
    fn size(&self) -> (usize, usize) {
        self.calibrated.intrinsics.size().into()
    }

    /// fx, 0, cx; 0, fy, cy; 0, 0, 1 [pixels], (3, 3).
    #[getter]
    fn matrix<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        let ([fx, fy], [cx, cy]) =
            (self.calibrated.intrinsics.focal(), self.calibrated.intrinsics.centre());
        to_array(py, &Matrix3::new(fx, 0.0, cx, 0.0, fy, cy, 0.0, 0.0, 1.0))
    }

    /// Pose of the optical frame in the world, (4, 4), None if it is not known.
    #[getter]
    fn pose<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray2<f64>>> {
        self.calibrated.world_from_camera.map(|pose| pose_to_array(py, &pose))
    }

    /// Coefficients of the distortion, (8,) or (4,), None if there is none.
    #[getter]
    fn distortion<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<f64>>> {
        match &self.calibrated.distortion {
            Distortion::None => None,
            Distortion::Radial(all) => Some(to_vector(py, all)),
            Distortion::Fisheye(all) => Some(to_vector(py, all)),
        }
    }

    /// The name that its calibration gives it.
    #[getter]
    fn name(&self) -> String {
        self.calibrated.name.clone()
    }

    fn __repr__(&self) -> String {
        let [width, height] = self.calibrated.intrinsics.size();
        let place = if self.calibrated.world_from_camera.is_some() { "placed" } else { "no pose" };
        format!("<ahqp.vision.Camera: {width} × {height}, {place}>")
    }
}

impl Camera {
    fn with_pose(&self, world_from_camera: Option<Isometry3<f64>>) -> Self {
        let calibrated = CalibratedCamera { world_from_camera, ..self.calibrated.clone() };
        Self { calibrated, noise: self.noise }
    }
}

fn read_pose(value: &Bound<'_, PyAny>) -> Result<Isometry3<f64>> {
    let pose = pose("pose", value)?;
    if pose.translation.vector.iter().all(|value| value.is_finite()) {
        return Ok(pose);
    }
    Err(Failure::value("pose must be finite"))
}

fn read_intrinsics(size: [usize; 2], matrix: &Bound<'_, PyAny>) -> Result<Intrinsics> {
    let rows = rows::<3>("matrix", matrix)?;
    let [[fx, skew, cx], [zero, fy, cy], [0.0, 0.0, 1.0]] = rows[..] else {
        return Err(Failure::value("matrix must be fx, 0, cx; 0, fy, cy; 0, 0, 1"));
    };
    if skew != 0.0 || zero != 0.0 {
        return Err(Failure::value("matrix has a skew; it must be fx, 0, cx; 0, fy, cy; 0, 0, 1"));
    }
    Ok(Intrinsics::new(size, [fx, fy], [cx, cy])?)
}

fn read_distortion(value: Option<&Bound<'_, PyAny>>, model: &str) -> Result<Distortion> {
    let is_fisheye = word("model", model, &[("radial", false), ("fisheye", true)])?;
    let Some(value) = value else { return Ok(Distortion::None) };
    let given = vector("distortion", value)?.as_array().to_vec();
    if given.iter().any(|number| !number.is_finite()) {
        return Err(Failure::value("distortion must be finite"));
    }
    if given.iter().all(|number| *number == 0.0) {
        return Ok(Distortion::None);
    }
    match (is_fisheye, given.len()) {
        (true, 4) => Ok(Distortion::Fisheye(std::array::from_fn(|index| given[index]))),
        (false, 4 | 5 | 8) => {
            let number = |index| given.get(index).copied().unwrap_or(0.0);
            Ok(Distortion::Radial(std::array::from_fn(number)))
        }
        (_, count) => Err(Failure::value(format!(
            "distortion has {count} entries; \"radial\" has 4, 5 or 8, \"fisheye\" has 4"
        ))),
    }
}

/// Place of a camera, found from points that it sees where a robot holds its tool.
///
/// `CameraPlacement(seen, world)`
///
/// Parameters
/// ----------
/// seen : array_like, shape (n, 3)
///     The points in the optical frame [m]. There are three at least, not on a line.
/// world : array_like, shape (n, 3)
///     The same points in the world [m].
///
/// The pose has the least sum of squared residuals (Umeyama 1991).
///
/// >>> from ahqp.vision import CameraPlacement
/// >>> placement = CameraPlacement([[0, 0, 1], [1, 0, 1], [0, 1, 2]], [[1, 0, 0], [1, -1, 0], [2, 0, -1]])
/// >>> placement.pose.shape, round(placement.deviation, 9)
/// ((4, 4), 0.0)
#[pyclass(frozen, module = "ahqp.vision")]
pub(crate) struct CameraPlacement(vision_models::CameraPlacement);

#[pymethods]
impl CameraPlacement {
    #[new]
    fn new(seen: &Bound<'_, PyAny>, world: &Bound<'_, PyAny>) -> Result<Self> {
        let (seen, world) = (rows::<3>("seen", seen)?, rows::<3>("world", world)?);
        if seen.len() != world.len() {
            let (one, other) = (seen.len(), world.len());
            return Err(Failure::value(format!("seen has {one} points, and world has {other}")));
        }
        let pairs = seen.into_iter().zip(world).map(|(seen, world)| [seen.into(), world.into()]);
        Ok(Self(vision_models::CameraPlacement::fit(&pairs.collect::<Vec<_>>())?))
    }

    /// Pose of the optical frame in the world, (4, 4), as `Camera.at` takes it.
    #[getter]
    fn pose<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        pose_to_array(py, &self.0.world_from_camera)
    }

    /// Distance of each point, moved to the world, from its place there [m], (n,).
    #[getter]
    fn residuals<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        to_vector(py, &self.0.residuals)
    }

    /// Root mean square of the residuals [m].
    #[getter]
    fn deviation(&self) -> f64 {
        self.0.deviation()
    }
}
