//! From body joints and actions to percepts.

use std::time::SystemTime;

use nalgebra::Point3;
use vision_models::{Action, Body, Body25, Confidence, Keypoint, RecognisedAction};

use super::WORLD_FRAME;
use super::measurements::check_frame;
use super::messages::{PoseArray, Text};
use super::refusal::Refusal;
use super::stamps::Stamps;

/// For how long an action holds after it was published \[s\].
const ACTION_HOLDS: f64 = 1.0;

/// A person as somebody else's camera has seen them.
#[derive(Clone, Debug, PartialEq)]
pub struct SeenPerson {
    /// When the camera took the frame.
    pub taken: SystemTime,
    /// In the frame of the odometry.
    pub body: Body,
    /// What they do, if that was published within the last second.
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
    /// odometry. A joint that was not seen has three NaN. Orientations mean nothing.
    ///
    /// # Errors
    /// Why they are refused.
    pub fn take_body(&mut self, poses: &PoseArray, now: SystemTime) -> Result<SeenPerson, Refusal> {
        check_frame(&poses.header.frame_id, WORLD_FRAME)?;
        let (found, expected) = (poses.poses.len(), Body25::COUNT);
        if found != expected {
            return Err(Refusal::Size { what: "body joints", found, expected });
        }
        let mut body = Body::default();
        for (joint, pose) in Body25::ALL.into_iter().zip(&poses.poses) {
            let position = Point3::new(pose.position.x, pose.position.y, pose.position.z);
            if position.iter().all(|number| number.is_nan()) {
                continue;
            }
            if !position.iter().all(|number| number.is_finite()) {
                return Err(Refusal::NotFinite { what: "body joints" });
            }
            body.set(joint, Some(Keypoint { position, confidence: Confidence::ONE }));
        }
        let age = self.stamps.admit(poses.header.stamp, now)?;
        let taken = std::time::Duration::try_from_secs_f64(age)
            .ok()
            .and_then(|age| now.checked_sub(age))
            .unwrap_or(now);
        let holds = |at: SystemTime| {
            now.duration_since(at).map_or(true, |since| since.as_secs_f64() <= ACTION_HOLDS)
        };
        let action = self.action.filter(|(_, at)| holds(*at)).map(|(action, _)| action);
        Ok(SeenPerson { taken, body, action })
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
