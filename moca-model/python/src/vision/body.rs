//! People in images.

use nalgebra::{Point2, Point3};
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use vision_models::{Body25, Confidence, ImageKeypoint, JointLayout, ObservedBody};

use super::arrays::{each, optional, points, rows};
use crate::ergo::keywords::word;
use crate::failure::{Failure, Result};

/// A person in one image: the joints that were seen [pixels], and metric joints if a network gives them.
///
/// `ImageBody(joints, confidences=1.0, *, metric=None, layout="BODY_25")`
///
/// Parameters
/// ----------
/// joints : array_like, shape (n, 2)
///     x to the right and y downwards [pixels]; 0, 0 is the centre of the pixel at the top left. NaN stands for joints that
///     were not seen.
/// confidences : float or array_like, shape (n,)
///     From 0 to 1.
/// metric : array_like, shape (n, 3), optional
///     Joints from the middle of the hips [m]: x to the right in the image, y downwards, z away from the camera.
/// layout : str
///     The order of the joints, a key of `ImageBody.LAYOUTS`, which has the number n of each. A layout without neck or mid hip
///     has the middles of shoulders and hips there.
///
/// >>> import numpy as np
/// >>> from ahqp.vision import ImageBody
/// >>> joints = np.full((17, 2), np.nan)
/// >>> joints[[5, 6]] = [[120, 80], [80, 84]]
/// >>> body = ImageBody(joints, layout="COCO-17")
/// >>> ", ".join(body.seen), body.joints[1].tolist()
/// ('neck, right shoulder, left shoulder', [100.0, 82.0])
#[pyclass(frozen, module = "ahqp.vision")]
pub(crate) struct ImageBody(pub(super) ObservedBody);

#[pymethods]
impl ImageBody {
    #[new]
    #[pyo3(signature = (joints, confidences=None, *, metric=None, layout="BODY_25"))]
    fn new(
        joints: &Bound<'_, PyAny>,
        confidences: Option<&Bound<'_, PyAny>>,
        metric: Option<&Bound<'_, PyAny>>,
        layout: &str,
    ) -> Result<Self> {
        let layouts: Vec<_> = JointLayout::all().map(|layout| (layout.name(), layout)).collect();
        let layout = word("layout", layout, &layouts)?;
        let places = rows::<2>("joints", joints)?;
        check_count("joints", places.len(), layout)?;
        let confidences = each("confidences", confidences, layout.count(), 1.0)?;
        let mut keypoints = Vec::with_capacity(places.len());
        for (place, confidence) in places.into_iter().zip(confidences) {
            keypoints.push(keypoint(place, confidence)?);
        }
        let mut body = ObservedBody { image: layout.body(&keypoints), metric: None };
        if let Some(metric) = metric {
            let places = rows::<3>("metric", metric)?;
            check_count("metric", places.len(), layout)?;
            let point = |place: [f64; 3]| {
                place.iter().all(|value| value.is_finite()).then(|| Point3::from(place))
            };
            let points: Vec<_> = places.into_iter().map(point).collect();
            body.metric = Some(layout.metric(&points));
        }
        Ok(Self(body))
    }

    /// The orders of joints that are known, with their numbers of joints.
    #[classattr]
    #[pyo3(name = "LAYOUTS")]
    fn layouts() -> std::collections::BTreeMap<&'static str, usize> {
        JointLayout::all().map(|layout| (layout.name(), layout.count())).collect()
    }

    /// The names of the joints that were seen.
    #[getter]
    fn seen(&self) -> Vec<&'static str> {
        self.0.image.iter().map(|(joint, _)| joint.name()).collect()
    }

    /// Positions [pixels], (25, 2), in the order of `ahqp.collaboration.Body.JOINTS`; NaN for joints that were not seen.
    #[getter]
    fn joints<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        let place = |joint: &Option<ImageKeypoint>| joint.map(|seen| seen.position.coords.into());
        points::<2>(py, self.0.image.keypoints().iter().map(place))
    }

    /// Confidences of the joints, (25,), NaN for joints that were not seen.
    #[getter]
    fn confidences<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        let confidence =
            |joint: &Option<ImageKeypoint>| joint.map(|joint| joint.confidence.value());
        optional(py, self.0.image.keypoints().iter().map(confidence))
    }

    /// Joints from the middle of the hips [m], (25, 3); None for a network without them.
    #[getter]
    fn metric<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray2<f64>>> {
        let metric = self.0.metric.as_ref()?;
        let place = |joint| metric.get(joint).map(|point: Point3<f64>| point.coords.into());
        Some(points::<3>(py, Body25::ALL.map(place)))
    }

    fn __repr__(&self) -> String {
        format!("<ahqp.vision.ImageBody: {} joints>", self.0.image.iter().count())
    }
}

fn check_count(name: &str, found: usize, layout: JointLayout) -> Result<()> {
    let (wanted, layout) = (layout.count(), layout.name());
    if found == wanted {
        return Ok(());
    }
    Err(Failure::value(format!("{name} has {found} rows; {layout} has {wanted} joints")))
}

/// Returns a joint, None if it was not seen.
fn keypoint([x, y]: [f64; 2], confidence: f64) -> Result<Option<ImageKeypoint>> {
    if x.is_nan() || y.is_nan() {
        return Ok(None);
    }
    if !(x.is_finite() && y.is_finite()) {
        return Err(Failure::value(format!("a joint is at {x}, {y}; it must be finite, or NaN")));
    }
    let confidence = Confidence::new(confidence)?;
    Ok(Some(ImageKeypoint { position: Point2::new(x, y), confidence }))
}
