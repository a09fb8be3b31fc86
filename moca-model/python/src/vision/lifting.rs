//! One camera: joints in its image become a body in the world.

use pyo3::prelude::*;
use vision_models::{LiftingSettings, MonocularSettings, PixelNoise};

use super::arrays::depth;
use super::body::ImageBody;
use super::camera::Camera;
use crate::collaboration::body::Body;
use crate::failure::{Failure, Result};
use crate::shared::Shared;

/// Lifts joints in an image to the world by the depth image that is aligned to it.
///
/// `Lifter(camera, *, least_confidence=0.4, pixel_sigma=3.0, window=0.03, least_share=0.3, edge=0.08, range=(0.3, 8.0),
/// reach=0.9, trunk_reach=0.5, skin_sigma=0.015)`
///
/// Parameters
/// ----------
/// camera : Camera
///     With a pose and without distortion.
/// least_confidence : float
///     Keypoints with less confidence are left out.
/// pixel_sigma : float
///     Standard deviation of a keypoint on each axis [pixels].
/// window : float
///     Half the side of the square in which depths are read [m].
/// least_share : float
///     Smallest share of its pixels that must have a depth.
/// edge : float
///     Depths that differ by more belong to different surfaces [m].
/// range : (float, float)
///     Depths outside belong to no person [m].
/// reach, trunk_reach : float
///     Largest distance of a joint before or behind the trunk, and that of a joint of the trunk [m].
/// skin_sigma : float
///     Standard deviation of the depth of joints below the skin [m].
///
/// A joint is at the median depth of the nearest surface around its pixel, and behind the skin. Its covariance has the errors
/// of keypoint, depth and skin. Joints without a surface are left out.
///
/// >>> import numpy as np
/// >>> from ahqp.vision import Camera, ImageBody, Lifter
/// >>> matrix = [[60.0, 0.0, 31.5], [0.0, 60.0, 23.5], [0.0, 0.0, 1.0]]
/// >>> camera = Camera.looking_at(64, 48, matrix, [0.0, 0.0, 1.5], [1.0, 0.0, 1.5])
/// >>> joints = np.full((25, 2), np.nan)
/// >>> joints[0] = 31.5, 23.5
/// >>> body = Lifter(camera).lift(ImageBody(joints), np.full((48, 64), 2000, np.uint16))
/// >>> body.joints[0].round(6).tolist()
/// [2.0, 0.0, 1.5]
#[pyclass(frozen, module = "ahqp.vision")]
pub(crate) struct Lifter(vision_models::Lifter);

#[pymethods]
impl Lifter {
    #[new]
    #[pyo3(signature = (camera, *, least_confidence=0.4, pixel_sigma=3.0, window=0.03, least_share=0.3, edge=0.08,
        range=(0.3, 8.0), reach=0.9, trunk_reach=0.5, skin_sigma=0.015))]
    #[allow(clippy::too_many_arguments)] // keywords of Python
    fn new(
        camera: &Camera,
        least_confidence: f64,
        pixel_sigma: f64,
        window: f64,
        least_share: f64,
        edge: f64,
        range: (f64, f64),
        reach: f64,
        trunk_reach: f64,
        skin_sigma: f64,
    ) -> Result<Self> {
        let settings = LiftingSettings {
            least_confidence,
            pixel_sigma,
            window,
            least_share,
            edge,
            range: range.into(),
            reach,
            trunk_reach,
            skin_sigma,
            ..LiftingSettings::default()
        };
        Ok(Self(vision_models::Lifter::new(camera.placed()?, settings)?))
    }

    /// Lifts a person of the image.
    ///
    /// Parameters
    /// ----------
    /// body : ImageBody
    /// depth : array_like, shape (height, width)
    ///     uint16 in units of `unit`, or floats in metres; 0 or NaN where nothing was measured. It is aligned to the image.
    /// unit : float
    ///     Of depths in integers [m].
    /// heading : float or callable, optional
    ///     The person's yaw in the world [rad], on which the depth below the skin depends. A callable gets the body as lifted
    ///     without, and returns the yaw or None: `lambda body: people.heading_near(body, time)`. It is that of shoulders and
    ///     hips if not given.
    ///
    /// Returns
    /// -------
    /// ahqp.collaboration.Body
    ///     With covariances.
    #[pyo3(signature = (body, depth, *, unit=0.001, heading=None))]
    fn lift(
        &self,
        body: &ImageBody,
        depth: &Bound<'_, PyAny>,
        unit: f64,
        heading: Option<&Bound<'_, PyAny>>,
    ) -> Result<Body> {
        let depth = self::depth(depth, unit)?;
        let mut failed = Ok(());
        let facing = |before: &vision_models::Body| {
            heading.and_then(|heading| {
                let found = heading_of(heading, before);
                found.unwrap_or_else(|failure| {
                    failed = Err(failure);
                    None
                })
            })
        };
        let lifted = self.0.lift_facing(&body.0.image, &depth, facing)?;
        failed.map(|()| Body(lifted))
    }
}

