//! What both runs of a comparison share.

use ergo_map::{ErgonomicsMap, ErgonomicsQuadratic, FitOptions, Person};
use human_perception::percepts::PostureSettings;
use moca_model::whole_body::Model;
use moca_model::whole_body::torque::Compensation;
use moca_model::{
    CameraFrame, ControllerSettings, HeldObject, MOCA_HOME, SpaceSettings, TorqueLoopSettings,
    moca, moca_safety,
};
use moca_replay::recorded::Recorder;
use percept_recording::{Timing, arrivals};
use vision_models::{Body, Percept};

use super::true_person::TrueMotion;
use crate::Error;
use crate::plant::Drive;

/// What both runs share.
#[derive(Debug)]
pub struct Scenario {
    /// Camera frames in the order of their times.
    pub percepts: Vec<Percept>,
    /// The people beside the one who works with the robot, frame by frame; none where the list ends.
    pub others: Vec<Vec<Body>>,
    /// When each is there to be acted on \[s\]: none before its time.
    pub arrivals: Vec<f64>,
    /// Where the person truly is, by whom distances are judged; none if they are judged by what percepts show.
    pub truth: Option<TrueMotion>,
    /// The person's map, which scores the postures.
    pub map: ErgonomicsMap,
    /// What the controller minimises.
    pub comfort: ErgonomicsQuadratic,
    /// Whose stature that is of, to adapt it to the stature that the robot measures \[m\]; none to leave
    /// it as it is.
    pub adapts_from: Option<f64>,
    /// The robot.
    pub model: Model,
    /// Where it starts.
    pub start: Vec<f64>,
    /// The controller, but for its goal.
    pub settings: ControllerSettings,
    /// The loop of torques below it.
    pub torques: TorqueLoopSettings,
    /// What the robot does with commands.
    pub drive: Drive,
    /// What the robot holds for the person to work on.
    pub object: HeldObject,
    /// How it comes by that.
    pub delivery: Delivery,
    /// What is known of the person beside their joints.
    pub posture: PostureSettings,
}

/// How the robot comes by the object.
#[derive(Debug, Clone, Default)]
pub enum Delivery {
    /// It holds it from the beginning, and knows it. Surfaces are as recorded.
    #[default]
    Held,
    /// The person hands it over. The on-board camera sees the true object.
    HandedOver {
        /// What the robot takes the object for, until the camera has seen it.
        believed: HeldObject,
    },
}

impl Scenario {
    /// MOCA at its home configuration with these percepts and this map, holding an object.
    ///
    /// # Errors
    /// A map that cannot be fitted, or no percepts.
    pub fn new(percepts: Vec<Percept>, person: &Person, map: ErgonomicsMap) -> Result<Self, Error> {
        if percepts.is_empty() {
            let found = "the recording holds no camera frame".to_owned();
            return Err(Error::Unfit { found, wanted: "give at least one" });
        }
        let (comfort, _) = map.fit(&FitOptions::default()).map_err(Error::Fit)?;
        let model = moca()?;
        let space = SpaceSettings::default().for_person(person, map.side());
        let settings = ControllerSettings { space, ..ControllerSettings::default() };
        let arrivals = percepts.iter().map(|percept| percept.time).collect();
        let (start, drive, object) = (MOCA_HOME.to_vec(), Drive::default(), HeldObject::default());
        let torques = TorqueLoopSettings::new(Compensation::BARE);
        let adapts_from = None;
        Ok(Self {
            percepts,
            others: Vec::new(),
            arrivals,
            truth: None,
            map,
            comfort,
            adapts_from,
            model,
            start,
            settings,
            torques,
            drive,
            object,
            delivery: Delivery::Held,
            posture: PostureSettings::default(),
        })
    }

    /// The same with another robot, at rest at `start`, n \[m, rad\]. Its settings name its tool and its bodies; the
    /// shared workspace stays that of the person.
    #[must_use]
    pub fn with_robot(self, model: Model, start: &[f64], settings: ControllerSettings) -> Self {
        let settings = ControllerSettings { space: self.settings.space, ..settings };
        Self { model, start: start.to_vec(), settings, ..self }
    }

    /// The same, with percepts that come as late as their recording says.
    #[must_use]
    pub fn arriving(mut self, timings: &[Timing]) -> Self {
        self.arrivals = arrivals(&self.percepts, timings);
        self
    }

    /// The same, with these other people in view, frame by frame.
    #[must_use]
    pub fn among(mut self, others: Vec<Vec<Body>>) -> Self {
        self.others = others;
        self
    }

    /// The other people in view of a frame.
    pub fn others(&self, frame: usize) -> &[Body] {
        self.others.get(frame).map_or(&[], Vec::as_slice)
    }

    /// The camera frames with everybody in view.
    pub fn camera_frames(&self) -> Vec<CameraFrame> {
        let frames = self.percepts.iter().enumerate();
        let frame = |(index, percept): (usize, &Percept)| {
            CameraFrame::from(percept.clone()).with_others(self.others(index))
        };
        frames.map(frame).collect()
    }

    /// The same without protective distances, speed cap and self-collision: the paper's stack alone.
    #[must_use]
    pub fn without_separation(mut self) -> Self {
        self.settings.safety = moca_safety().off();
        self
    }

    /// A recorder for the page of a run of this scenario; the text of the robot's URDF says what it looks like.
    ///
    /// # Errors
    /// [`Error::Replay`] for a text that is not the robot's URDF.
    pub fn recorder(&self, title: impl Into<String>, urdf: &str) -> Result<Recorder, Error> {
        let mut recorder = Recorder::new(title, &self.model, urdf, &self.settings, &self.map)?;
        recorder.holding(&self.object)?;
        Ok(recorder)
    }

    /// Returns true if people are kept at a distance.
    pub fn has_separation(&self) -> bool {
        !self.settings.safety.bodies.is_empty()
    }

    /// The same, with a robot that follows velocities exactly and at once.
    #[must_use]
    pub fn kinematic(mut self) -> Self {
        self.drive = Drive::Kinematic;
        self
    }

    /// How long it lasts \[s\].
    pub fn duration(&self) -> f64 {
        match (self.percepts.first(), self.percepts.last()) {
            (Some(first), Some(last)) => last.time - first.time,
            _ => 0.0,
        }
    }
}
