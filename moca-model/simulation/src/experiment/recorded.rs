//! Recordings of people in place of simulated ones.

use percept_recording::{Recording, arrivals};
use simulated_people::Truth;
use vision_models::{
    Action, BodyTracker, Percept, RecognisedAction, Surface, Tool, TrackerSettings,
};

use super::walk::Walk;
use crate::error::Error;

/// Contents that a recording must have besides joints and tools.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Needs {
    /// Nothing more.
    Tools,
    /// The surface that the on-board camera sees before the person uses the tool.
    Surfaces,
}

/// A recording of a person.
#[derive(Clone, Debug, PartialEq)]
pub struct Recorded {
    /// Stature of the person \[m\].
    pub stature: f64,
    /// The tool that they use for most of the time.
    pub tool: Tool,
    /// The surface that the on-board camera sees before they use the tool; `None` if it sees none.
    pub facing_camera: Option<Surface>,
    /// The recorded percepts. The truth is the best estimate: the tracked person and the recognised action.
    pub walk: Walk,
}

impl Recorded {
    /// Takes a recording and checks that an experiment can play it.
    ///
    /// # Errors
    /// [`Error::Unfit`] if it does not contain what is needed.
    pub fn new(recording: Recording, needs: Needs) -> Result<Self, Error> {
        let unfit = |found: &str, wanted| Error::Unfit { found: found.to_owned(), wanted };
        let Recording { header, percepts, others, timings, .. } = recording;
        let stature = header.stature.ok_or_else(|| {
            unfit("it does not say how tall the person is", "give \"stature\" in its first line")
        })?;
        if percepts.iter().all(|percept| percept.body.is_none()) {
            return Err(unfit("nobody is seen in it", "give one that has frames with joints"));
        }
        let tool = tool_used(&percepts).ok_or_else(|| {
            unfit(
                "nobody uses a tool in it",
                "give one that has frames with an action of using one",
            )
        })?;
        let facing_camera = facing_camera(&percepts);
        if needs == Needs::Surfaces && facing_camera.is_none() {
            return Err(unfit(
                "it has no surface before the tool is used",
                "give one that has, which says what side is to be turned",
            ));
        }
        let truth = known_best(&percepts)?;
        let arrivals = arrivals(&percepts, &timings);
        let walk = Walk { percepts, others, arrivals, truth, motion: None };
        Ok(Self { stature, tool, facing_camera, walk })
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

/// The most frequent value; of several the first one.
fn most<T: PartialEq + Copy>(values: impl Iterator<Item = T>) -> Option<T> {
    let mut counts: Vec<(T, usize)> = Vec::new();
    for value in values {
        match counts.iter_mut().find(|(known, _)| *known == value) {
            Some((_, count)) => *count += 1,
            None => counts.push((value, 1)),
        }
    }
    // `max_by_key` takes the last of the largest.
    counts.into_iter().rev().max_by_key(|(_, count)| *count).map(|(value, _)| value)
}

/// The tracked person in each frame, and the last recognised action.
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
