//! Publication of the people whom a camera sees.

use std::fmt;

use nalgebra::Point2;
use ros2_client::Publisher;
use vision_models::{Body, Confidence, RecognisedAction, RecognisedSurface};

use super::error::Ros2Error;
use super::messages::{Float64MultiArray, PoseArray, Text, Time};
use super::node::RosNode;
use super::people_messages::{BodyMessages, body_messages, stamped};
use super::topic::Topic;

/// Place of a person who is followed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Number of the person.
    pub number: u64,
    /// Place on the floor below the pelvis \[m\].
    pub floor: Point2<f64>,
    /// Heading \[rad\].
    pub heading: f64,
    /// Velocity over the floor \[m/s\].
    pub velocity: [f64; 2],
}

/// Numbers of a place in a message: number, x, y, heading, and the velocity along x and y.
const PLACE: usize = 6;

/// Results of a frame.
#[derive(Clone, Copy, Debug)]
pub struct PublishedPeople<'a> {
    /// Time at which the camera took the frame.
    pub stamp: Time,
    /// Frame in which the people are, [`WORLD_FRAME`](super::WORLD_FRAME) or [`MAP_FRAME`](super::MAP_FRAME).
    pub frame: &'a str,
    /// Person who works with the robot.
    pub person: Option<&'a Body>,
    /// Other people in view.
    pub others: &'a [Body],
    /// Places of the person and of the others, in their order; `None` for somebody without a place yet.
    pub places: &'a [Option<Place>],
    /// Action of the person.
    pub action: Option<RecognisedAction>,
    /// Surface of the object that faces the on-board camera.
    pub surface: Option<RecognisedSurface>,
    /// Delays after the stamp \[s\]: the images came; the joints were known; the action's images were taken, and the action
    /// was known; the same for the surface. NaN means never. Those that were taken before the stamp are negative.
    pub delays: [f64; 6],
}

/// Publishes the people whom a camera sees, for loops and for people who watch.
pub struct PeoplePublisher {
    bodies: Publisher<PoseArray>,
    confidences: Publisher<Float64MultiArray>,
    covariances: Publisher<Float64MultiArray>,
    people: Publisher<Float64MultiArray>,
    actions: Publisher<Text>,
    surfaces: Publisher<Text>,
    delays: Publisher<Float64MultiArray>,
}

impl fmt::Debug for PeoplePublisher {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("PeoplePublisher").finish_non_exhaustive()
    }
}

impl PeoplePublisher {
    pub(super) fn new(node: &mut RosNode) -> Result<Self, Ros2Error> {
        Ok(Self {
            bodies: node.publisher(Topic::BodyJoints)?,
            confidences: node.publisher(Topic::BodyConfidences)?,
            covariances: node.publisher(Topic::BodyCovariances)?,
            people: node.publisher(Topic::People)?,
            actions: node.publisher(Topic::Action)?,
            surfaces: node.publisher(Topic::Surface)?,
            delays: node.publisher(Topic::PerceptionDelays)?,
        })
    }

    /// Publishes the results of a frame. The joints come last, so that all about them is there.
    ///
    /// # Errors
    /// [`Ros2Error::Publish`]
    pub fn publish(&self, seen: &PublishedPeople<'_>) -> Result<(), Ros2Error> {
        let PublishedPeople { stamp, frame, person, others, places, action, surface, delays } =
            *seen;
        let BodyMessages { confidences, covariances, joints } =
            body_messages(stamp, frame, person, others);
        let place = |place: &Option<Place>| {
            place.map_or([f64::NAN; PLACE], |place| {
                let Place { number, floor, heading, velocity: [x, y] } = place;
                [number as f64, floor.x, floor.y, heading, x, y]
            })
        };
        let people = stamped(stamp, ("person", PLACE), places.iter().flat_map(place));
        if let Some(seen) = action {
            let data = named(seen.action.name(), seen.confidence);
            send(&self.actions, Text { data })?;
        }
        if let Some(seen) = surface {
            let data = named(seen.surface.name(), seen.confidence);
            send(&self.surfaces, Text { data })?;
        }
        send(&self.people, people)?;
        send(&self.delays, stamped(stamp, ("delay", delays.len()), delays))?;
        send(&self.confidences, confidences)?;
        send(&self.covariances, covariances)?;
        send(&self.bodies, joints)
    }
}

/// Returns a name with its confidence.
fn named(name: &str, confidence: Confidence) -> String {
    format!("{name} {}", confidence.value())
}

fn send<M: serde::Serialize>(to: &Publisher<M>, message: M) -> Result<(), Ros2Error> {
    to.publish(message).map_err(|error| Ros2Error::Publish { reason: error.to_string() })
}
