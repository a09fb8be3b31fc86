//! Scenarios, which both runs of a comparison share.

use ergo_map::{ErgonomicsMap, ErgonomicsQuadratic, FitOptions, Person};
use human_perception::percepts::PostureSettings;
use moca_model::whole_body::Model;
use moca_model::whole_body::torque::Compensation;
use moca_model::{
    BoxSide, ControllerSettings, DynamicRobotSettings, GraspedObject, MOCA_HOME, Scene,
    SpaceSettings, TorqueLoopSettings, WorkFace, moca, moca_safety,
};
use moca_replay::recorded::Recorder;
use percept_recording::{Timing, arrivals};
use vision_models::{Body, People, PeopleSettings, Percept, Surface, TrackerSettings};

use super::true_person::TrueMotion;
use crate::error::Error;
use crate::plant::Drive;

/// Place of the on-board camera in the frame of the base on the floor \[m\].
const ON_BOARD_CAMERA: [f64; 3] = [0.35, 0.0, 1.15];

/// A scenario, which both runs of a comparison share.
#[derive(Debug)]
pub struct Scenario {
    /// Camera frames in the order of their times.
    pub percepts: Vec<Percept>,
    /// The people besides the one who works with the robot, frame by frame; nobody after the end of the list.
    pub others: Vec<Vec<Body>>,
    /// Times at which each frame has arrived \[s\], none before its own time.
    pub arrivals: Vec<f64>,
    /// The person's true motion, by which distances are judged; `None` to judge them by the percepts.
    pub truth: Option<TrueMotion>,
    /// The person's map, which scores the postures.
    pub map: ErgonomicsMap,
    /// The ergonomics that the controller minimises.
    pub ergonomics: ErgonomicsQuadratic,
    /// Stature of the ergonomics, to adapt them to the measured stature \[m\]; `None` to leave them.
    pub adapts_from: Option<f64>,
    /// The robot.
    pub model: Model,
    /// Start configuration.
    pub start: Vec<f64>,
    /// Settings of the controller except for its objective.
    pub settings: ControllerSettings,
    /// Settings of the torque loop below it.
    pub torques: TorqueLoopSettings,
    /// Dynamics of the robot.
    pub drive: Drive,
    /// Drives and sensors of a robot under torques.
    pub robot: DynamicRobotSettings,
    /// The object that the robot holds for the person to work on.
    pub object: GraspedObject,
    /// Way in which the robot gets the object.
    pub delivery: Delivery,
    /// Settings of the person's posture besides their joints.
    pub posture: PostureSettings,
}

/// Ways in which the robot gets the object.
#[derive(Debug, Clone, Default)]
pub enum Delivery {
    /// The robot holds the object from the beginning and knows it. Surfaces are as recorded.
    #[default]
    Grasped,
    /// The person hands it over. The on-board camera sees the true object.
    HandedOver {
        /// The object that the robot assumes until the camera has seen it.
        believed: GraspedObject,
    },
}

impl Scenario {
    /// Creates a scenario with MOCA at its home configuration, these percepts and this map, and a grasped object.
    ///
    /// # Errors
    /// A map that cannot be fitted, or no percepts.
    pub fn new(percepts: Vec<Percept>, person: &Person, map: ErgonomicsMap) -> Result<Self, Error> {
        if percepts.is_empty() {
            let found = "the recording holds no camera frame".to_owned();
            return Err(Error::Unfit { found, wanted: "give at least one" });
        }
        let (ergonomics, _) = map.fit(&FitOptions::default()).map_err(Error::Fit)?;
        let model = moca()?;
        let space = SpaceSettings::default().for_person(person, map.side());
        let settings = ControllerSettings { space, ..ControllerSettings::default() };
        let arrivals = percepts.iter().map(|percept| percept.time).collect();
        let (start, drive, object) =
            (MOCA_HOME.to_vec(), Drive::default(), GraspedObject::default());
        let torques = TorqueLoopSettings::new(Compensation::BARE);
        let adapts_from = None;
        Ok(Self {
            percepts,
            others: Vec::new(),
            arrivals,
            truth: None,
            map,
            ergonomics,
            adapts_from,
            model,
            start,
            settings,
            torques,
            drive,
            robot: DynamicRobotSettings::default(),
            object,
            delivery: Delivery::Grasped,
            posture: PostureSettings::default(),
        })
    }

