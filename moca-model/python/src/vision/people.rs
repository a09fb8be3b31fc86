//! Several people over time.

use numpy::PyArray1;
use pyo3::prelude::*;
use vision_models::{PeopleSettings, PersonId, PersonTrack, TrackedPerson, TrackerSettings};

use crate::arrays::{numbers, to_vector};
use crate::collaboration::body::Body;
use crate::failure::Result;
use crate::shared::Shared;

/// Follows several people, and selects the one who engages with the robot.
///
/// `People(*, place=(0.8, 0.0), radius=3.0, facing=1.2, dwell=0.3, release=6.0, keep=2.0, reach=0.6, separate=0.25, most=8,
/// least_confidence=0.3)`
///
/// Parameters
/// ----------
/// place : array_like, shape (2,)
///     The workplace on the floor [m].
/// radius, facing, dwell : float
///     Whoever is nearer to the workplace [m] and faces it to this angle [rad] for this time [s] engages.
/// release : float
///     An engaged person who is farther away is released [m].
/// keep : float
///     An engaged person who is not seen is kept for this time [s].
/// reach : float
///     Largest way of a person between two frames [m].
/// separate : float
///     Bodies that are nearer to each other are one person [m].
/// most : int
///     Largest number of people.
/// least_confidence : float
///     Joints with less confidence count as not seen.
///
/// >>> from ahqp.collaboration import Body, Scene
/// >>> from ahqp.ergo import Person
/// >>> from ahqp.vision import People
/// >>> people = People()
/// >>> for frame in range(20):
/// ...     bodies = [Body.standing(Person(1.75), [2.0, y], 3.14159) for y in (0.0, 2.0)]
/// ...     people.update(0.05 * frame, bodies)
/// >>> people.engaged.floor.round(2).tolist(), len(people.others)
/// ([2.0, 0.0], 1)
/// >>> scene = Scene(people.body, others=people.others, time=0.95)
#[pyclass(frozen, module = "ahqp.vision")]
pub(crate) struct People(Shared<State>);

#[derive(Debug)]
struct State {
    people: vision_models::People,
    /// Time of the newest frame [s].
    time: f64,
}

impl State {
    fn others(&self) -> impl Iterator<Item = &PersonTrack> {
        let engaged = self.people.engaged().map(PersonTrack::id);
        self.people.tracks().iter().filter(move |person| Some(person.id()) != engaged)
    }
}

#[pymethods]
impl People {
    #[new]
    #[pyo3(signature = (*, place=None, radius=3.0, facing=1.2, dwell=0.3, release=6.0, keep=2.0, reach=0.6, separate=0.25,
        most=8, least_confidence=0.3))]
    #[allow(clippy::too_many_arguments)] // keywords of Python
    fn new(
        place: Option<&Bound<'_, PyAny>>,
        radius: f64,
        facing: f64,
        dwell: f64,
        release: f64,
        keep: f64,
        reach: f64,
        separate: f64,
        most: usize,
        least_confidence: f64,
    ) -> Result<Self> {
        let default = PeopleSettings::default().place;
        let place = place.map(|place| numbers::<2>("place", place)).transpose()?;
        let place = place.map_or(default, Into::into);
        let settings =
            PeopleSettings { place, radius, facing, dwell, release, keep, reach, separate, most };
        let tracker = TrackerSettings { least_confidence, ..TrackerSettings::default() };
        let people = vision_models::People::new(settings, tracker)?;
        Ok(Self(Shared::new("People", State { people, time: f64::NAN })))
    }

    /// Takes the bodies of one frame, in the order of the time stamps; `time` in seconds.
    fn update(&self, py: Python<'_>, time: f64, bodies: Vec<PyRef<'_, Body>>) -> Result<()> {
        let bodies: Vec<_> = bodies.iter().map(|body| body.0.clone()).collect();
        let mut state = self.0.lock()?;
        let people = &mut state.people;
        py.detach(|| people.update(time, &bodies))?;
        state.time = time;
        Ok(())
    }

    /// The heading of the person who is followed nearest to a body, at the time `now` [s], as `Lifter.lift` takes it [rad]; None
    /// if nobody is near.
    fn heading_near(&self, body: &Body, now: f64) -> Result<Option<f64>> {
        Ok(self.0.lock()?.people.heading_near(&body.0, now))
    }

    /// The joints of the engaged person as measured, None if they are not in the newest frame.
    #[getter]
    fn body(&self) -> Result<Option<Body>> {
        let state = self.0.lock()?;
        let engaged = state.people.engaged().filter(|person| person.is_in_frame());
        Ok(engaged.map(|person| Body(person.measured().clone())))
    }

    /// The joints of all other people in the newest frame, as measured.
    #[getter]
    fn others(&self) -> Result<Vec<Body>> {
        let state = self.0.lock()?;
        let others = state.others().filter(|person| person.is_in_frame());
        Ok(others.map(|person| Body(person.measured().clone())).collect())
    }

    /// The person who works with the robot or is about to, at the newest frame.
    #[getter]
    fn engaged(&self) -> Result<Option<FollowedPerson>> {
        let state = self.0.lock()?;
        Ok(state.people.engaged().map(|track| FollowedPerson::new(track, state.time)))
    }

    /// Everybody who is followed, at the newest frame.
    #[getter]
    fn tracks(&self) -> Result<Vec<FollowedPerson>> {
        let state = self.0.lock()?;
        let tracks = state.people.tracks().iter();
        Ok(tracks.map(|track| FollowedPerson::new(track, state.time)).collect())
    }
}

/// A person who is followed, at one frame.
#[pyclass(frozen, module = "ahqp.vision")]
pub(crate) struct FollowedPerson {
    track: PersonTrack,
    now: Option<TrackedPerson>,
}

impl FollowedPerson {
    fn new(track: &PersonTrack, time: f64) -> Self {
        Self { track: track.clone(), now: track.predict(time) }
    }
}

#[pymethods]
impl FollowedPerson {
    /// Number of the person. No number is used twice.
    #[getter]
    fn id(&self) -> u64 {
        PersonId::number(self.track.id())
    }

    /// Filtered joints, with covariances, of the newest frame in which they were seen.
    #[getter]
    fn body(&self) -> Body {
        Body(self.track.body().clone())
    }

    /// Joints as measured in that frame. Give these to a controller, which filters by itself.
    #[getter]
    fn measured(&self) -> Body {
        Body(self.track.measured().clone())
    }

    /// True if the person was seen in the frame.
    #[getter]
    fn is_in_frame(&self) -> bool {
        self.track.is_in_frame()
    }

    /// Place on the floor [m], (2,); None before several frames agree.
    #[getter]
    fn floor<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<f64>>> {
        self.now.map(|person| to_vector(py, person.floor.coords.as_slice()))
    }

    /// Yaw of the person's forward direction [rad from the world's x], past ±π too.
    #[getter]
    fn heading(&self) -> Option<f64> {
        self.now.map(|person| person.heading)
    }

    /// Velocity over the floor [m/s], (2,).
    #[getter]
    fn velocity<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<f64>>> {
        self.now.map(|person| to_vector(py, person.velocity.as_slice()))
    }

    /// Time since the place was measured [s].
    #[getter]
    fn age(&self) -> Option<f64> {
        self.now.map(|person| person.age)
    }

    /// Stature and its standard error [m], None before enough segments were measured.
    #[getter]
    fn stature(&self) -> Option<(f64, f64)> {
        self.track.stature().map(|estimate| (estimate.stature, estimate.standard_error))
    }

    fn __repr__(&self) -> String {
        format!("<ahqp.vision.FollowedPerson: {}>", self.id())
    }
}
