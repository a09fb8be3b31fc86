//! Conversion of body joints and actions to percepts.

use std::time::SystemTime;

use nalgebra::{Matrix3, Point3};
use vision_models::{
    Action, Body, Body25, Confidence, Keypoint, PersonId, RecognisedAction, RecognisedSurface,
    Surface,
};

use super::frame_tree::FrameTree;
use super::messages::{Float64MultiArray, Pose, PoseArray, Text, TfMessage, Time};
use super::people_messages::COVARIANCE;
use super::refusal::Refusal;
use super::stamps::Stamps;

/// Time for which a published action or surface stays valid \[s\].
const HOLDS: f64 = 1.0;

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
    /// Surface of the object that faces the on-board camera, if it was published within the last second.
    pub surface: Option<RecognisedSurface>,
}

/// Combines body joints, their confidences and covariances, actions and surfaces.
#[derive(Clone, Debug)]
pub struct Perceived {
    stamps: Stamps,
    /// Confidences of the joints of the bodies with this stamp, and the ids of these people.
    confidences: Option<(Time, Vec<Confidence>, Vec<Option<PersonId>>)>,
    /// Covariances of the joints of the body with this stamp: xx, xy, xz, yy, yz, zz \[m²\].
    covariances: Option<(Time, Vec<[f64; COVARIANCE]>)>,
    action: Option<(RecognisedAction, SystemTime)>,
    surface: Option<(RecognisedSurface, SystemTime)>,
    frames: FrameTree,
}

impl Default for Perceived {
    fn default() -> Self {
        Self {
            stamps: Stamps::of_camera(),
            confidences: None,
            covariances: None,
            action: None,
            surface: None,
            frames: FrameTree::default(),
        }
    }
}

impl Perceived {
    /// Takes body joints that came at time `now`: a pose for each of [`Body25::ALL`], in this order, in the frame of
    /// the odometry or in one that transforms tie to it. A joint that was not seen has three NaN. Orientations have no meaning. Further groups of the same
    /// length belong to other people.
    ///
    /// The confidences and covariances of the joints are those that came before with the same stamp. If confidences are
    /// missing, the positions of the joints are uncertain. The robot then keeps away from these people and ignores their actions, so it works
    /// with nobody and touches nobody.
    ///
    /// # Errors
    /// Why the joints are refused.
    pub fn take_body(&mut self, poses: &PoseArray, now: SystemTime) -> Result<SeenPeople, Refusal> {
        let odom_from_map = self.frames.odom_from(&poses.header.frame_id, now)?;
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
        let known = self
            .covariances
            .as_ref()
            .filter(|(stamp, of)| *stamp == poses.header.stamp && of.len() == found);
        let covariances: &[[f64; COVARIANCE]] = known.map_or(&[], |(_, of)| of);
        let mut covariances = covariances.chunks(expected);
        let people = poses.poses.chunks_exact(expected);
        let people = people.map(|poses| {
            let (confidences, covariances) =
                (confidences.next().unwrap_or_default(), covariances.next().unwrap_or_default());
            let id = ids.next().flatten();
            let body = body(poses, confidences, covariances);
            let placed = |body: Body| match &odom_from_map {
                Some(motion) => body.transformed(motion),
                None => body,
            };
            body.map(|body| body.map(|body| placed(body).with_id(id)))
        });
        let mut people = people.collect::<Result<Vec<_>, _>>()?.into_iter();
        let (body, others) = (people.next().flatten(), people.flatten().collect());
        let age = self.stamps.admit(poses.header.stamp, now)?;
        let taken = std::time::Duration::try_from_secs_f64(age)
            .ok()
            .and_then(|age| now.checked_sub(age))
            .unwrap_or(now);
        let holds = |at: SystemTime| {
            now.duration_since(at).map_or(true, |since| since.as_secs_f64() <= HOLDS)
        };
        let action = self.action.filter(|(_, at)| sure && holds(*at)).map(|(action, _)| action);
        let surface = self.surface.filter(|(_, at)| holds(*at)).map(|(surface, _)| surface);
        Ok(SeenPeople { taken, body, others, action, surface })
    }

    /// Takes transforms between frames that came at time `now`, for people in the map.
    ///
    /// # Errors
    /// Those of [`FrameTree::take`].
    pub fn take_transforms(&mut self, message: &TfMessage, now: SystemTime) -> Result<(), Refusal> {
        self.frames.take(message, now)
    }

    /// Takes transforms between frames that stay valid, for people in frames that stand in the room.
    ///
    /// # Errors
    /// Those of [`FrameTree::take_static`].
    pub fn take_static_transforms(&mut self, message: &TfMessage) -> Result<(), Refusal> {
        self.frames.take_static(message)
    }

