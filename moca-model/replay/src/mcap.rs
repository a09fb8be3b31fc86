//! A run of the robot in MCAP, together with the recording that was its input.

mod messages;

use std::collections::BTreeMap;

use moca_model::whole_body::{Data, Model};
use nalgebra::{IsometryMatrix3, Vector3};
use percept_recording::mcap::{
    Channel, Colour, Deletion, Entity, McapWriter, SceneUpdate, Shape, Time,
};

use crate::recorded::{Lane, ReplayError};
use crate::report::TickRow;
use messages::{ControlState, FrameTransform, FrameTransforms, JointStates, Scores};

/// Intervals between two messages of joints and scores, and between two of the scene \[s\].
const NUMBERS: f64 = 0.01;
const SCENE: f64 = 0.05;
/// Name of the drawn workspace.
const WORKSPACE: &str = "workspace";
/// Half a period \[s\]. It keeps rounding from skipping a message.
const EARLY: f64 = 5e-4;

/// A recording and the robot's motion during it.
///
/// ```
/// use moca_replay::mcap::RobotLog;
/// use moca_replay::report::TickRow;
/// use moca_model::moca;
///
/// # let recording = br#"{"format":"moca-recording","version":2,"frame":"world","rate":20.0}"#;
/// let mut log = RobotLog::new(recording, &moca()?)?;
/// log.push(&TickRow { q: moca_model::MOCA_HOME.to_vec(), ..TickRow::default() })?;
/// assert!(log.finish()?.starts_with(b"\x89MCAP"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct RobotLog {
    file: McapWriter,
    model: Model,
    data: Data,
    placements: Vec<IsometryMatrix3<f64>>,
    joints: Channel,
    scores: Channel,
    transforms: Channel,
    scene: Channel,
    states: Channel,
    next_numbers: f64,
    next_scene: f64,
}

impl std::fmt::Debug for RobotLog {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("RobotLog").field("next_numbers", &self.next_numbers).finish_non_exhaustive()
    }
}

impl RobotLog {
    /// Creates a log from a recording in JSON Lines that is the input of this robot.
    ///
    /// # Errors
    /// [`ReplayError::Mcap`] if the bytes are no recording.
    pub fn new(recording: &[u8], model: &Model) -> Result<Self, ReplayError> {
        let mut file = McapWriter::with_recording(recording)?;
        Ok(Self {
            joints: file.channel::<JointStates>("/joint_states")?,
            scores: file.channel::<Scores>("/scores")?,
            transforms: file.channel::<FrameTransforms>("/tf")?,
            scene: file.channel::<SceneUpdate>("/workspace")?,
            states: file.channel::<ControlState>("/control_state")?,
            data: Data::new(model),
            placements: vec![IsometryMatrix3::identity(); model.frame_count()],
            model: model.clone(),
            next_numbers: f64::NEG_INFINITY,
            next_scene: f64::NEG_INFINITY,
            file,
        })
    }

    /// Adds a tick: joints and scores at 100 Hz, frames and workspace at 20 Hz.
    ///
    /// # Errors
    /// Numbers that are not finite.
    pub fn push(&mut self, row: &TickRow) -> Result<(), ReplayError> {
        if row.time + EARLY >= self.next_numbers {
            self.next_numbers = row.time + NUMBERS;
            self.numbers(row)?;
        }
        if row.time + EARLY >= self.next_scene {
            self.next_scene = row.time + SCENE;
            self.frames(row)?;
            self.scene(row)?;
        }
        Ok(())
    }

    /// Adds the states of a loop whose first tick was at `first` \[s\]: phases, safety states, and their causes.
    ///
    /// # Errors
    /// Times that are not finite.
    pub fn push_states(&mut self, lane: &Lane, first: f64) -> Result<(), ReplayError> {
        for span in &lane.spans {
            let (of, state) = (lane.name.to_string(), span.label.to_string());
            self.file.write(self.states, first + span.begin, &ControlState { of, state })?;
        }
        Ok(())
    }

    /// Ends the file and returns all of it.
    ///
    /// # Errors
    /// None, since the file is in memory.
    pub fn finish(self) -> Result<Vec<u8>, ReplayError> {
        Ok(self.file.finish()?)
    }

    fn numbers(&mut self, row: &TickRow) -> Result<(), ReplayError> {
        let names = || self.model.joints().iter().map(|joint| joint.name.clone());
        let named =
            |values: &[f64]| names().zip(values.iter().copied()).collect::<BTreeMap<_, _>>();
        let joints = JointStates { position: named(&row.q), velocity: named(&row.qdot) };
        let error = Vector3::from(row.desired) - Vector3::from(row.actual);
        let [x, y, z, ..] = row.slack;
        let scores = Scores {
            ergonomics: row.score,
            reba: row.reba,
            reba_measured: row.reba_measured,
            together: row.collaborating,
            tracking_error: error.norm(),
            slack: Vector3::new(x, y, z).norm(),
            step_us: row.solve_time_us,
        };
        self.file.write(self.joints, row.time, &joints)?;
        Ok(self.file.write(self.scores, row.time, &scores)?)
    }

    fn frames(&mut self, row: &TickRow) -> Result<(), ReplayError> {
        self.data.pose(&self.model, &row.q)?.placements_into(&mut self.placements)?;
        let time = Time::new(row.time);
        let named = self.model.frames().zip(&self.placements);
        let transforms = named.map(|((_, name), pose)| FrameTransform::new(time, name, pose));
        let message = FrameTransforms { transforms: transforms.collect() };
        Ok(self.file.write(self.transforms, row.time, &message)?)
    }

    fn scene(&mut self, row: &TickRow) -> Result<(), ReplayError> {
        let (min, max) = (Vector3::from(row.workspace_min), Vector3::from(row.workspace_max));
        let time = Time::new(row.time);
        let mut desired = Entity::new("desired", time, 0.0);
        let size = Vector3::repeat(0.04);
        desired.spheres.push(Shape::new(Vector3::from(row.desired), size, Colour::DESIRED));
        let mut scene = SceneUpdate::from(vec![desired]);
        // There is no workspace before the person is first seen.
        if min.iter().chain(&max).all(|bound| bound.is_finite()) {
            let mut workspace = Entity::new(WORKSPACE, time, 0.0);
            workspace.cubes.push(Shape::new((min + max) * 0.5, max - min, Colour::WORKSPACE));
            scene.entities.push(workspace);
        } else {
            scene.deletions.push(Deletion::new(WORKSPACE, time));
        }
        Ok(self.file.write(self.scene, row.time, &scene)?)
    }
}