    /// Sets another robot, at rest at `start`, n \[m, rad\]. Its settings name its tool and its bodies. The shared
    /// workspace stays that of the person.
    #[must_use]
    pub fn with_robot(self, model: Model, start: &[f64], settings: ControllerSettings) -> Self {
        let settings = ControllerSettings { space: self.settings.space, ..settings };
        Self { model, start: start.to_vec(), settings, ..self }
    }

    /// Sets the arrival times of percepts from their recording.
    #[must_use]
    pub fn arriving(mut self, timings: &[Timing]) -> Self {
        self.arrivals = arrivals(&self.percepts, timings);
        self
    }

    /// Sets the other people in view, frame by frame. Frames without ids get those of [`People`].
    ///
    /// # Errors
    /// Percepts out of order.
    pub fn among(mut self, others: Vec<Vec<Body>>) -> Result<Self, Error> {
        self.others = others;
        let mut people = People::new(PeopleSettings::untracked(), TrackerSettings::default())?;
        for (percept, others) in self.percepts.iter_mut().zip(&mut self.others) {
            people.identify(percept, others)?;
        }
        Ok(self)
    }

    /// The other people in view of a frame.
    pub fn others(&self, frame: usize) -> &[Body] {
        self.others.get(frame).map_or(&[], Vec::as_slice)
    }

    /// The camera frames with everybody in view.
    pub fn scenes(&self) -> Vec<Scene> {
        let frames = self.percepts.iter().enumerate();
        let frame = |(index, percept): (usize, &Percept)| {
            Scene::from(percept.clone()).with_others(self.others(index))
        };
        frames.map(frame).collect()
    }

    /// Removes protective distances, speed limit and self-collision, which leaves the paper's stack.
    #[must_use]
    pub fn without_separation(mut self) -> Self {
        self.settings.safety = moca_safety().off();
        self
    }

    /// Sets the paper's own controller ([`ControllerSettings::as_in_paper`]).
    #[must_use]
    pub fn as_in_paper(mut self) -> Self {
        self.settings = self.settings.as_in_paper();
        self
    }

    /// Lets the person hand over an object with this surface in front and the other one behind. The robot assumes the
    /// default object until the camera on its base has seen this one.
    #[must_use]
    pub fn handed_over(mut self, front: Surface) -> Self {
        let back = match front {
            Surface::Drilled => Surface::Smooth,
            Surface::Smooth => Surface::Drilled,
        };
        self.settings.on_board_camera.get_or_insert(ON_BOARD_CAMERA);
        self.object.faces = vec![
            WorkFace { side: BoxSide::Front, surface: front },
            WorkFace { side: BoxSide::Back, surface: back },
        ];
        self.delivery = Delivery::HandedOver { believed: GraspedObject::default() };
        self
    }

    /// Creates a recorder for the page of a run of this scenario. The text of the robot's URDF describes its
    /// appearance.
    ///
    /// # Errors
    /// [`Error::Replay`] for a text that is not the robot's URDF.
    pub fn recorder(&self, title: impl Into<String>, urdf: &str) -> Result<Recorder, Error> {
        let mut recorder = Recorder::new(title, &self.model, urdf, &self.settings, &self.map)?;
        recorder.grasping(&self.object)?;
        Ok(recorder)
    }

    /// Returns true if distances from people are kept.
    pub fn has_separation(&self) -> bool {
        self.settings.safety.keeps_distances()
    }

    /// Lets the robot follow velocities exactly and at once.
    #[must_use]
    pub fn kinematic(mut self) -> Self {
        self.drive = Drive::Kinematic;
        self
    }

    /// The duration \[s\].
    pub fn duration(&self) -> f64 {
        match (self.percepts.first(), self.percepts.last()) {
            (Some(first), Some(last)) => last.time - first.time,
            _ => 0.0,
        }
    }
}
