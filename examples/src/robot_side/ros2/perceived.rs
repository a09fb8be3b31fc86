//! From body joints and actions to percepts.

use std::time::SystemTime;

use nalgebra::Point3;
use vision_models::{Action, Body, Body25, Confidence, Keypoint, RecognisedAction};

use super::WORLD_FRAME;
use super::measurements::check_frame;
use super::messages::{Pose, PoseArray, Text};
use super::refusal::Refusal;
use super::stamps::Stamps;

/// For how long an action holds after it was published \[s\].
const ACTION_HOLDS: f64 = 1.0;

/// People as somebody else's camera has seen them.
#[derive(Clone, Debug, PartialEq)]
pub struct SeenPeople {
    /// When the camera took the frame.
    pub taken: SystemTime,
    /// The person who works with the robot, if they are in view, in the frame of the odometry.
    pub body: Option<Body>,
    /// The other people in view, likewise.
    pub others: Vec<Body>,
    /// What the person does, if that was published within the last second.
    pub action: Option<RecognisedAction>,
}

/// Joins body joints and actions.
#[derive(Clone, Debug)]
pub struct Perceived {
    stamps: Stamps,
    action: Option<(RecognisedAction, SystemTime)>,
}

impl Default for Perceived {
    fn default() -> Self {
        Self { stamps: Stamps::of_camera(), action: None }
    }
}

impl Perceived {
    /// Takes body joints that have come `now`: a pose for each of [`Body25::ALL`], in this order, in the frame of the
    /// odometry. A joint that was not seen has three NaN. Orientations mean nothing. Behind those of the person who
    /// works with the robot there may be those of others, as many each.
    ///
    /// # Errors
    /// Why they are refused.
    pub fn take_body(&mut self, poses: &PoseArray, now: SystemTime) -> Result<SeenPeople, Refusal> {
        check_frame(&poses.header.frame_id, WORLD_FRAME)?;
        let (found, expected) = (poses.poses.len(), Body25::COUNT);
        if found == 0 || found % expected != 0 {
            return Err(Refusal::Size { what: "body joints", found, expected });
        }
        let people = poses.poses.chunks_exact(expected).map(body);
        let mut people = people.collect::<Result<Vec<_>, _>>()?.into_iter();
        let (body, others) = (people.next().flatten(), people.flatten().collect());
        let age = self.stamps.admit(poses.header.stamp, now)?;
        let taken = std::time::Duration::try_from_secs_f64(age)
            .ok()
            .and_then(|age| now.checked_sub(age))
            .unwrap_or(now);
        let holds = |at: SystemTime| {
            now.duration_since(at).map_or(true, |since| since.as_secs_f64() <= ACTION_HOLDS)
        };
        let action = self.action.filter(|(_, at)| holds(*at)).map(|(action, _)| action);
        Ok(SeenPeople { taken, body, others, action })
    }

    /// Takes an action by its name that has come `now`.
    ///
    /// # Errors
    /// A name of none.
    pub fn take_action(&mut self, text: &Text, now: SystemTime) -> Result<(), Refusal> {
        let action =
            Action::from_name(&text.data).map_err(|error| Refusal::Action(error.to_string()))?;
        self.action = Some((RecognisedAction { action, confidence: Confidence::ONE }, now));
        Ok(())
    }
}

/// The body with these joints; none of nobody.
fn body(poses: &[Pose]) -> Result<Option<Body>, Refusal> {
    let mut body = Body::default();
    for (joint, pose) in Body25::ALL.into_iter().zip(poses) {
        let position = Point3::new(pose.position.x, pose.position.y, pose.position.z);
        if position.iter().all(|number| number.is_nan()) {
            continue;
        }
        if !position.iter().all(|number| number.is_finite()) {
            return Err(Refusal::NotFinite { what: "body joints" });
        }
        body.set(joint, Some(Keypoint { position, confidence: Confidence::ONE }));
    }
    Ok(Some(body).filter(|body| body.iter().next().is_some()))
}
