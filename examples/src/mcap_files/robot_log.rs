//! A run of the robot in MCAP.

use std::collections::BTreeMap;

use moca_model::whole_body::{Data, Model};
use nalgebra::{IsometryMatrix3, Vector3};

use super::error::McapFileError;
use super::from_json_lines::write_recording;
use super::messages::{
    Colour, Deletion, Entity, FrameTransform, FrameTransforms, JointStates, SceneUpdate, Scores,
    Shape, Time,
};
use super::sink::{Channel, Sink};
use moca_replay::report::TickRow;

/// From one message of joints and scores to the next, and of the scene \[s\].
const NUMBERS: f64 = 0.01;
const SCENE: f64 = 0.05;
/// Of what is drawn.
const WORKSPACE: &str = "workspace";
/// Half a period: rounding must not skip a message.
const EARLY: f64 = 5e-4;

/// A recording and what the robot does in it.
pub struct RobotLog {
    sink: Sink,
    model: Model,
    data: Data,
    placements: Vec<IsometryMatrix3<f64>>,
    joints: Channel,
    scores: Channel,
    transforms: Channel,
    scene: Channel,
    next_numbers: f64,
    next_scene: f64,
}

impl std::fmt::Debug for RobotLog {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("RobotLog").field("next_numbers", &self.next_numbers).finish_non_exhaustive()
    }
}

impl RobotLog {
    /// Of a recording in JSON Lines, played to this robot.
    ///
    /// # Errors
    /// As [`from_json_lines`](super::from_json_lines).
    pub fn new(recording: &[u8], model: &Model) -> Result<Self, McapFileError> {
        let mut sink = Sink::new()?;
        write_recording(&mut sink, recording)?;
        Ok(Self {
            joints: sink.channel::<JointStates>("/joint_states")?,
            scores: sink.channel::<Scores>("/scores")?,
            transforms: sink.channel::<FrameTransforms>("/tf")?,
            scene: sink.channel::<SceneUpdate>("/workspace")?,
            data: Data::new(model),
            placements: vec![IsometryMatrix3::identity(); model.frame_count()],
            model: model.clone(),
            next_numbers: f64::NEG_INFINITY,
            next_scene: f64::NEG_INFINITY,
            sink,
        })
    }

    /// Takes a tick: joints and scores at 100 Hz, frames and workspace at 20 Hz.
    ///
    /// # Errors
    /// Numbers that are not finite.
    pub fn push(&mut self, row: &TickRow) -> Result<(), McapFileError> {
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

    /// The whole file.
    ///
    /// # Errors
    /// None in memory.
    pub fn finish(self) -> Result<Vec<u8>, McapFileError> {
        self.sink.finish()
    }

    fn numbers(&mut self, row: &TickRow) -> Result<(), McapFileError> {
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
        self.sink.write(self.joints, row.time, &joints)?;
        self.sink.write(self.scores, row.time, &scores)
    }

    fn frames(&mut self, row: &TickRow) -> Result<(), McapFileError> {
        self.data.pose(&self.model, &row.q)?.placements_into(&mut self.placements)?;
        let time = Time::new(row.time);
        let named = self.model.frames().zip(&self.placements);
        let transforms = named.map(|((_, name), pose)| FrameTransform::new(time, name, pose));
        let message = FrameTransforms { transforms: transforms.collect() };
        self.sink.write(self.transforms, row.time, &message)
    }

    fn scene(&mut self, row: &TickRow) -> Result<(), McapFileError> {
        let (min, max) = (Vector3::from(row.workspace_min), Vector3::from(row.workspace_max));
        let time = Time::new(row.time);
        let mut desired = Entity::new("desired", time, 0.0);
        let size = Vector3::repeat(0.04);
        desired.spheres.push(Shape::new(Vector3::from(row.desired), size, Colour::DESIRED));
        let mut scene = SceneUpdate::from(vec![desired]);
        // There is none before the person is first seen.
        if min.iter().chain(&max).all(|bound| bound.is_finite()) {
            let mut workspace = Entity::new(WORKSPACE, time, 0.0);
            workspace.cubes.push(Shape::new((min + max) * 0.5, max - min, Colour::WORKSPACE));
            scene.entities.push(workspace);
        } else {
            scene.deletions.push(Deletion::new(WORKSPACE, time));
        }
        self.sink.write(self.scene, row.time, &scene)
    }
}
