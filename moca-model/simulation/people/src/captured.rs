//! Motions of real people, measured joint by joint, that simulated people repeat.

use std::f64::consts::{PI, TAU};
use std::io::BufRead;
use std::path::Path;
use std::sync::Arc;

use nalgebra::{Isometry3, Point2, Point3, Translation3, UnitQuaternion, Vector2, Vector3};
use percept_recording::{IfPartial, Reader, Recording, RecordingError};
use vision_models::Body25::{
    LeftAnkle, LeftHip, LeftShoulder, MidHip, Nose, RightAnkle, RightHip, RightShoulder,
};
use vision_models::{Body, Body25};

use super::built_in::{BUILT_IN, NAMES};
use super::joints::Joints;
use crate::error::Error;

/// Joints of less confidence count as hidden.
const CERTAIN: f64 = 0.5;
/// The longest time for which a joint of trunk or limbs may be hidden, and the shortest motion \[s\].
const LONGEST_GAP: f64 = 1.0;
const SHORTEST: f64 = 0.2;
/// The person faces nowhere if shoulders and hips are nearer to each other along the floor \[m\].
const FACING: f64 = 0.02;

/// The measured motion of a real person.
///
/// It is played to and fro without end: forwards, then backwards in time. It is slower towards both ends, and at most as
/// fast as the person was. A joint that some frames do not surely show moves along with the pelvis, from where it was seen
/// to where it is seen again.
///
/// ```
/// use simulated_people::CapturedMotion;
///
/// let walk = CapturedMotion::named("walk")?;
/// assert_eq!(walk.stature(), 1.62);
/// assert!(walk.duration() > 1.2);
/// assert!(CapturedMotion::named("fly").is_err());
/// # Ok::<(), simulated_people::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct CapturedMotion {
    stature: f64,
    /// Times of the frames since the first \[s\], at least two.
    times: Vec<f64>,
    frames: Vec<Joints>,
    /// Speed of play, as a share of the person's own.
    pace: f64,
}

impl CapturedMotion {
    /// Names of the motions that are built in: gait, balancing on a beam, punches, dancing, and getting up from the floor.
    pub const NAMES: [&str; 5] = NAMES;

    /// Returns a motion that is built in.
    ///
    /// # Errors
    /// [`Error::MotionName`] for another name.
    pub fn named(name: &str) -> Result<Self, Error> {
        let found = BUILT_IN.iter().find(|(known, _)| *known == name);
        let (_, text) = found.ok_or_else(|| Error::MotionName { name: name.to_owned() })?;
        Self::read(text.as_bytes(), Path::new(name))
    }

    /// Returns a motion from the command line: a name, or a recording of a person.
    ///
    /// # Errors
    /// [`Error::MotionName`] if it is neither, [`Error::MotionFile`] for a file that cannot be read,
    /// [`Error::Motion`] as [`new`](Self::new).
    pub fn from_argument(argument: &str) -> Result<Self, Error> {
        let path = Path::new(argument);
        if Self::NAMES.contains(&argument) || !path.exists() {
            return Self::named(argument);
        }
        let fail = |source| Error::MotionFile { path: path.to_owned(), source };
        let reader = percept_recording::open(path).map_err(|error| match error {
            // The error already contains the file's name.
            RecordingError::Open { .. } => Error::Open(error),
            error => fail(error),
        })?;
        Self::new(&Recording::read(reader, IfPartial::Refuse).map_err(fail)?)
    }

    fn read(text: impl BufRead, path: &Path) -> Result<Self, Error> {
        let fail = |source| Error::MotionFile { path: path.to_owned(), source };
        let reader = Reader::new(text).map_err(fail)?;
        Self::new(&Recording::read(reader, IfPartial::Refuse).map_err(fail)?)
    }