    /// Takes the confidences of body joints: their stamp \[s, ns\], then a number from 0 to 1 for each pose. A source that
    /// tracks people adds the id of each person, NaN for none. They must come before the body joints.
    ///
    /// # Errors
    /// Why the confidences are refused; those before are then kept.
    pub fn take_confidences(&mut self, message: &Float64MultiArray) -> Result<(), Refusal> {
        let what = "body confidences";
        let (stamp, values) = of_stamp(what, message, Body25::COUNT)?;
        let with_id = Body25::COUNT + 1;
        let ids = if values.len() % with_id == 0 { values.len() / with_id } else { 0 };
        let (values, ids) = values.split_at(values.len() - ids);
        check_rows(what, values, Body25::COUNT)?;
        let confidence = |value: &f64| {
            Confidence::new(*value).map_err(|_| Refusal::Confidence { value: *value })
        };
        let values = values.iter().map(confidence).collect::<Result<_, _>>()?;
        let ids = ids.iter().copied().map(id).collect::<Result<_, _>>()?;
        self.confidences = Some((stamp, values, ids));
        Ok(())
    }

    /// Takes the covariances of body joints: their stamp \[s, ns\], then xx, xy, xz, yy, yz, zz \[m²\] for each pose, NaN
    /// where they are unknown. They must come before the body joints.
    ///
    /// # Errors
    /// Why the covariances are refused; those before are then kept.
    pub fn take_covariances(&mut self, message: &Float64MultiArray) -> Result<(), Refusal> {
        let (what, length) = ("body covariances", COVARIANCE * Body25::COUNT);
        let (stamp, values) = of_stamp(what, message, length)?;
        check_rows(what, values, length)?;
        self.covariances = Some((stamp, values.as_chunks().0.to_vec()));
        Ok(())
    }

    /// Takes an action that came at time `now`: its name, and its confidence behind it unless that is 1, as in
    /// `Using The Drill 0.83`.
    ///
    /// # Errors
    /// [`Refusal::Action`] for the name of no action, and [`Refusal::Confidence`].
    pub fn take_action(&mut self, text: &Text, now: SystemTime) -> Result<(), Refusal> {
        let (name, confidence) = named(&text.data)?;
        let action = Action::from_name(name).map_err(|error| Refusal::Action(error.to_string()))?;
        self.action = Some((RecognisedAction { action, confidence }, now));
        Ok(())
    }

    /// Takes a surface that came at time `now`: `drilled` or `smooth`, and its confidence behind it unless that is 1.
    ///
    /// # Errors
    /// [`Refusal::Surface`] for another name, and [`Refusal::Confidence`].
    pub fn take_surface(&mut self, text: &Text, now: SystemTime) -> Result<(), Refusal> {
        let (name, confidence) = named(&text.data)?;
        let surface =
            name.parse::<Surface>().map_err(|error| Refusal::Surface(error.to_string()))?;
        self.surface = Some((RecognisedSurface { surface, confidence }, now));
        Ok(())
    }
}

/// Returns the stamp and the numbers behind it, which are to be rows of this length.
fn of_stamp<'a>(
    what: &'static str,
    message: &'a Float64MultiArray,
    length: usize,
) -> Result<(Time, &'a [f64]), Refusal> {
    let size = Refusal::Size { what, found: message.data.len(), expected: 2 + length };
    let Some(([sec, nanosec], values)) = message.data.split_first_chunk() else { return Err(size) };
    // The conversion saturates: an invalid stamp matches no body.
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "as above")]
    let stamp = Time { sec: *sec as i32, nanosec: *nanosec as u32 };
    Ok((stamp, values))
}

/// Returns an error unless there are rows, all of this length.
fn check_rows(what: &'static str, values: &[f64], length: usize) -> Result<(), Refusal> {
    if values.is_empty() || !values.len().is_multiple_of(length) {
        return Err(Refusal::Size { what, found: 2 + values.len(), expected: 2 + length });
    }
    Ok(())
}

/// Returns the name and the confidence of a text, which is 1 if the text has none.
fn named(text: &str) -> Result<(&str, Confidence), Refusal> {
    let Some((name, number)) = text.rsplit_once(' ') else { return Ok((text, Confidence::ONE)) };
    let Ok(value) = number.parse() else { return Ok((text, Confidence::ONE)) };
    Ok((name, Confidence::new(value).map_err(|_| Refusal::Confidence { value })?))
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
fn body(
    poses: &[Pose],
    confidences: &[Confidence],
    covariances: &[[f64; COVARIANCE]],
) -> Result<Option<Body>, Refusal> {
    let mut body = Body::default();
    let confidences = confidences.iter().copied().chain(std::iter::repeat(Confidence::ONE));
    let unknown = [f64::NAN; COVARIANCE];
    let covariances = covariances.iter().chain(std::iter::repeat(&unknown));
    let joints = Body25::ALL.into_iter().zip(poses).zip(confidences).zip(covariances);
    for (((joint, pose), confidence), [xx, xy, xz, yy, yz, zz]) in joints {
        let position = Point3::new(pose.position.x, pose.position.y, pose.position.z);
        if position.iter().all(|number| number.is_nan()) {
            continue;
        }
        if !position.iter().all(|number| number.is_finite()) {
            return Err(Refusal::NotFinite { what: "body joints" });
        }
        let covariance = Matrix3::new(*xx, *xy, *xz, *xy, *yy, *yz, *xz, *yz, *zz);
        body.set_measured(joint, Keypoint { position, confidence }, covariance);
    }
    Ok(Some(body).filter(|body| body.iter().next().is_some()))
}
