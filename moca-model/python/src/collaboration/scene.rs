//! Camera frames.

use std::sync::Arc;

use pyo3::prelude::*;
use vision_models::{Action, Confidence, Percept, RecognisedAction, RecognisedSurface, Surface};

use super::body::Body;
use crate::failure::{Failure, Result};

/// A camera frame with everybody in view.
///
/// `Scene(body=None, *, time=None, action=None, surface=None, others=())`
///
/// Parameters
/// ----------
/// body : Body, optional
///     The person who works with the robot, None if nobody was seen.
/// time : float, optional
///     When the frame was taken, on the clock of the controller's steps [s]; the present if it is not given.
/// action : str or (str, float), optional
///     What the person does, a name of `Scene.ACTIONS`, and its confidence, 1 if it is not given.
/// surface : str or (str, float), optional
///     The surface that faces the on-board camera, "drilled" or "smooth", in the same way.
/// others : sequence of Body
///     The other people in view. The robot keeps its distance from them.
///
/// >>> from ahqp.collaboration import Body, Scene
/// >>> from ahqp.ergo import Person
/// >>> body = Body.standing(Person(1.75), [1.7, 0.0], 3.14159)
/// >>> Scene(body, action=("Using The Drill", 0.83)).action
/// ('Using The Drill', 0.83)
#[pyclass(frozen, module = "ahqp.collaboration")]
pub(crate) struct Scene {
    /// The percept, whose time counts only if one was given.
    pub(crate) percept: Percept,
    pub(crate) others: Arc<[vision_models::Body]>,
    pub(crate) is_timed: bool,
}

/// A name, alone or with a confidence.
#[derive(FromPyObject)]
enum Recognised {
    Sure(String),
    With((String, f64)),
}

impl Recognised {
    fn parts(self) -> Result<(String, Confidence)> {
        match self {
            Self::Sure(name) => Ok((name, Confidence::ONE)),
            Self::With((name, confidence)) => Ok((name, Confidence::new(confidence)?)),
        }
    }
}

#[pymethods]
impl Scene {
    #[new]
    #[pyo3(signature = (body=None, *, time=None, action=None, surface=None, others=Vec::new()))]
    fn new(
        body: Option<&Body>,
        time: Option<f64>,
        action: Option<Recognised>,
        surface: Option<Recognised>,
        others: Vec<PyRef<'_, Body>>,
    ) -> Result<Self> {
        let action = action.map(|action| {
            let (name, confidence) = action.parts()?;
            let action = Action::from_label(&name).map_err(|_| {
                Failure::value(format!("\"{name}\" is no action; Scene.ACTIONS has their names"))
            })?;
            Ok(RecognisedAction { action, confidence })
        });
        let surface = surface.map(|surface| {
            let (name, confidence) = surface.parts()?;
            let surface: Surface = name.parse()?;
            Ok(RecognisedSurface { surface, confidence })
        });
        let percept = Percept {
            time: time.unwrap_or(f64::NAN),
            body: body.map(|body| body.0.clone()),
            action: action.transpose().map_err(|failure: Failure| failure)?,
            surface: surface.transpose().map_err(|failure: Failure| failure)?,
        };
        let others = others.iter().map(|body| body.0.clone()).collect();
        Ok(Self { percept, others, is_timed: time.is_some() })
    }

    /// The names of the thirty actions, of the data set HRI30.
    #[classattr]
    #[pyo3(name = "ACTIONS")]
    fn actions() -> Vec<&'static str> {
        Action::ALL.map(Action::name).to_vec()
    }

    /// When the frame was taken [s]; None for the present.
    #[getter]
    fn time(&self) -> Option<f64> {
        self.is_timed.then_some(self.percept.time)
    }

    /// The person who works with the robot, None if nobody was seen.
    #[getter]
    fn body(&self) -> Option<Body> {
        self.percept.body.clone().map(Body)
    }

    /// Action of the person, and its confidence.
    #[getter]
    fn action(&self) -> Option<(&'static str, f64)> {
        self.percept.action.map(|seen| (seen.action.name(), seen.confidence.value()))
    }

    /// The surface that faces the on-board camera, and its confidence.
    #[getter]
    fn surface(&self) -> Option<(&'static str, f64)> {
        self.percept.surface.map(|seen| (seen.surface.name(), seen.confidence.value()))
    }

    /// The other people in view.
    #[getter]
    fn others(&self) -> Vec<Body> {
        self.others.iter().cloned().map(Body).collect()
    }
}