    /// Takes the person of a recording, where they are. The joints are taken as they are, so noise of single frames is
    /// motion.
    ///
    /// # Errors
    /// [`Error::Motion`] for a recording without a stature, with fewer than two frames of a person or less than 0.2 s. The
    /// same for times that do not increase. The same for a joint of trunk, limbs or nose that is never seen, or hidden for
    /// more than a second.
    pub fn new(recording: &Recording) -> Result<Self, Error> {
        let unfit = |found: String, wanted| Error::Motion { found, wanted };
        let stature = recording.header.stature.ok_or_else(|| {
            unfit(
                "it does not say how tall the person is".into(),
                "give \"stature\" in its first line",
            )
        })?;
        let seen: Vec<_> = recording
            .percepts
            .iter()
            .filter_map(|percept| Some((percept.time, percept.body.as_ref()?)))
            .collect();
        let ([(first, _), _, ..], [.., (last, _)]) = (&seen[..], &seen[..]) else {
            let found = format!("frames with a person: {}", seen.len());
            return Err(unfit(found, "give at least 2"));
        };
        if !seen.is_sorted_by(|(before, _), (after, _)| before < after) {
            return Err(unfit("the times of its frames do not increase".into(), "sort them"));
        }
        let duration = last - first;
        if !(SHORTEST..f64::INFINITY).contains(&duration) {
            return Err(unfit(format!("it lasts {duration} s"), "give at least 0.2 s"));
        }
        let times: Vec<_> = seen.iter().map(|(time, _)| time - first).collect();
        let mut frames = vec![[Point3::origin(); Body25::COUNT]; seen.len()];
        let mut joints = Body25::ALL;
        joints.sort_by_key(|&joint| Anchor::of(joint).order());
        for joint in joints {
            let anchor = Anchor::of(joint);
            let shown = shown(&seen, joint, frames.iter().map(|frame| anchor.place(frame)));
            if !matches!(anchor, Anchor::Limb(_)) {
                let (wanted, name) = ("give trunk, limbs and nose in every second", joint.name());
                if shown.is_empty() {
                    return Err(unfit(format!("no frame surely shows the {name}"), wanted));
                }
                let hidden = longest_gap(&shown, *first, *last);
                if hidden > LONGEST_GAP {
                    return Err(unfit(format!("the {name} is hidden for {hidden:.2} s"), wanted));
                }
            }
            for (frame, (time, _)) in frames.iter_mut().zip(&seen) {
                let at = anchor.place(frame) + between(&shown, *time);
                if let Some(slot) = frame.get_mut(joint.index()) {
                    *slot = at;
                }
            }
        }
        Ok(Self { stature, times, frames, pace: 1.0 })
    }

    /// The same motion elsewhere: the mean place of the pelvis is there \[m\], and so is the mean heading \[rad\].
    #[must_use]
    pub fn moved_to(mut self, floor: Point2<f64>, heading: f64) -> Self {
        let (mut middle, mut towards) = (Vector2::zeros(), Vector2::zeros());
        for frame in &self.frames {
            middle += pelvis(frame).coords / self.frames.len() as f64;
            towards += forwards(frame);
        }
        let turn = heading - towards.y.atan2(towards.x);
        let rotation = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), turn);
        let away = floor.coords.push(0.0) - rotation * middle.push(0.0);
        let moved = Isometry3::from_parts(Translation3::from(away), rotation);
        for joint in self.frames.iter_mut().flatten() {
            *joint = moved * *joint;
        }
        self
    }

    /// The same motion at a share of its speed, at most 1.
    #[must_use]
    pub fn at_pace(mut self, pace: f64) -> Self {
        self.pace = pace.clamp(0.0, 1.0);
        self
    }

    /// The person's stature \[m\].
    pub fn stature(&self) -> f64 {
        self.stature
    }

    /// Time from the first frame to the last \[s\].
    pub fn duration(&self) -> f64 {
        self.times.last().copied().unwrap_or_default()
    }

    /// Time from the beginning until the person is there again \[s\].
    pub fn cycle(&self) -> f64 {
        PI * self.duration() / self.pace.max(f64::MIN_POSITIVE)
    }

    /// The joints after playing for `time` \[s\].
    pub fn joints(&self, time: f64) -> Joints {
        // Its rate is the pace in the middle, and zero where it turns.
        self.at(0.5 * self.duration() * (1.0 - (TAU * time / self.cycle()).cos()))
    }

    /// The joints at a time of the recording since the first frame \[s\], by cubic Hermite polynomials.
    fn at(&self, time: f64) -> Joints {
        let last = self.times.len().saturating_sub(2);
        let index = self.times.partition_point(|&at| at <= time).saturating_sub(1).min(last);
        let known = |index: usize| {
            let index = index.min(self.times.len().saturating_sub(1));
            self.times.get(index).copied().zip(self.frames.get(index))
        };
        let around = [index.saturating_sub(1), index, index + 1, index + 2].map(known);
        let [Some((ta, a)), Some((tb, b)), Some((tc, c)), Some((td, d))] = around else {
            return [Point3::origin(); Body25::COUNT];
        };
        let span = tc - tb;
        let s = if span > 0.0 { ((time - tb) / span).clamp(0.0, 1.0) } else { 0.0 };
        let mut joints = *b;
        for ((((joint, a), b), c), d) in joints.iter_mut().zip(a).zip(b).zip(c).zip(d) {
            let slope = |from: &Point3<f64>, to: &Point3<f64>, time: f64| {
                if time > 0.0 { (to - from) * (span / time) } else { Vector3::zeros() }
            };
            let (begin, end, way) = (slope(a, c, tc - ta), slope(b, d, td - tb), c - b);
            let (two, three) = (way * 3.0 - begin * 2.0 - end, begin + end - way * 2.0);
            *joint = b + (begin + (two + three * s) * s) * s;
        }
        joints
    }
}

/// What a joint moves with while it is hidden.
#[derive(Clone, Copy, Debug)]
enum Anchor {
    World,
    Pelvis,
    /// The joint that is nearest to one of face or feet, where it is until it is seen.
    Limb(Body25),
}

