//! Records a run for pictures while it goes on.

use ergo_map::{ErgonomicsMap, RebaSubScores, Side};
use moca_model::whole_body::Model;
use moca_model::{Controller, ControllerSettings, GraspedObject};
use nalgebra::Isometry3;
use vision_models::{Body, Percept};

use super::lanes::{self, Lane, Tone};
use super::others_track::OthersTrack;
use super::person_track::{PersonTrack, points_at};
use super::replay::Replay;
use super::sampler::{FrameSlot, Sampler};
use super::stage::{Role, Shape};
use super::table::Table;
use super::{MapGrid, ReplayError};
use crate::report::TickRow;

/// Time between two samples \[s\]: 50 samples a second.
const INTERVAL: f64 = 0.02;

/// Samples a run 50 times a second.
///
/// Memory: at most [`Table::MOST`] samples of some 800 bytes, as many camera frames of 300 bytes, and 2000 states of
/// each lane. A longer run is sampled less often.
#[derive(Debug)]
pub struct Recorder {
    title: String,
    sampler: Sampler,
    samples: Option<Table>,
    person: PersonTrack,
    others: OthersTrack,
    /// Ticks between two samples, and up to the next.
    stride: u32,
    left: u32,
    phase: Lane,
    intention: Lane,
    safety: Lane,
    base: Lane,
    solver: Lane,
    action: Lane,
    surface: Lane,
}

impl Recorder {
    /// Creates a recorder for a robot and a person's map. The text of the URDF gives the robot's shapes.
    ///
    /// # Errors
    /// [`ReplayError::Urdf`], or a tool or link that the robot does not have.
    pub fn new(
        title: impl Into<String>,
        model: &Model,
        urdf: &str,
        settings: &ControllerSettings,
        map: &ErgonomicsMap,
    ) -> Result<Self, ReplayError> {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "at least 1")]
        let stride = (INTERVAL / settings.period).round().clamp(1.0, 1e6) as u32;
        Ok(Self {
            title: title.into(),
            sampler: Sampler::new(model, urdf, settings, map)?,
            samples: None,
            person: PersonTrack::new(map.stature()),
            others: OthersTrack::new(map.stature()),
            left: 0,
            phase: Lane::new("phase"),
            intention: Lane::new("intention"),
            safety: Lane::new("safety"),
            base: Lane::new("base"),
            solver: Lane::new("solver"),
            action: Lane::new("action seen"),
            surface: Lane::new("surface seen"),
            stride,
        })
    }

    /// Adds a solid that stands or moves on its own, such as the object. [`place`](Self::place) sets its pose.
    ///
    /// # Errors
    /// [`ReplayError::LateFrame`] after the first sample.
    pub fn add(
        &mut self,
        name: &str,
        role: Role,
        shape: Shape,
        colour: [f64; 3],
    ) -> Result<FrameSlot, ReplayError> {
        self.check_early(name)?;
        Ok(self.sampler.add(name, role, shape, colour))
    }

    /// Shows the object that the robot holds from the time at which the controller reports it.
    ///
    /// # Errors
    /// [`ReplayError::LateFrame`] after the first sample.
    pub fn grasping(&mut self, object: &GraspedObject) -> Result<(), ReplayError> {
        self.check_early("object")?;
        self.sampler.grasping(object);
        Ok(())
    }

    fn check_early(&self, name: &str) -> Result<(), ReplayError> {
        match self.samples {
            Some(_) => Err(ReplayError::LateFrame { name: name.to_owned() }),
            None => Ok(()),
        }
    }

    /// Places a frame here in the world from now on; `None` while it is nowhere.
    ///
    /// # Errors
    /// [`ReplayError::UnknownFrame`] for a frame of another recorder.
    pub fn place(
        &mut self,
        slot: FrameSlot,
        pose: Option<Isometry3<f64>>,
    ) -> Result<(), ReplayError> {
        self.sampler.place(slot, pose)
    }

    /// Adds a camera frame with the other people in it. `measured` has the scores of the person's posture and the side
    /// of the scored arm.
    pub fn observe(
        &mut self,
        percept: &Percept,
        others: &[Body],
        measured: Option<(Side, RebaSubScores)>,
    ) {
        self.person.observe(percept, measured);
        self.others.observe(percept.time, others);
        let (action, tone) = percept.action.map_or(("none", Tone::Quiet), |seen| {
            let works = seen.action.is_collaborative();
            let walks = seen.action.walking_direction().is_some();
            let tone = if walks { Tone::Walk } else { Tone::Work };
            (seen.action.name(), if works { tone } else { Tone::Quiet })
        });
        self.action.set(percept.time, action, tone);
        if let Some(seen) = percept.surface {
            self.surface.set(percept.time, lanes::surface(seen.surface), Tone::Work);
        }
    }

    /// Adds a tick: the controller after its step, the configuration of the robot \[m or rad\], and the row of the
    /// tick's results.
    ///
    /// # Errors
    /// A configuration that does not fit the robot.
    pub fn tick(
        &mut self,
        controller: &Controller,
        configuration: &[f64],
        row: &TickRow,
    ) -> Result<(), ReplayError> {
        let command = controller.command();
        if self.phase.spans.is_empty() || command.transition.is_some() {
            let reason = command.transition.map(|transition| transition.reason);
            let (phase, tone) = lanes::phase(command.phase, reason);
            self.phase.set(row.time, phase, tone);
        }
        self.phase.lasts(row.time);
        let (intention, tone) = lanes::intention(command.intention);
        self.intention.set(row.time, intention, tone);
        let cause = controller.safety().supervisor().cause();
        let (safety, tone) = lanes::safety(command.safety, cause);
        self.safety.set(row.time, safety, tone);
        if self.sampler.is_on_wheels() {
            let (base, tone) = lanes::base(command.base_motion);
            self.base.set(row.time, base, tone);
        }
        let (solver, tone) = lanes::solver(command.outcome);
        self.solver.set(row.time, solver, tone);
        self.sampler.watch(controller, configuration);
        if self.left > 0 {
            self.left -= 1;
            return Ok(());
        }
        self.left = self.stride - 1;
        let values = self.sampler.sample(controller, configuration, row)?;
        let table = self.samples.get_or_insert_with(|| Table::new(self.sampler.groups()));
        table.push(row.time, &values);
        Ok(())
    }

    /// The run up to here.
    pub fn finish(self) -> Replay {
        let Self { title, sampler, person, others, samples, .. } = self;
        let person = person.smoothed();
        let mut samples = samples.unwrap_or_else(|| Table::new(sampler.groups()));
        let times = samples.times().to_vec();
        samples.add_group(Sampler::nearest_group(), |index: usize, row: &[f32]| {
            let points = points_at(&person, times.get(index).copied().unwrap_or_default());
            sampler.nearest_to(row, &points)
        });
        let lanes = [
            self.phase,
            self.intention,
            self.safety,
            self.base,
            self.action,
            self.surface,
            self.solver,
        ];
        Replay {
            title,
            stage: sampler.stage().clone(),
            samples,
            person,
            others: others.finish(),
            lanes: lanes.into_iter().filter(|lane| !lane.spans.is_empty()).collect(),
            stature: sampler.map().stature(),
            side: sampler.map().side(),
            map: MapGrid::of(sampler.map()),
        }
    }
}
