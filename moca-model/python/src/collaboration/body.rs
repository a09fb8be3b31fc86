//! Bodies of people.

use ergo_map::{HandTarget, JointAngles, PosturePredictor, Skeleton};
use nalgebra::{Isometry3, Matrix3, Point3, Translation3, UnitQuaternion, Vector3};
use numpy::ndarray::Array3;
use numpy::{PyArray1, PyArray2, PyArray3};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use vision_models::{Body25, Confidence, Keypoint, PersonId};

use crate::arrays::{Matrix, numbers, to_array, to_vector, vector_of};
use crate::ergo::keywords;
use crate::ergo::person::Person;
use crate::failure::{Failure, Result};

/// Half the distance between the hips, as a share of stature.
const HIP: f64 = 0.055;
/// Half the distance between the eyes, as a share of stature.
const EYE: f64 = 0.018;

/// A person in one camera frame: the joints that were seen, in the world [m].
///
/// `Body(joints, confidences=1.0, *, covariances=None, id=None)`
///
/// Parameters
/// ----------
/// joints : array_like, shape (25, 3), or dict of str to array_like, (3,)
///     Positions in the order of `Body.JOINTS`, or by name. NaN stands for joints that were not seen.
/// confidences : float or array_like, shape (25,)
///     From 0 to 1.
/// covariances : array_like, shape (25, 3, 3), optional
///     Covariances of the positions [m²], NaN where they are not known.
/// id : int, optional
///     The person's number, which stays the same from frame to frame, if the camera tracks people.
///
/// >>> from ahqp.collaboration import Body
/// >>> body = Body({"neck": [1.5, 0.0, 1.45], "mid hip": [1.5, 0.0, 0.95]}, 0.9)
/// >>> len(body.seen), body.joints.shape
/// (2, (25, 3))
#[pyclass(frozen, module = "ahqp.collaboration")]
pub(crate) struct Body(pub(crate) vision_models::Body);

#[pymethods]
impl Body {
    #[new]
    #[pyo3(signature = (joints, confidences=None, *, covariances=None, id=None))]
    fn new(
        joints: &Bound<'_, PyAny>,
        confidences: Option<&Bound<'_, PyAny>>,
        covariances: Option<&Bound<'_, PyAny>>,
        id: Option<u64>,
    ) -> Result<Self> {
        let places = match joints.cast::<PyDict>() {
            Ok(named) => read_named(named)?,
            Err(_) => read_places(joints)?,
        };
        let confidences = read_confidences(confidences)?;
        let covariances = covariances.map(read_covariances).transpose()?;
        let mut body = vision_models::Body::default();
        for (joint, place) in Body25::ALL.into_iter().zip(places) {
            let (Some(position), Some(confidence)) = (place, confidences.get(joint.index())) else {
                continue;
            };
            let keypoint = Keypoint { position, confidence: *confidence };
            match covariances.as_ref().and_then(|known| known.get(joint.index())) {
                Some(covariance) => body.set_measured(joint, keypoint, *covariance),
                None => body.set(joint, Some(keypoint)),
            }
        }
        Ok(Self(body.with_id(id.map(PersonId::new))))
    }

    /// A person who stands on the floor at (x, y) [m] and faces `heading` [rad from the world's x]. The working hand is
    /// at `hand`, (3,), in the person's frame [m]: x forward, y left, z up from the floor. It hangs if none is given.
    /// The other arm hangs. `side` is "left" or "right".
    ///
    /// Raises `Error` with the reason if the hand cannot reach the point.
    #[staticmethod]
    #[pyo3(signature = (person, floor, heading, *, hand=None, side="right", id=None))]
    fn standing(
        person: &Person,
        floor: &Bound<'_, PyAny>,
        heading: f64,
        hand: Option<&Bound<'_, PyAny>>,
        side: &str,
        id: Option<u64>,
    ) -> Result<Self> {
        let [x, y] = numbers("floor", floor)?;
        if !heading.is_finite() {
            return Err(Failure::value(format!(
                "heading is {heading}; it must be a finite number"
            )));
        }
        let side = keywords::side(side)?;
        let angles = match hand {
            None => JointAngles::default(),
            Some(hand) => {
                let target = HandTarget::point(numbers::<3>("hand", hand)?.into());
                let predictor = PosturePredictor::new(&person.0, side);
                floor.py().detach(|| predictor.predict(&target))?.angles
            }
        };
        let upright = Isometry3::from_parts(
            Translation3::new(x, y, 0.0),
            UnitQuaternion::from_axis_angle(&Vector3::z_axis(), heading),
        );
        let body = standing(&person.0, side, &angles)?.transformed(&upright);
        Ok(Self(body.with_id(id.map(PersonId::new))))
    }

