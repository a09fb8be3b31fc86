//! A simulated person.

use std::f64::consts::PI;

use nalgebra::{Point2, Vector2};
use numpy::PyArray1;
use pyo3::prelude::*;
use simulated_people::{
    Activity, CameraSettings, Facing, Lead, LedPerson, Perception, Way, Workplace, generator,
};
use vision_models::{Body25, Confidence, Keypoint, PersonId, Tool};

use crate::arrays::{numbers, to_vector};
use crate::collaboration::body::Body;
use crate::collaboration::scene::Scene;
use crate::failure::{Failure, Result};
use crate::shared::Shared;

/// Longest part of an advance that is computed at once [s].
const STEP: f64 = 1e-3;
/// Longest advance [s].
const LONGEST: f64 = 60.0;

/// A person who walks, turns, bends and works as told, within what people can do, before a camera with noise.
///
/// `SimulatedPerson(stature=1.75, floor=(1.7, 0.0), heading=pi, *, seed=0, noise=1.0, drop=0.02, id=0)`
///
/// Parameters
/// ----------
/// stature : float
///     From 1 to 2.3 [m].
/// floor : array_like, shape (2,)
///     Where they stand at first, x and y [m].
/// heading : float
///     Which way they face at first [rad from the world's x].
/// seed : int
///     The same seed gives the same camera frames.
/// noise : float
///     Factor on the camera's noise, from 0 to 10. That of a RealSense D435i is 1: 4 mm of depth at a metre, four times
///     as much at two.
/// drop : float
///     Probability that a joint is missing in a frame, from 0 to 1. A tenth of it is the probability that a frame is lost.
/// id : int
///     The number that the camera gives them.
///
/// Times count from the first `advance`.
///
/// >>> from ahqp.simulation import SimulatedPerson
/// >>> person = SimulatedPerson(seed=1)
/// >>> person.walk_to([2.4, 0.5], speed=0.5)
/// >>> person.advance(4.0)
/// >>> person.floor.round(2).tolist(), person.action
/// ([2.4, 0.5], 'Walking')
/// >>> person.look().body.joints.shape
/// (25, 3)
#[pyclass(frozen, module = "ahqp.simulation")]
pub(crate) struct SimulatedPerson(Shared<State>);

#[derive(Debug)]
struct State {
    person: LedPerson,
    perception: Perception,
    time: f64,
    /// Place at which the hand works [m].
    object: Option<[f64; 3]>,
    id: PersonId,
}

impl State {
    /// Changes what the person is told.
    fn tell(&mut self, change: impl FnOnce(&mut Lead)) -> Result<()> {
        let mut lead = *self.person.told();
        change(&mut lead);
        Ok(self.person.lead(lead)?)
    }
}

#[pymethods]
impl SimulatedPerson {
    #[new]
    #[pyo3(signature = (stature=1.75, floor=None, heading=PI, *, seed=0, noise=1.0, drop=0.02, id=0))]
    fn new(
        stature: f64,
        floor: Option<&Bound<'_, PyAny>>,
        heading: f64,
        seed: u64,
        noise: f64,
        drop: f64,
        id: u64,
    ) -> Result<Self> {
        let floor = floor.map_or(Ok([1.7, 0.0]), |floor| numbers("floor", floor))?;
        for (name, value, [low, high]) in [
            ("heading", heading, [-100.0, 100.0]),
            ("noise", noise, [0.0, 10.0]),
            ("drop", drop, [0.0, 1.0]),
        ] {
            if !(low..=high).contains(&value) {
                return Err(Failure::value(format!("{name} = {value}: give {low} to {high}")));
            }
        }
        let mut person = LedPerson::new(stature, floor.into(), heading)?;
        person.lead(Lead { facing: Facing::Heading(heading % (2.0 * PI)), ..Lead::default() })?;
        let (camera, id) =
            (CameraSettings { noise, drop, ..CameraSettings::default() }, PersonId::new(id));
        let draws = [0, 1].map(|stream| generator(seed, stream));
        let perception = Perception::new(id, camera, 0.0, Tool::Drill, draws);
        Ok(Self(Shared::new(
            "SimulatedPerson",
            State { person, perception, time: 0.0, object: None, id },
        )))
    }

    /// Walks to a place on the floor, x and y [m], at a speed of 0.1 to 1.2 m/s.
    #[pyo3(signature = (place, *, speed=0.5))]
    fn walk_to(&self, place: &Bound<'_, PyAny>, speed: f64) -> Result<()> {
        let place = Point2::from(numbers::<2>("place", place)?);
        self.0.lock()?.tell(|lead| (lead.way, lead.speed) = (Way::To(place), speed))
    }

    /// Walks in a direction over the floor, (2,), until told otherwise, at a speed of 0.1 to 1.2 m/s.
    #[pyo3(signature = (direction, *, speed=0.5))]
    fn walk_along(&self, direction: &Bound<'_, PyAny>, speed: f64) -> Result<()> {
        let direction = Vector2::from(numbers::<2>("direction", direction)?);
        self.0.lock()?.tell(|lead| (lead.way, lead.speed) = (Way::Along(direction), speed))
    }

    /// Stops, and stands.
    fn stand(&self) -> Result<()> {
        self.0.lock()?.tell(|lead| lead.way = Way::Stand)
    }