impl Anchor {
    fn of(joint: Body25) -> Self {
        use Body25::{
            LeftBigToe, LeftEar, LeftEye, LeftHeel, LeftSmallToe, RightBigToe, RightEar, RightEye,
            RightHeel, RightSmallToe,
        };
        match joint {
            MidHip => Self::World,
            LeftBigToe | LeftSmallToe | LeftHeel => Self::Limb(LeftAnkle),
            RightBigToe | RightSmallToe | RightHeel => Self::Limb(RightAnkle),
            LeftEye | RightEye | LeftEar | RightEar => Self::Limb(Nose),
            _ => Self::Pelvis,
        }
    }

    /// Its place in a frame whose joints of lower order are known \[m\].
    fn place(self, frame: &Joints) -> Point3<f64> {
        match self {
            Self::World => Point3::origin(),
            Self::Pelvis => place(frame, MidHip),
            Self::Limb(near) => place(frame, near),
        }
    }

    /// Joints follow what they are anchored to.
    fn order(self) -> u8 {
        match self {
            Self::World => 0,
            Self::Pelvis => 1,
            Self::Limb(_) => 2,
        }
    }
}

/// Times of the frames that surely show a joint, and its displacement from the anchor then \[s, m\].
fn shown(
    seen: &[(f64, &Body)],
    joint: Body25,
    anchors: impl Iterator<Item = Point3<f64>>,
) -> Vec<(f64, Vector3<f64>)> {
    let frames = seen.iter().zip(anchors);
    let shown = frames.filter_map(|((time, body), anchor)| {
        let keypoint = body.get(joint)?;
        let sure = keypoint.confidence.value() >= CERTAIN;
        let offset = keypoint.position - anchor;
        (sure && offset.iter().all(|part| part.is_finite())).then_some((*time, offset))
    });
    shown.collect()
}

/// The longest time between two of these frames, from the first time to the last \[s\].
fn longest_gap(shown: &[(f64, Vector3<f64>)], first: f64, last: f64) -> f64 {
    let times = shown.iter().map(|(time, _)| *time).chain([last]);
    let gaps = times.scan(first, |before, time| Some(time - std::mem::replace(before, time)));
    gaps.fold(0.0, f64::max)
}

/// A displacement at a time: evenly from where it was seen to where it is seen again, before and after as there, and zero
/// where it was never seen.
fn between(shown: &[(f64, Vector3<f64>)], time: f64) -> Vector3<f64> {
    let (Some(first), Some(last)) = (shown.first(), shown.last()) else { return Vector3::zeros() };
    let next = shown.partition_point(|(at, _)| *at <= time);
    let before = next.checked_sub(1).and_then(|index| shown.get(index)).unwrap_or(first);
    let after = shown.get(next).unwrap_or(last);
    let span = after.0 - before.0;
    let share = if span > 0.0 { (time - before.0) / span } else { 0.0 };
    before.1 + (after.1 - before.1) * share
}

fn place(joints: &Joints, joint: Body25) -> Point3<f64> {
    joints.get(joint.index()).copied().unwrap_or_default()
}

/// The point on the floor below the pelvis \[m\].
fn pelvis(joints: &Joints) -> Point2<f64> {
    place(joints, MidHip).xy()
}

/// The direction in which shoulders and hips face, over the floor.
fn forwards(joints: &Joints) -> Vector2<f64> {
    let pairs = [(LeftShoulder, RightShoulder), (LeftHip, RightHip)];
    let left: Vector2<f64> =
        pairs.iter().map(|&(left, right)| (place(joints, left) - place(joints, right)).xy()).sum();
    Vector2::new(left.y, -left.x)
}

/// A motion that is being played.
#[derive(Clone, Debug)]
pub(super) struct Performance {
    motion: Arc<CapturedMotion>,
    /// Time since the beginning \[s\].
    time: f64,
    /// Displacement by jumps \[m\].
    away: Vector2<f64>,
}

impl Performance {
    pub(super) fn new(motion: Arc<CapturedMotion>) -> Self {
        Self { motion, time: 0.0, away: Vector2::zeros() }
    }

    /// Goes on by `dt` \[s\].
    pub(super) fn advance(&mut self, dt: f64) {
        self.time += dt;
    }

    /// Displaces the person at once \[m\].
    pub(super) fn jump(&mut self, displacement: Vector2<f64>) {
        self.away += displacement;
    }

    /// Joints in the world \[m\].
    pub(super) fn joints(&self) -> Joints {
        let away = self.away.push(0.0);
        self.motion.joints(self.time).map(|joint| joint + away)
    }

    /// The point on the floor below the pelvis \[m\], and the heading \[rad\] that is nearest to `heading`.
    pub(super) fn place(&self, heading: f64) -> (Point2<f64>, f64) {
        let joints = self.joints();
        let towards = forwards(&joints);
        if towards.norm() < FACING {
            return (pelvis(&joints), heading);
        }
        let turn = (towards.y.atan2(towards.x) - heading + PI).rem_euclid(TAU) - PI;
        (pelvis(&joints), heading + turn)
    }
}

#[cfg(test)]
mod tests;