    /// The names of the 25 joints, in their order.
    #[classattr]
    #[pyo3(name = "JOINTS")]
    fn names() -> Vec<&'static str> {
        Body25::ALL.map(Body25::name).to_vec()
    }

    /// The names of the joints that were seen.
    #[getter]
    fn seen(&self) -> Vec<&'static str> {
        self.0.iter().map(|(joint, _)| joint.name()).collect()
    }

    /// Positions [m], (25, 3), NaN for joints that were not seen.
    #[getter]
    fn joints<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        let place = |joint: &Option<Keypoint>| {
            joint.map_or([f64::NAN; 3], |joint| joint.position.coords.into())
        };
        let places = self.0.keypoints().each_ref().map(place);
        let flat = places.iter().flatten().copied();
        to_array(py, &nalgebra::DMatrix::from_row_iterator(Body25::COUNT, 3, flat))
    }

    /// Confidences of the joints, (25,), NaN for joints that were not seen.
    #[getter]
    fn confidences<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        let confidence =
            |joint: &Option<Keypoint>| joint.map_or(f64::NAN, |joint| joint.confidence.value());
        to_vector(py, &self.0.keypoints().each_ref().map(confidence))
    }

    /// Covariances of the positions [m²], (25, 3, 3), NaN where they are not known.
    #[getter]
    fn covariances<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray3<f64>> {
        let known = Body25::ALL.map(|joint| self.0.covariance(joint));
        let entry = |(joint, row, column): (usize, usize, usize)| {
            let known = known.get(joint).copied().flatten();
            known.and_then(|known| known.get((row, column)).copied()).unwrap_or(f64::NAN)
        };
        let array = Array3::from_shape_fn((Body25::COUNT, 3, 3), entry);
        PyArray3::from_owned_array(py, array)
    }

    /// The number of the person, None if the camera tracks nobody.
    #[getter]
    fn id(&self) -> Option<u64> {
        self.0.id().map(PersonId::number)
    }

    fn __repr__(&self) -> String {
        format!("<ahqp.collaboration.Body: {} joints>", self.0.iter().count())
    }
}

type Places = [Option<Point3<f64>>; Body25::COUNT];

/// Reads positions by name. The words of a name may be joined by a space or an underscore.
fn read_named(joints: &Bound<'_, PyDict>) -> Result<Places> {
    let mut places = [None; Body25::COUNT];
    for (name, place) in joints {
        let name: String = name.extract()?;
        let plain = name.replace('_', " ");
        let Some(joint) = Body25::ALL.into_iter().find(|joint| joint.name() == plain) else {
            let known = Body25::ALL.map(Body25::name).join(", ");
            return Err(Failure::value(format!("\"{name}\" is no joint; they are {known}")));
        };
        if let Some(slot) = places.get_mut(joint.index()) {
            *slot = Some(Point3::from(numbers::<3>(&name, &place)?));
        }
    }
    Ok(places)
}

fn read_places(joints: &Bound<'_, PyAny>) -> Result<Places> {
    let places = Matrix::read("joints", joints)?.to_nalgebra();
    if places.shape() != (Body25::COUNT, 3) {
        let (rows, columns) = places.shape();
        return Err(Failure::value(format!(
            "joints has shape ({rows}, {columns}); it must be (25, 3), in the order of Body.JOINTS"
        )));
    }
    let place = |joint: usize| {
        let row = places.row(joint);
        let seen = row.iter().all(|value| !value.is_nan());
        seen.then(|| Point3::new(row[0], row[1], row[2]))
    };
    Ok(std::array::from_fn(place))
}

fn read_confidences(value: Option<&Bound<'_, PyAny>>) -> Result<[Confidence; Body25::COUNT]> {
    let numbers = match value {
        None => [1.0; Body25::COUNT],
        Some(value) => match value.extract::<f64>() {
            Ok(number) => [number; Body25::COUNT],
            Err(_) => numbers("confidences", value)?,
        },
    };
    let mut confidences = [Confidence::ZERO; Body25::COUNT];
    for (confidence, number) in confidences.iter_mut().zip(numbers) {
        // A joint that was not seen has no confidence.
        if !number.is_nan() {
            *confidence = Confidence::new(number)?;
        }
    }
    Ok(confidences)
}

fn read_covariances(value: &Bound<'_, PyAny>) -> Result<Vec<Matrix3<f64>>> {
    let flat = value.call_method1("reshape", (-1,))?;
    let flat = vector_of("covariances", &flat, 9 * Body25::COUNT)?.as_array().to_vec();
    Ok(flat.chunks_exact(9).map(Matrix3::from_row_slice).collect())
}

/// Returns the joints of a person who stands at the origin of their own frame.
fn standing(
    person: &ergo_map::Person,
    side: ergo_map::Side,
    angles: &JointAngles,
) -> Result<vision_models::Body> {
    let marks = Skeleton::new(person, side).landmarks(angles)?;
    let segments = person.segments();
    let [upper_arm, forearm] =
        [segments.upper_arm, segments.forearm].map(|length| Vector3::z() * -length.unwrap_or(0.0));
    let aside = |place: Vector3<f64>, share: f64| place + Vector3::y() * (share * person.stature());
    let hanging = marks.other_shoulder + upper_arm;
    let other = [marks.other_shoulder, hanging, hanging + forearm];
    let own = [marks.shoulder, marks.elbow, marks.wrist];
    let (left, right) = match side {
        ergo_map::Side::Left => (own, other),
        ergo_map::Side::Right => (other, own),
    };
    let mut body = vision_models::Body::default();
    let mut set = |joint, place: Vector3<f64>| {
        body.set(joint, Some(Keypoint { position: place.into(), confidence: Confidence::ONE }));
    };
    for (joints, places) in [
        ([Body25::LeftShoulder, Body25::LeftElbow, Body25::LeftWrist], left),
        ([Body25::RightShoulder, Body25::RightElbow, Body25::RightWrist], right),
    ] {
        joints.into_iter().zip(places).for_each(|(joint, place)| set(joint, place));
    }
    set(Body25::Neck, 0.5 * (marks.shoulder + marks.other_shoulder));
    set(Body25::MidHip, marks.hip);
    for (share, [hip, knee, ankle, eye]) in [
        (1.0, [Body25::LeftHip, Body25::LeftKnee, Body25::LeftAnkle, Body25::LeftEye]),
        (-1.0, [Body25::RightHip, Body25::RightKnee, Body25::RightAnkle, Body25::RightEye]),
    ] {
        set(hip, aside(marks.hip, share * HIP));
        set(knee, aside(marks.knee, share * HIP));
        set(ankle, aside(marks.ankle, share * HIP));
        set(eye, aside(marks.eyes, share * EYE));
    }
    Ok(body)
}
