//! Recordings of people in place of simulated ones.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use vision_models::{
    Action, BodyTracker, Error, Percept, RecognisedAction, Surface, Tool, TrackerSettings,
};

use super::walk::Walk;
use crate::program::read_bytes;
use human_perception::learning::digest::Digest;
use moca_simulation::people::Truth;
use percept_recording::{IfPartial, Reader, Recording, arrivals};

/// The largest recording that is played: some days (bytes).
const LARGEST: u64 = 1 << 30;

/// What a recording must hold beside joints and tools.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Needs {
    /// Nothing.
    Tools,
    /// The surface that the on-board camera sees before the person uses the tool.
    Surfaces,
}

/// Why a whole recording does not fit an experiment.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum UnfitRecording {
    /// No stature in the header.
    #[error("it does not say how tall the person is; give \"stature\" in its first line")]
    Stature,
    /// No frame with joints.
    #[error("nobody is seen in it: no frame has joints")]
    Nobody,
    /// No frame in which somebody works with the robot.
    #[error("nobody uses a tool in it: no frame has an action of using one")]
    Tool,
    /// No surface before the tool is used.
    #[error(
        "it has no surface before the tool is used, so that nothing says which side is to be turned"
    )]
    Surface,
}

/// A recording of a person.
#[derive(Clone, Debug, PartialEq)]
pub struct Recorded {
    /// SHA-256 of its file, hexadecimal.
    pub digest: String,
    /// Of the person \[m\].
    pub stature: f64,
    /// The tool that they use for most of the time.
    pub tool: Tool,
    /// The surface that the on-board camera sees before they use it; none where it sees none.
    pub facing_camera: Option<Surface>,
    /// What was seen. The truth is what is known best: the tracked person and the recognised action.
    pub walk: Walk,
}

impl Recorded {
    /// Reads recordings, and checks that an experiment can play them.
    ///
    /// # Errors
    /// A file that cannot be read, is cut off or was interrupted, or does not hold what is needed; with its name.
    pub fn read_all(paths: &[PathBuf], needs: Needs) -> Result<Vec<Self>> {
        let read =
            |path: &PathBuf| Self::read(path, needs).with_context(|| path.display().to_string());
        paths.iter().map(read).collect()
    }

    fn read(path: &Path, needs: Needs) -> Result<Self> {
        let bytes = read_bytes(path, LARGEST)?;
        let recording = Recording::read(Reader::new(bytes.as_slice())?, IfPartial::Refuse)?;
        Self::new(recording, Digest::of_bytes(&bytes), needs)
    }

    fn new(recording: Recording, digest: Digest, needs: Needs) -> Result<Self> {
        let Recording { header, percepts, others, timings, .. } = recording;
        let stature = header.stature.ok_or(UnfitRecording::Stature)?;
        if percepts.iter().all(|percept| percept.body.is_none()) {
            return Err(UnfitRecording::Nobody.into());
        }
        let tool = tool_used(&percepts).ok_or(UnfitRecording::Tool)?;
        let facing_camera = facing_camera(&percepts);
        if needs == Needs::Surfaces && facing_camera.is_none() {
            return Err(UnfitRecording::Surface.into());
        }
        let truth = known_best(&percepts)?;
        let arrivals = arrivals(&percepts, &timings);
        let walk = Walk { percepts, others, arrivals, truth, motion: None };
        Ok(Self { digest: digest.to_string(), stature, tool, facing_camera, walk })
    }
}

/// The tool of an action in which the person works with the robot.
fn used(action: Option<RecognisedAction>) -> Option<Tool> {
    let action = action?.action;
    action.tool().filter(|_| action.is_collaborative())
}

/// The tool that is used in most frames.
fn tool_used(percepts: &[Percept]) -> Option<Tool> {
    most(percepts.iter().filter_map(|percept| used(percept.action)))
}

/// The surface that is seen in most frames before the tool is used.
fn facing_camera(percepts: &[Percept]) -> Option<Surface> {
    let before = percepts.iter().take_while(|percept| used(percept.action).is_none());
    most(before.filter_map(|percept| percept.surface).map(|seen| seen.surface))
}

/// What comes most often; of several the one that came first.
fn most<T: PartialEq + Copy>(values: impl Iterator<Item = T>) -> Option<T> {
    let mut counts: Vec<(T, usize)> = Vec::new();
    for value in values {
        match counts.iter_mut().find(|(known, _)| *known == value) {
            Some((_, count)) => *count += 1,
            None => counts.push((value, 1)),
        }
    }
    // The last of the largest is taken.
    counts.into_iter().rev().max_by_key(|(_, count)| *count).map(|(value, _)| value)
}

/// Where the tracked person is in each frame, and the action that was recognised last.
fn known_best(percepts: &[Percept]) -> Result<Vec<Truth>, Error> {
    let mut tracker = BodyTracker::new(TrackerSettings::default())?;
    let (mut action, mut truth) = (Action::Walking, Vec::new());
    for percept in percepts {
        tracker.update(percept)?;
        action = percept.action.map_or(action, |seen| seen.action);
        let Some(person) = tracker.predict(percept.time) else { continue };
        truth.push(Truth {
            time: percept.time,
            floor: person.floor,
            heading: person.heading,
            velocity: person.velocity,
            action,
        });
    }
    Ok(truth)
}