    /// Faces this heading [rad from the world's x]; where they walk for "way"; the object for "object".
    fn face(&self, heading: &Bound<'_, PyAny>) -> Result<()> {
        let facing = if let Ok(heading) = heading.extract::<f64>() {
            Facing::Heading(heading)
        } else {
            match heading.extract::<&str>()? {
                "way" => Facing::Way,
                "object" => Facing::Robot,
                other => {
                    let text =
                        format!("heading is \"{other}\"; give an angle, \"way\" or \"object\"");
                    return Err(Failure::value(text));
                }
            }
        };
        self.0.lock()?.tell(|lead| lead.facing = facing)
    }

    /// Leans forwards by 0 to 1.2 rad, and lowers the pelvis by 0 to 0.2 statures. No argument stands upright.
    #[pyo3(signature = (lean=0.0, squat=0.0))]
    fn bend(&self, lean: f64, squat: f64) -> Result<()> {
        self.0.lock()?.tell(|lead| (lead.lean, lead.squat) = (lean, squat))
    }

    /// Works with a tool, "drill" or "polisher", on the object; None for empty hands.
    #[pyo3(signature = (tool))]
    fn use_tool(&self, tool: Option<&str>) -> Result<()> {
        let activity = match tool {
            None => Activity::Walk,
            Some("drill") => Activity::Use(Tool::Drill),
            Some("polisher") => Activity::Use(Tool::Polisher),
            Some(other) => {
                let text = format!("tool is \"{other}\"; give \"drill\", \"polisher\" or None");
                return Err(Failure::value(text));
            }
        };
        self.0.lock()?.tell(|lead| lead.activity = activity)
    }

    /// Goes on by `dt` [s], at most a minute. `object`, (3,) [m], is where the object is that the working hand follows. It
    /// stays there until another place is given.
    #[pyo3(signature = (dt, object=None))]
    fn advance(&self, py: Python<'_>, dt: f64, object: Option<&Bound<'_, PyAny>>) -> Result<()> {
        if !(0.0..=LONGEST).contains(&dt) {
            return Err(Failure::value(format!("dt = {dt}: give 0 to {LONGEST} s")));
        }
        let object = object.map(|object| numbers::<3>("object", object)).transpose()?;
        let mut state = self.0.lock()?;
        let State { person, time, object: known, .. } = &mut *state;
        *known = object.or(*known);
        py.detach(|| {
            let mut left = dt;
            while left > 0.0 {
                let step = left.min(STEP);
                person.advance(step, &workplace(person, *known));
                left -= step;
            }
        });
        *time += dt;
        Ok(())
    }

    /// Scene that the camera sees, with the time of the frame; None if the frame is lost. It has 20 frames a second, so ask
    /// every 0.05 s. `others` are bodies of other people in view.
    #[pyo3(signature = (others=Vec::new()))]
    fn look(&self, others: Vec<PyRef<'_, Body>>) -> Result<Option<Scene>> {
        let mut state = self.0.lock()?;
        let State { person, perception, time, .. } = &mut *state;
        let percept = perception.look(*time, person.person(), true);
        let others = others.iter().map(|body| body.0.clone()).collect();
        Ok(percept.map(|percept| Scene { percept, others, is_timed: true }))
    }

    /// The true joints, without noise.
    #[getter]
    fn body(&self) -> Result<Body> {
        let state = self.0.lock()?;
        let mut body = vision_models::Body::default();
        for (joint, position) in Body25::ALL.into_iter().zip(state.person.person().joints()) {
            body.set(joint, Some(Keypoint { position, confidence: Confidence::ONE }));
        }
        Ok(Body(body.with_id(Some(state.id))))
    }

    /// The true action, a name of `Scene.ACTIONS`.
    #[getter]
    fn action(&self) -> Result<&'static str> {
        Ok(self.0.lock()?.person.person().action().name())
    }

    /// The true place on the floor, x and y [m], (2,).
    #[getter]
    fn floor<'py>(&self, py: Python<'py>) -> Result<Bound<'py, PyArray1<f64>>> {
        Ok(to_vector(py, self.0.lock()?.person.person().floor().coords.as_slice()))
    }

    /// The true heading [rad from the world's x].
    #[getter]
    fn heading(&self) -> Result<f64> {
        Ok(self.0.lock()?.person.person().heading())
    }

    /// The true velocity over the floor, x and y [m/s], (2,).
    #[getter]
    fn velocity<'py>(&self, py: Python<'py>) -> Result<Bound<'py, PyArray1<f64>>> {
        Ok(to_vector(py, self.0.lock()?.person.person().velocity().as_slice()))
    }

    /// The stature [m].
    #[getter]
    fn stature(&self) -> Result<f64> {
        Ok(self.0.lock()?.person.person().stature())
    }

    /// The time that has passed [s].
    #[getter]
    fn time(&self) -> Result<f64> {
        Ok(self.0.lock()?.time)
    }
}

/// The place of the object. If there is none, the hand works half a metre ahead, at the height of the elbow.
fn workplace(person: &LedPerson, object: Option<[f64; 3]>) -> Workplace {
    let person = person.person();
    let object = object.map_or_else(
        || {
            let (sine, cosine) = person.heading().sin_cos();
            let ahead = person.floor() + 0.5 * Vector2::new(cosine, sine);
            nalgebra::Point3::new(ahead.x, ahead.y, 0.62 * person.stature())
        },
        Into::into,
    );
    Workplace { object, between: object }
}