/// Returns the heading that the caller gives, or that they compute of a body.
fn heading_of(heading: &Bound<'_, PyAny>, body: &vision_models::Body) -> Result<Option<f64>> {
    let heading =
        if heading.is_callable() { &heading.call1((Body(body.clone()),))? } else { heading };
    let heading = heading.extract::<Option<f64>>().map_err(|_| {
        Failure::type_of_argument(
            "heading must be an angle [rad], None, or a callable that gives one",
        )
    })?;
    match heading {
        Some(angle) if !angle.is_finite() => {
            Err(Failure::value(format!("heading is {angle}; it must be a finite number [rad]")))
        }
        other => Ok(other),
    }
}

/// Places a person whom one camera without depth sees, by metric joints and by the floor.
///
/// `MonocularLifter(camera, *, stature=None, pixel_noise=(1.0, 0.016), depth_sigma=0.1, scale_sigma=0.06, height_sigma=0.05,
/// tilt_sigma=0.0349)`
///
/// Parameters
/// ----------
/// camera : Camera
///     With a pose above the floor, z = 0 of the world. It may have a distortion.
/// stature : float, optional
///     Of the person, if it is known [m].
/// pixel_noise : (float, float)
///     Standard deviation of a keypoint: at size zero [pixels], and its growth with the diagonal of the body in the image.
/// depth_sigma : float
///     Standard deviation of a joint's depth beside the hips' [m].
/// scale_sigma : float
///     Relative standard deviation of a network's lengths, for people whose stature is not known.
/// height_sigma, tilt_sigma : float
///     Standard deviations of the camera's height [m] and tilt [rad].
///
/// One lifter follows one person: lengths are means over their images.
#[pyclass(frozen, module = "ahqp.vision")]
pub(crate) struct MonocularLifter(Shared<vision_models::MonocularLifter>);

#[pymethods]
impl MonocularLifter {
    #[new]
    #[pyo3(signature = (camera, *, stature=None, pixel_noise=(1.0, 0.016), depth_sigma=0.1, scale_sigma=0.06,
        height_sigma=0.05, tilt_sigma=0.0349))]
    fn new(
        camera: &Camera,
        stature: Option<f64>,
        pixel_noise: (f64, f64),
        depth_sigma: f64,
        scale_sigma: f64,
        height_sigma: f64,
        tilt_sigma: f64,
    ) -> Result<Self> {
        let (constant, share) = pixel_noise;
        let noise = PixelNoise { constant, share };
        let settings = MonocularSettings {
            noise,
            depth_sigma,
            stature,
            scale_sigma,
            height_sigma,
            tilt_sigma,
        };
        let lifter = vision_models::MonocularLifter::new(camera.calibrated.clone(), settings)?;
        Ok(Self(Shared::new("MonocularLifter", lifter)))
    }

    /// The person in the world, with covariances; None if too few joints are in the image. The body needs metric joints, as
    /// BlazePose gives them.
    fn lift(&self, body: &ImageBody) -> Result<Option<Body>> {
        if body.0.metric.is_none() {
            let text = "the body has no metric joints; take one of BlazePose, or give metric";
            return Err(Failure::value(text));
        }
        Ok(self.0.lock()?.lift(&body.0).map(|placed| Body(placed.in_world())))
    }

    /// The person's stature by the legs of all images, and its standard deviation [m]; None before legs were seen.
    #[getter]
    fn stature(&self) -> Result<Option<(f64, f64)>> {
        Ok(self.0.lock()?.stature().map(Into::into))
    }
}
