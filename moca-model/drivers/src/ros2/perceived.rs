//! Conversion of body joints and actions to percepts.

use std::time::SystemTime;

use nalgebra::Point3;
use vision_models::{Action, Body, Body25, Confidence, Keypoint, PersonId, RecognisedAction};

use super::WORLD_FRAME;
use super::measurements::check_frame;
use super::messages::{Float64MultiArray, Pose, PoseArray, Text, Time};
use super::refusal::Refusal;
use super::stamps::Stamps;

/// Time for which a published action stays valid \[s\].
const ACTION_HOLDS: f64 = 1.0;

/// People that another program's camera has seen, with ids if it tracks people.
#[derive(Clone, Debug, PartialEq)]
pub struct SeenPeople {
    /// Time at which the camera took the frame.
    pub taken: SystemTime,
    /// Person who works with the robot, in the frame of the odometry; `None` if they are not in view.
    pub body: Option<Body>,
    /// Other people in view, in the frame of the odometry.
    pub others: Vec<Body>,
    /// Action of the person, if it was published within the last second and confidences of their joints came.
    pub action: Option<RecognisedAction>,
}

/// Combines body joints, confidences and actions.
#[derive(Clone, Debug)]
pub struct Perceived {
    stamps: Stamps,
    /// Confidences of the joints of the bodies with this stamp, and the ids of these people.
    confidences: Option<(Time, Vec<Confidence>, Vec<Option<PersonId>>)>,
    action: Option<(RecognisedAction, SystemTime)>,
}

impl Default for Perceived {
    fn default() -> Self {
        Self { stamps: Stamps::of_camera(), confidences: None, action: None }
    }
}

impl Perceived {
    /// Takes body joints that came at time `now`: a pose for each of [`Body25::ALL`], in this order, in the frame of
    /// the odometry. A joint that was not seen has three NaN. Orientations have no meaning. Further groups of the same
    /// length belong to other people.
    ///
    /// The confidences of the joints are those that came before with the same stamp. If they are missing, the positions
    /// of the joints are uncertain. The robot then keeps away from these people and ignores their actions, so it works
    /// with nobody and touches nobody.
    ///
    /// # Errors
    /// Why the joints are refused.
    pub fn take_body(&mut self, poses: &PoseArray, now: SystemTime) -> Result<SeenPeople, Refusal> {
        check_frame(&poses.header.frame_id, WORLD_FRAME)?;
        let (found, expected) = (poses.poses.len(), Body25::COUNT);
        if found == 0 || found % expected != 0 {
            return Err(Refusal::Size { what: "body joints", found, expected });
        }
        let known = self
            .confidences
            .as_ref()
            .filter(|(stamp, of, _)| *stamp == poses.header.stamp && of.len() == found);
        let sure = known.is_some();
        let (confidences, ids): (&[_], &[_]) = known.map_or((&[], &[]), |(_, of, ids)| (of, ids));
        let (mut confidences, mut ids) = (confidences.chunks(expected), ids.iter().copied());
        let people = poses.poses.chunks_exact(expected).map(|poses| {
            let body = body(poses, confidences.next().unwrap_or_default());
            let id = ids.next().flatten();
            body.map(|body| body.map(|body| body.with_id(id)))
        });
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
        let action = self.action.filter(|(_, at)| sure && holds(*at)).map(|(action, _)| action);
        Ok(SeenPeople { taken, body, others, action })
    }

    /// Takes the confidences of body joints: their stamp \[s, ns\], then a number from 0 to 1 for each pose. A source that
    /// tracks people adds the id of each person, NaN for none. They must come before the body joints.
    ///
    /// # Errors
    /// Why the confidences are refused; those before are then kept.
    pub fn take_confidences(&mut self, message: &Float64MultiArray) -> Result<(), Refusal> {
        let (what, found, expected) = ("body confidences", message.data.len(), 2 + Body25::COUNT);
        let size = Refusal::Size { what, found, expected };
        let ([sec, nanosec], values) = message.data.split_first_chunk().ok_or(size.clone())?;
        let with_id = Body25::COUNT + 1;
        let ids = if values.len() % with_id == 0 { values.len() / with_id } else { 0 };
        let (values, ids) = values.split_at(values.len() - ids);
        if values.is_empty() || values.len() % Body25::COUNT != 0 {
            return Err(size);
        }
        let confidence = |value: &f64| {
            Confidence::new(*value).map_err(|_| Refusal::Confidence { value: *value })
        };
        let values = values.iter().map(confidence).collect::<Result<_, _>>()?;
        let ids = ids.iter().copied().map(id).collect::<Result<_, _>>()?;
        // The conversion saturates: an invalid stamp matches no body.
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "as above")]
        let stamp = Time { sec: *sec as i32, nanosec: *nanosec as u32 };
        self.confidences = Some((stamp, values, ids));
        Ok(())
    }

    /// Takes the name of an action that came at time `now`.
    ///
    /// # Errors
    /// [`Refusal::Action`] for the name of no action.
    pub fn take_action(&mut self, text: &Text, now: SystemTime) -> Result<(), Refusal> {
        let action =
            Action::from_name(&text.data).map_err(|error| Refusal::Action(error.to_string()))?;
        self.action = Some((RecognisedAction { action, confidence: Confidence::ONE }, now));
        Ok(())
    }
}

/// Returns the id of a person; `None` for NaN.
fn id(value: f64) -> Result<Option<PersonId>, Refusal> {
    // Doubles hold whole numbers up to 2⁵³.
    let is_whole = (0.0..=9_007_199_254_740_992.0).contains(&value) && value.fract() == 0.0;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "checked above")]
    let id = is_whole.then(|| PersonId::new(value as u64));
    if id.is_some() || value.is_nan() { Ok(id) } else { Err(Refusal::Id { value }) }
}

/// Returns the body with these joints; `None` if no joint was seen. Joints of unknown confidence count as seen.
fn body(poses: &[Pose], confidences: &[Confidence]) -> Result<Option<Body>, Refusal> {
    let mut body = Body::default();
    let confidences = confidences.iter().copied().chain(std::iter::repeat(Confidence::ONE));
    for ((joint, pose), confidence) in Body25::ALL.into_iter().zip(poses).zip(confidences) {
        let position = Point3::new(pose.position.x, pose.position.y, pose.position.z);
        if position.iter().all(|number| number.is_nan()) {
            continue;
        }
        if !position.iter().all(|number| number.is_finite()) {
            return Err(Refusal::NotFinite { what: "body joints" });
        }
        body.set(joint, Some(Keypoint { position, confidence }));
    }
    Ok(Some(body).filter(|body| body.iter().next().is_some()))
}
