//! Picture of a moment.

use std::borrow::Cow;

use hrsw_safety::{PersonBody, SafetyState};
use moca_model::Command;
use moca_replay::recorded::{
    Sampler, Tone, base_label, intention_label, others_row, person_row, phase_label, safety_label,
    solver_label,
};
use moca_simulation::Error;
use moca_simulation::workcell::{Counts, Who, Workcell};
use serde::Serialize;
use vision_models::{Body, Body25};

use crate::run::{Run, asks_for_ergonomics};

/// A state, and how it is to be seen.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct State {
    label: Cow<'static, str>,
    tone: Tone,
}

impl State {
    fn of(state: (impl Into<Cow<'static, str>>, Tone)) -> Self {
        Self { label: state.0.into(), tone: state.1 }
    }
}

/// Pace of the loop.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub(crate) struct Pace {
    /// Ticks; those that came late and were made up for; those that never came.
    pub(crate) ticks: u64,
    pub(crate) late: u64,
    pub(crate) lost: u64,
    /// Median duration of a tick \[µs\].
    pub(crate) median: f64,
    pub(crate) p99: f64,
}

/// A moment of the workcell, for pages.
#[derive(Clone, Debug, Serialize)]
#[expect(clippy::struct_excessive_bools, reason = "each is a lamp on the page")]
pub struct Picture {
    kind: &'static str,
    /// Counts pictures.
    pub(crate) number: u64,
    /// The workcell that it is of.
    pub(crate) head: u64,
    /// The last message that had been heard.
    heard: u64,
    time: f64,
    /// Numbers in the order of the head's columns.
    row: Vec<f32>,
    person: Vec<f32>,
    /// None while nobody else is there.
    others: Option<Vec<f32>>,
    phase: State,
    /// Reason why the phase began.
    since: State,
    intention: State,
    safety: State,
    base: State,
    solver: State,
    stopped: bool,
    waits: bool,
    ergonomics: bool,
    grasps: bool,
    rests: bool,
    /// REBA of the true posture.
    reba: Option<u8>,
    /// The pair with the least room above its protective distance: the robot's link and the part of a person.
    pair: Option<[String; 2]>,
    /// Floor and heading of the true person \[m, rad\].
    floor: [f64; 3],
    /// The same of the second person.
    bystander: Option<[f64; 3]>,
    /// Mean speed of the tool in the last second \[m/s\].
    calm: f64,
    limits: u64,
    too_near: u64,
    by_the_person: u64,
    unsolved: u64,
    /// The same robot with the other choice of ergonomics, if a page asks for it.
    beside: Option<Beside>,
    pace: Pace,
}

/// Picture of the robot that goes on beside.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Beside {
    row: Vec<f32>,
    /// REBA of the true posture there.
    reba: Option<u8>,
    /// Mean speed of the tool in the last second \[m/s\].
    calm: f64,
}

/// State of the loop at a moment, besides the workcell.
#[derive(Clone, Debug)]
pub(crate) struct Moment {
    pub(crate) number: u64,
    pub(crate) head: u64,
    pub(crate) heard: u64,
    pub(crate) since: (Cow<'static, str>, Tone),
    pub(crate) pace: Pace,
}

impl Picture {
    /// Takes a picture of a workcell.
    ///
    /// # Errors
    /// None of a workcell that goes on.
    pub(crate) fn of(
        run: &mut Run,
        beside: Option<&mut Run>,
        moment: Moment,
    ) -> Result<Self, Error> {
        let beside = beside.map(Beside::of).transpose()?;
        let calm = run.calm();
        let Run { cell, sampler, .. } = run;
        let (plant, controller) = (cell.plant(), cell.plant().controller());
        let posture = cell.true_posture(Who::Worker)?;
        let reba = posture.map(|posture| posture.reba.reba);
        let mut row = sample(cell, sampler, reba)?;
        let body = cell.body(Who::Worker).unwrap_or_default();
        row.extend(sampler.nearest(&row, &body));
        let stature = cell.setup().map.stature();
        let scored = posture.map(|posture| (posture.side, posture.reba.sub_scores));
        let other = cell.body(Who::Bystander);
        let command = plant.command();
        let safety = controller.safety();
        let supervisor = safety.supervisor();
        let pair = safety.nearest().and_then(|near| {
            let link = controller.settings().safety.bodies.get(near.robot);
            let link = link.map_or_else(|| "the object".to_owned(), |body| body.link.clone());
            let part = safety.all_bodies().get(near.other)?;
            Some([link, part_name(part, &body).to_owned()])
        });
        let place = |who| {
            let person = cell.person(who)?.person();
            Some([person.floor().x, person.floor().y, person.heading()])
        };
        let Counts { limits, too_near, by_the_person, unsolved, .. } = *cell.counts();
        Ok(Self {
            kind: "picture",
            number: moment.number,
            head: moment.head,
            heard: moment.heard,
            time: cell.time(),
            row,
            person: person_row(Some(&body), stature, scored),
            others: other.map(|body| others_row(&[body], stature)),
            phase: State::of(phase_label(command.phase, None)),
            since: State::of(moment.since),
            intention: State::of(intention_label(command.intention)),
            safety: State::of(safety_label(command.safety, supervisor.cause())),
            base: State::of(base_label(command.base_motion)),
            solver: State::of(solver_label(command.outcome)),
            stopped: command.safety == SafetyState::ProtectiveStop,
            waits: supervisor.waits_for_acknowledgement(),
            ergonomics: asks_for_ergonomics(cell),
            grasps: controller.object().is_some(),
            rests: controller.situation().is_at_rest,
            reba,
            pair,
            floor: place(Who::Worker).unwrap_or_default(),
            bystander: place(Who::Bystander),
            calm,
            limits,
            too_near,
            by_the_person,
            unsolved,
            beside,
            pace: moment.pace,
        })
    }
}

impl Beside {
    fn of(run: &mut Run) -> Result<Self, Error> {
        let posture = run.cell.true_posture(Who::Worker)?;
        let reba = posture.map(|posture| posture.reba.reba);
        let row = sample(&run.cell, &mut run.sampler, reba)?;
        Ok(Self { row, reba, calm: run.calm() })
    }
}

/// The numbers of a workcell's last tick, in the order of the head's columns but for those of the nearest part.
fn sample(cell: &Workcell, sampler: &mut Sampler, reba: Option<u8>) -> Result<Vec<f32>, Error> {
    let mut tick = cell.row().clone();
    if let Some(hand) = cell.score() {
        (tick.score, tick.reba) = (hand.score, hand.reba);
    }
    tick.reba_measured = reba;
    let plant = cell.plant();
    Ok(sampler.sample(plant.controller(), plant.configuration(), &tick)?)
}

/// Reason why the phase of a command began, if it began in this tick.
pub(crate) fn began(command: &Command) -> Option<(Cow<'static, str>, Tone)> {
    let transition = command.transition?;
    Some(phase_label(transition.to, Some(transition.reason)))
}

/// The joint of a person that is nearest to the middle of a part.
fn part_name(part: &PersonBody, body: &Body) -> &'static str {
    let middle = (part.capsule.start() + part.capsule.end()) * 0.5;
    let away =
        |(_, seen): &(Body25, vision_models::Keypoint)| (seen.position.coords - middle).norm();
    let nearest = body.iter().min_by(|one, other| away(one).total_cmp(&away(other)));
    nearest.map_or("a person", |(joint, _)| joint.name())
}
