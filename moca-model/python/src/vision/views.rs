//! Several cameras: joints in their images become bodies in the world.

use pyo3::prelude::*;
use vision_models::{PixelNoise, TriangulationSettings};

use super::body::ImageBody;
use super::camera::Camera;
use crate::collaboration::body::Body;
use crate::failure::{Failure, Result};

/// Finds joints in the world that calibrated cameras see at the same time. Two views that agree are enough.
///
/// `Triangulator(cameras, *, pixel_noise=(1.0, 0.016), outlier=3.0, least_confidence=0.2, largest_sigma=0.15)`
///
/// Parameters
/// ----------
/// cameras : sequence of Camera
///     Two to sixteen, with poses.
/// pixel_noise : (float, float)
///     Standard deviation of a keypoint: at size zero [pixels], and its growth with the diagonal of the body in the image.
/// outlier : float
///     A view whose joint is farther off is left out [standard deviations].
/// least_confidence : float
///     Keypoints with less confidence are left out.
/// largest_sigma : float
///     Joints with a larger standard deviation along any axis are left out [m].
///
/// >>> import numpy as np
/// >>> from ahqp.vision import Camera, ImageBody, Triangulator
/// >>> matrix = [[600.0, 0.0, 319.5], [0.0, 600.0, 239.5], [0.0, 0.0, 1.0]]
/// >>> eyes = [[-3.0, 0.0, 1.5], [0.0, -3.0, 1.5]]
/// >>> cameras = [Camera.looking_at(640, 480, matrix, eye, [0.0, 0.0, 1.5]) for eye in eyes]
/// >>> joints = np.full((25, 3), np.nan)
/// >>> joints[0] = 0.1, 0.2, 1.6
/// >>> views = [ImageBody(camera.project(joints)) for camera in cameras]
/// >>> Triangulator(cameras).body(views).joints[0].round(6).tolist()
/// [0.1, 0.2, 1.6]
#[pyclass(frozen, module = "ahqp.vision")]
pub(crate) struct Triangulator(vision_models::Triangulator);

#[pymethods]
impl Triangulator {
    #[new]
    #[pyo3(signature = (cameras, *, pixel_noise=(1.0, 0.016), outlier=3.0, least_confidence=0.2, largest_sigma=0.15))]
    fn new(
        cameras: Vec<PyRef<'_, Camera>>,
        pixel_noise: (f64, f64),
        outlier: f64,
        least_confidence: f64,
        largest_sigma: f64,
    ) -> Result<Self> {
        let cameras = cameras.iter().map(|camera| camera.calibrated.clone()).collect();
        let (constant, share) = pixel_noise;
        let noise = PixelNoise { constant, share };
        let settings = TriangulationSettings { noise, outlier, least_confidence, largest_sigma };
        Ok(Self(vision_models::Triangulator::new(cameras, settings)?))
    }

    /// The joints of one person. `views` has what each camera sees, an `ImageBody` or None, in the order of the cameras.
    fn body(&self, py: Python<'_>, views: Vec<Option<PyRef<'_, ImageBody>>>) -> Result<Body> {
        self.check(views.len())?;
        let images = views.iter().map(|view| view.as_ref().map(|view| view.0.image.clone()));
        let images: Vec<_> = images.collect();
        let views: Vec<_> = images.iter().map(Option::as_ref).collect();
        Ok(Body(py.detach(|| self.0.body(&views))))
    }

    /// Everybody whom at least two cameras see. `views` has the people in each camera's image, in the order of the cameras.
    fn people(&self, py: Python<'_>, views: Vec<Vec<PyRef<'_, ImageBody>>>) -> Result<Vec<Body>> {
        self.check(views.len())?;
        let images = |people: &Vec<PyRef<'_, ImageBody>>| {
            people.iter().map(|person| person.0.image.clone()).collect()
        };
        let views: Vec<Vec<_>> = views.iter().map(images).collect();
        Ok(py.detach(|| self.0.people(&views)).into_iter().map(Body).collect())
    }
}

impl Triangulator {
    fn check(&self, views: usize) -> Result<()> {
        let cameras = self.0.cameras().len();
        if views == cameras {
            return Ok(());
        }
        Err(Failure::value(format!("views has {views} entries; there are {cameras} cameras")))
    }
}
