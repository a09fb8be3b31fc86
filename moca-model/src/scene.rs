//! Scenes: camera frames with everybody in view.

use hrsw_safety::MOST_OTHERS;
use vision_models::{Body, People, Percept};

/// Number of stored people: one more than the robot can keep away from, at which it stops.
const ROOM: usize = MOST_OTHERS + 1;

/// A camera frame: the person who works with the robot, and the other people in view. Each body has the id of its
/// person, if the source tracks people. A percept alone is a scene with one person. The size is fixed, so that a scene
/// passes between threads without an allocation.
///
/// ```
/// use moca_model::Scene;
/// use vision_models::{Body, Percept};
///
/// let percept = Percept { time: 0.05, body: None, action: None, surface: None };
/// let scene = Scene::from(percept).with_others(&[Body::default()]);
/// assert_eq!(scene.others().len(), 1);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Scene {
    /// The person who works with the robot.
    pub percept: Percept,
    others: [Body; ROOM],
    count: usize,
}

impl From<Percept> for Scene {
    fn from(percept: Percept) -> Self {
        Self { percept, others: std::array::from_fn(|_| Body::default()), count: 0 }
    }
}

impl From<&Percept> for Scene {
    fn from(percept: &Percept) -> Self {
        percept.clone().into()
    }
}

impl Scene {
    /// Sets the other people in view. At most five are kept, one more than
    /// [`Controller::observe`](crate::Controller::observe) has room for, so that a crowd stops the robot. Its error
    /// then counts five.
    #[must_use]
    pub fn with_others(mut self, bodies: &[Body]) -> Self {
        self.count = bodies.len().min(ROOM);
        for (own, body) in self.others.iter_mut().zip(bodies) {
            own.clone_from(body);
        }
        self
    }

    /// The other people in view.
    pub fn others(&self) -> &[Body] {
        self.others.get(..self.count).unwrap_or_default()
    }

    /// Everybody in view, the person who works with the robot first.
    pub(crate) fn bodies(&self) -> impl Iterator<Item = &Body> {
        self.percept.body.iter().chain(self.others())
    }

    /// Gives ids to people whose source has none, by their places.
    pub(crate) fn identify(&mut self, people: &mut People) -> Result<(), vision_models::Error> {
        let others = self.others.get_mut(..self.count).unwrap_or_default();
        people.identify(&mut self.percept, others)
    }
}
