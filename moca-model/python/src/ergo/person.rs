//! People, and the postures that they take.

use std::collections::BTreeMap;

use ergo_map::{HandTarget, PosturePredictor, Segments, Skeleton};
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use super::keywords::side;
use super::posture::Posture;
use crate::arrays::{numbers, to_vector};
use crate::failure::{Failure, Result};

type Points<'py> = BTreeMap<&'static str, Bound<'py, PyArray1<f64>>>;

/// A person: stature, mass and lengths of the body.
///
/// `Person(stature, *, mass=None, segments=None)`
///
/// Parameters
/// ----------
/// stature : float
///     [m]
/// mass : float, optional
///     [kg]; that of a body-mass index of 23 kg/m² if not given.
/// segments : dict of str to float, optional
///     Measured lengths [m]: ankle_height, knee_height, hip_height, shoulder_height, eye_height,
///     upper_arm, forearm, grip, shoulder_half_width, foot; average for the stature if not given.
#[pyclass(frozen, module = "ahqp.ergo")]
pub(crate) struct Person(pub(crate) ergo_map::Person);

#[pymethods]
impl Person {
    #[new]
    #[pyo3(signature = (stature, *, mass=None, segments=None))]
    fn new(stature: f64, mass: Option<f64>, segments: Option<&Bound<'_, PyDict>>) -> Result<Self> {
        let mut person = ergo_map::Person::new(stature)?;
        if let Some(mass) = mass {
            person = person.with_mass(mass)?;
        }
        if let Some(segments) = segments {
            person = person.with_segments(&read_segments(segments)?)?;
        }
        Ok(Self(person))
    }

    /// Stature [m].
    #[getter]
    fn stature(&self) -> f64 {
        self.0.stature()
    }

    /// Mass [kg].
    #[getter]
    fn mass(&self) -> f64 {
        self.0.mass()
    }

    /// Height of the elbow, standing with hanging arms [m].
    #[getter]
    fn elbow_height(&self) -> f64 {
        self.0.elbow_height()
    }

    /// Lengths of the body [m], with all values filled in.
    #[getter]
    fn segments(&self) -> BTreeMap<&'static str, f64> {
        let mut segments = self.0.segments();
        let lengths =
            fields(&mut segments).map(|(name, length)| (name, length.unwrap_or(f64::NAN)));
        BTreeMap::from(lengths)
    }

    /// The posture of least effort that puts a hand at a point, (3,), in the person's frame [m]: origin
    /// on the floor below the pelvis, x forward, y left, z up. `side` is "left" or "right".
    ///
    /// Raises `Error` with the reason if the hand cannot reach the point.
    #[pyo3(signature = (hand, *, side="right"))]
    fn posture_at(&self, hand: &Bound<'_, PyAny>, side: &str) -> Result<Posture> {
        Ok(self.predict(hand, side)?.angles.posture().into())
    }

    /// The positions of the joints in that posture, by name, (3,) each, in the person's frame [m].
    #[pyo3(signature = (hand, *, side="right"))]
    fn landmarks_at<'py>(
        &self,
        py: Python<'py>,
        hand: &Bound<'py, PyAny>,
        side: &str,
    ) -> Result<Points<'py>> {
        let angles = self.predict(hand, side)?.angles;
        let marks = Skeleton::new(&self.0, self::side(side)?).landmarks(&angles)?;
        let points = [
            ("ankle", marks.ankle),
            ("knee", marks.knee),
            ("hip", marks.hip),
            ("lumbar", marks.lumbar),
            ("neck", marks.neck),
            ("eyes", marks.eyes),
            ("shoulder", marks.shoulder),
            ("other_shoulder", marks.other_shoulder),
            ("elbow", marks.elbow),
            ("wrist", marks.wrist),
            ("hand", marks.hand),
            ("centre_of_mass", marks.centre_of_mass),
        ];
        Ok(points.map(|(name, point)| (name, to_vector(py, point.as_slice()))).into())
    }

    fn __repr__(&self) -> String {
        format!("<ahqp.ergo.Person: {} m, {:.1} kg>", self.0.stature(), self.0.mass())
    }
}

impl Person {
    fn predict(&self, hand: &Bound<'_, PyAny>, side: &str) -> Result<ergo_map::Prediction> {
        let target = HandTarget::point(numbers::<3>("hand", hand)?.into());
        let predictor = PosturePredictor::new(&self.0, self::side(side)?);
        Ok(hand.py().detach(|| predictor.predict(&target))?)
    }
}

/// Returns the lengths by their names.
fn fields(segments: &mut Segments) -> [(&'static str, &mut Option<f64>); 10] {
    [
        ("ankle_height", &mut segments.ankle_height),
        ("knee_height", &mut segments.knee_height),
        ("hip_height", &mut segments.hip_height),
        ("shoulder_height", &mut segments.shoulder_height),
        ("eye_height", &mut segments.eye_height),
        ("upper_arm", &mut segments.upper_arm),
        ("forearm", &mut segments.forearm),
        ("grip", &mut segments.grip),
        ("shoulder_half_width", &mut segments.shoulder_half_width),
        ("foot", &mut segments.foot),
    ]
}

fn read_segments(lengths: &Bound<'_, PyDict>) -> Result<Segments> {
    let mut segments = Segments::default();
    for (key, value) in lengths {
        let key: String = key.extract()?;
        let fields = fields(&mut segments);
        let names = fields.each_ref().map(|(name, _)| *name).join(", ");
        let Some((_, slot)) = fields.into_iter().find(|(name, _)| *name == key) else {
            let text = format!("\"{key}\" is no segment; they are {names}");
            return Err(Failure::value(text));
        };
        *slot = Some(value.extract()?);
    }
    Ok(segments)
}
