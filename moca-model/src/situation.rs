//! The situation of a tick.

use ergo_map::PersonFrame;
use nalgebra::Vector3;
use vision_models::{Freshness, Intention, TrackedPerson};

/// Possible place and intention of the person who works with the robot. It is made once a tick, by
/// [`SharedSpace::advance`](crate::SharedSpace::advance), and is all that the controller's tasks know of the person.
/// Separation has its own places of everybody, from measured joints.
///
/// ```
/// use moca_model::nalgebra::Isometry3;
/// use moca_model::{ControllerSettings, SharedSpace};
/// use vision_models::Freshness;
///
/// let mut space = SharedSpace::new(&ControllerSettings::default(), &Isometry3::identity())?;
/// let nobody = space.advance(0.001, 0.001)?;
/// assert_eq!(nobody.freshness(), Freshness::Lost);
/// assert!(!nobody.is_shared && !nobody.intention.is_together());
/// # Ok::<(), moca_model::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Situation {
    /// The person as tracked, if anybody was seen.
    pub worker: Option<TrackedPerson>,
    /// The person's intention.
    pub intention: Intention,
    /// True if the workspace belongs to the person, who works with the robot and was seen.
    pub is_shared: bool,
    /// True if the workspace belongs to the person and has reached them.
    pub is_in_place: bool,
    /// True if the person's frame is held in the world and moves at most at 0.06 m/s and 0.12 rad/s.
    pub is_at_rest: bool,
    /// The person's frame in which ergonomics are computed. It is smooth in time and moved by the following distance,
    /// so that the tool keeps its place in a workspace that falls behind.
    pub frame: PersonFrame,
    /// The walking velocity of the person in world axes \[m/s\]; zero if they are lost or the frame is held. The
    /// velocity of the frame differs, since the frame also reduces its distance to the person.
    pub velocity: Vector3<f64>,
}

impl Situation {
    /// Returns the situation before anybody was seen.
    pub(crate) fn unknown(frame: PersonFrame) -> Self {
        Self {
            worker: None,
            intention: Intention::Apart,
            is_shared: false,
            is_in_place: false,
            is_at_rest: false,
            frame,
            velocity: Vector3::zeros(),
        }
    }

    /// Freshness of the person's place; lost before anybody was seen.
    pub fn freshness(&self) -> Freshness {
        self.worker.map_or(Freshness::Lost, |worker| worker.freshness)
    }
}
