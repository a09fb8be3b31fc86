//! What a camera frame shows of everybody.

use hrsw_safety::MOST_OTHERS;
use vision_models::{Body, Percept};

/// One more than the robot can keep away from, which then stops.
const ROOM: usize = MOST_OTHERS + 1;

/// A camera frame: the person who works with the robot, and the other people in view. Of fixed size, so that it goes
/// from thread to thread without an allocation.
///
/// ```
/// use moca_model::CameraFrame;
/// use vision_models::{Body, Percept};
///
/// let percept = Percept { time: 0.05, body: None, action: None, surface: None };
/// let frame = CameraFrame::from(percept).with_others(&[Body::default()]);
/// assert_eq!(frame.others().len(), 1);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct CameraFrame {
    /// The person who works with the robot.
    pub percept: Percept,
    others: [Body; ROOM],
    count: usize,
}

impl From<Percept> for CameraFrame {
    fn from(percept: Percept) -> Self {
        Self { percept, others: std::array::from_fn(|_| Body::default()), count: 0 }
    }
}

impl CameraFrame {
    /// The same with other people in view, in place of those before. Of more than five it holds five, one more than
    /// [`Controller::observe_people`](crate::Controller::observe_people) has room for, so that the robot stops.
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
}
