//! The robot of a controller, and the person beside it.

use ergo_map::{ErgonomicsQuadratic, FitOptions, MapOptions, Side};
use hrsw_safety::LinkCapsule;
use moca_model::{ControllerSettings, MOCA_HOME, MecanumBase, TorqueLoopSettings, moca};
use pyo3::prelude::*;
use whole_body::Base;
use whole_body::torque::Compensation;

use super::settings::Settings;
use crate::arrays::vector_of;
use crate::ergo::map::ErgonomicsMap;
use crate::ergo::person::Person;
use crate::failure::{Failure, Result};
use crate::whole_body::bodies::{BodyOfLink, body};

/// Model, start and settings of a robot.
#[derive(Debug)]
pub(super) struct Robot {
    pub(super) model: whole_body::Model,
    pub(super) start: Vec<f64>,
    pub(super) settings: Settings,
}

impl Robot {
    /// Returns MOCA, at its home or at `start`.
    pub(super) fn moca(start: Option<&Bound<'_, PyAny>>) -> Result<Self> {
        let start = match start {
            None => MOCA_HOME.to_vec(),
            Some(start) => vector_of("start", start, MOCA_HOME.len())?.as_array().to_vec(),
        };
        let settings = Settings {
            controller: ControllerSettings::default(),
            torque: TorqueLoopSettings::new(Compensation::BARE),
        };
        Ok(Self { model: moca()?, start, settings })
    }

    /// Returns a robot of the caller. It keeps its own posture at the start, with the weights that MOCA has.
    pub(super) fn new(
        model: &whole_body::Model,
        start: &Bound<'_, PyAny>,
        tool: String,
        bodies: Vec<BodyOfLink<'_>>,
        own_pairs: &[(String, String)],
        mecanum: Option<[f64; 3]>,
    ) -> Result<Self> {
        let start = vector_of("start", start, model.position_count())?.as_array().to_vec();
        if mecanum.is_some() && model.base() != Base::Planar {
            let text = "mecanum is for a model with base=\"planar\", whose wheels move it";
            return Err(Failure::value(text));
        }
        let mut controller = ControllerSettings::of_robot(model, &tool, &start);
        let bodies = bodies.into_iter().map(body).collect::<Result<Vec<_>>>()?;
        controller.safety.own_pairs = pairs(&bodies, own_pairs)?;
        controller.safety.bodies = bodies;
        controller.base =
            mecanum.map(|[speed, lever, axis_speed]| MecanumBase { speed, lever, axis_speed });
        let torque = TorqueLoopSettings::of_robot(model, Compensation::BARE);
        Ok(Self { model: model.clone(), start, settings: Settings { controller, torque } })
    }

    /// Sets the work zone of the person's hand. Returns the person's ergonomics.
    pub(super) fn beside(
        &mut self,
        py: Python<'_>,
        person: Option<&Bound<'_, PyAny>>,
    ) -> Result<ErgonomicsQuadratic> {
        let (ergonomics, person, side) = fit(py, person)?;
        let space = self.settings.controller.space;
        self.settings.controller.space = space.for_person(&person, side);
        Ok(ergonomics)
    }
}

/// Returns the pairs of capsules of two links, by index.
fn pairs(bodies: &[LinkCapsule], links: &[(String, String)]) -> Result<Vec<(usize, usize)>> {
    let of = |link: &String| -> Result<Vec<usize>> {
        let on = |(index, body): (usize, &LinkCapsule)| (body.link == *link).then_some(index);
        let found: Vec<_> = bodies.iter().enumerate().filter_map(on).collect();
        if found.is_empty() {
            let text = format!("own_pairs names link `{link}`, of which bodies has no capsule");
            return Err(Failure::value(text));
        }
        Ok(found)
    };
    let mut pairs = Vec::new();
    for (one, other) in links {
        let others = of(other)?;
        for one in of(one)? {
            pairs.extend(others.iter().map(|other| (one, *other)));
        }
    }
    Ok(pairs)
}

/// Returns a person's ergonomics, the person, and the working hand.
fn fit(
    py: Python<'_>,
    person: Option<&Bound<'_, PyAny>>,
) -> Result<(ErgonomicsQuadratic, ergo_map::Person, Side)> {
    if let Some(map) = person.and_then(|person| person.cast::<ErgonomicsMap>().ok()) {
        let map = &map.get().0;
        let person = ergo_map::Person::new(map.stature())?;
        let (ergonomics, _) = py.detach(|| map.fit(&FitOptions::default()))?;
        return Ok((ergonomics, person, map.side()));
    }
    let person = match person.map(|person| (person, person.cast::<Person>())) {
        None => ergo_map::Person::average(),
        Some((_, Ok(person))) => person.get().0.clone(),
        Some((other, Err(_))) => {
            let kind = other.get_type();
            return Err(Failure::type_of_argument(format!(
                "person is a {kind}; give an ahqp.ergo.Person or an ahqp.ergo.ErgonomicsMap"
            )));
        }
    };
    let options = MapOptions::default();
    let ergonomics = py.detach(|| -> std::result::Result<_, ergo_map::Error> {
        Ok(ergo_map::ErgonomicsMap::build(&person, &options, None)?.fit(&FitOptions::default())?.0)
    })?;
    Ok((ergonomics, person, options.side))
}
