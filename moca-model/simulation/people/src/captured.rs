//! Motions of real people, measured joint by joint, that simulated people repeat.

use std::f64::consts::{PI, TAU};
use std::io::BufRead;
use std::path::Path;
use std::sync::Arc;

use nalgebra::{Isometry3, Point2, Point3, Translation3, UnitQuaternion, Vector2, Vector3};
use percept_recording::{IfPartial, Reader, Recording};
use vision_models::Body25::{
    LeftAnkle, LeftHip, LeftShoulder, MidHip, Nose, RightAnkle, RightHip, RightShoulder,
};
use vision_models::{Body, Body25};

use super::person::Joints;
use crate::Error;

/// Motions that are built in, with their names.
const BUILT_IN: [(&str, &str); 5] = [
    ("walk", include_str!("../motions/walk.jsonl")),
    ("balance", include_str!("../motions/balance.jsonl")),
    ("punch", include_str!("../motions/punch.jsonl")),
    ("dance", include_str!("../motions/dance.jsonl")),
    ("get-up", include_str!("../motions/get-up.jsonl")),
];

/// The measured motion of a real person.
///
/// It is played to and fro without end, slower towards both ends, and at most at the person's own speed. Joints that
/// some frames do not show move evenly from where they were seen to where they are seen again.
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
    pub const NAMES: [&str; 5] = {
        let [(a, _), (b, _), (c, _), (d, _), (e, _)] = BUILT_IN;
        [a, b, c, d, e]
    };

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
        let recording = percept_recording::open(path).map_err(fail)?;
        Self::new(&Recording::read(recording, IfPartial::Refuse).map_err(fail)?)
    }

    fn read(text: impl BufRead, path: &Path) -> Result<Self, Error> {
        let fail = |source| Error::MotionFile { path: path.to_owned(), source };
        let reader = Reader::new(text).map_err(fail)?;
        Self::new(&Recording::read(reader, IfPartial::Refuse).map_err(fail)?)
    }

    /// Takes the person of a recording, where they are.
    ///
    /// # Errors
    /// [`Error::Motion`] if the recording has no stature, fewer than two frames with a person, or never shows a joint
    /// of trunk, limbs or nose.
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
            let found = format!("it has {} frames with a person", seen.len());
            return Err(unfit(found, "give at least 2"));
        };
        if last <= first {
            return Err(unfit("its frames have the same time".into(), "give a motion that lasts"));
        }
        let times: Vec<_> = seen.iter().map(|(time, _)| time - first).collect();
        let mut frames = vec![[Point3::origin(); Body25::COUNT]; seen.len()];
        for joint in Body25::ALL {
            // What a detector never sees of face and feet is where the nearest joint is.
            let places = between(&seen, joint).or_else(|| between(&seen, nearest(joint)?));
            let Some(places) = places else {
                let found = format!("no frame shows the {}", joint.name());
                return Err(unfit(found, "give one that shows trunk, limbs and nose"));
            };
            for (frame, place) in frames.iter_mut().zip(places) {
                if let Some(slot) = frame.get_mut(joint.index()) {
                    *slot = place;
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

/// A joint in every frame; evenly from where it was seen to where it is seen again, and before and after as there.
/// `None` if no frame shows it.
fn between(seen: &[(f64, &Body)], joint: Body25) -> Option<Vec<Point3<f64>>> {
    let shown: Vec<_> =
        seen.iter().filter_map(|(time, body)| Some((*time, body.get(joint)?.position))).collect();
    let (first, last) = (shown.first()?, shown.last()?);
    let places = seen.iter().map(|(time, _)| {
        let next = shown.partition_point(|(at, _)| at <= time);
        let before = next.checked_sub(1).and_then(|index| shown.get(index)).unwrap_or(first);
        let after = shown.get(next).unwrap_or(last);
        let span = after.0 - before.0;
        let share = if span > 0.0 { (time - before.0) / span } else { 0.0 };
        before.1 + (after.1 - before.1) * share
    });
    Some(places.collect())
}

/// The joint of the limbs that is nearest to one of face or feet; `None` for one that is needed itself.
fn nearest(joint: Body25) -> Option<Body25> {
    use Body25::{
        LeftBigToe, LeftEar, LeftEye, LeftHeel, LeftSmallToe, RightBigToe, RightEar, RightEye,
        RightHeel, RightSmallToe,
    };
    match joint {
        LeftBigToe | LeftSmallToe | LeftHeel => Some(LeftAnkle),
        RightBigToe | RightSmallToe | RightHeel => Some(RightAnkle),
        LeftEye | RightEye | LeftEar | RightEar => Some(Nose),
        _ => None,
    }
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
        let turn = (towards.y.atan2(towards.x) - heading + PI).rem_euclid(TAU) - PI;
        (pelvis(&joints), heading + turn)
    }
}

#[cfg(test)]
mod tests {
    use percept_recording::{Header, Writer};
    use vision_models::Body25::{LeftKnee, LeftWrist};
    use vision_models::{Confidence, Keypoint, Percept};

    use super::*;

    fn motions() -> impl Iterator<Item = CapturedMotion> {
        CapturedMotion::NAMES.into_iter().map(|name| CapturedMotion::named(name).unwrap())
    }

    /// A recording of these frames, which are 0.1 s apart.
    fn recording(frames: &[Option<Body>], stature: Option<f64>) -> Recording {
        let mut writer = Writer::new(Vec::new(), &Header { stature, ..Header::default() }).unwrap();
        for (frame, body) in (0_u32..).zip(frames) {
            let time = 0.1 * f64::from(frame);
            let percept = Percept { time, body: body.clone(), action: None, surface: None };
            writer.write(&percept).unwrap();
        }
        let bytes = writer.finish().unwrap();
        Recording::read(Reader::new(&bytes[..]).unwrap(), IfPartial::Refuse).unwrap()
    }

    /// A body whose joints are in a column at `x` \[m\], but for some that are not seen.
    fn column(x: f64, hidden: &[Body25]) -> Body {
        let mut body = Body::default();
        for joint in Body25::ALL.into_iter().filter(|joint| !hidden.contains(joint)) {
            let position = Point3::new(x, 0.0, 0.05 * joint.index() as f64);
            body.set(joint, Some(Keypoint { position, confidence: Confidence::ONE }));
        }
        body
    }

    #[test]
    fn played_no_faster_than_recorded() {
        for motion in motions() {
            let frames = motion.times.windows(2).zip(motion.frames.windows(2));
            let fastest = |joint: usize| {
                let speeds = frames.clone().map(|(times, frames)| {
                    (frames[1][joint] - frames[0][joint]).norm() / (times[1] - times[0])
                });
                speeds.fold(0.0, f64::max)
            };
            let own: [f64; Body25::COUNT] = std::array::from_fn(fastest);
            let (step, mut before) = (1e-3, motion.joints(0.0));
            let mut reached = [0.0_f64; Body25::COUNT];
            let mut time = 0.0;
            while time < motion.cycle() {
                time += step;
                let now = motion.joints(time);
                for ((reached, now), before) in reached.iter_mut().zip(&now).zip(&before) {
                    *reached = reached.max((now - before).norm() / step);
                }
                before = now;
            }
            for (own, reached) in own.into_iter().zip(reached) {
                // A curve through the frames is a little faster than the chords between them.
                assert!(reached <= 1.2 * own + 0.05, "{reached} m/s of {own} m/s");
                assert!(reached > 0.4 * own, "{reached} m/s of {own} m/s");
            }
            let again = motion.joints(motion.cycle());
            for (now, first) in again.iter().zip(&motion.joints(0.0)) {
                assert!((now - first).norm() < 1e-9);
            }
        }
    }

    #[test]
    fn moved_to_a_place_and_heading() {
        let (floor, heading) = (Point2::new(-2.0, 0.7), 2.2);
        for motion in motions() {
            let moved = motion.clone().moved_to(floor, heading);
            let count = moved.frames.len() as f64;
            let mean = moved.frames.iter().map(|frame| pelvis(frame).coords).sum::<Vector2<f64>>();
            assert!((mean / count - floor.coords).norm() < 1e-9);
            let towards: Vector2<f64> = moved.frames.iter().map(forwards).sum();
            assert!((towards.y.atan2(towards.x) - heading).abs() < 1e-9);
            for (before, after) in motion.frames.iter().flatten().zip(moved.frames.iter().flatten())
            {
                assert!((before.z - after.z).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn hidden_joints_are_filled_in() {
        let toe = Body25::LeftBigToe;
        let frames = [
            Some(column(0.0, &[toe])),
            Some(column(5.0, &[toe, LeftKnee])),
            None,
            Some(column(0.3, &[toe])),
        ];
        let motion = CapturedMotion::new(&recording(&frames, Some(1.7))).unwrap();
        assert_eq!(motion.times, [0.0, 0.1, 0.3]);
        let knee = motion.frames[1][LeftKnee.index()];
        assert!((knee.x - 0.1).abs() < 1e-12, "{knee}");
        assert_eq!(motion.frames[1][toe.index()], motion.frames[1][LeftAnkle.index()]);
        assert_eq!(motion.at(0.1), motion.frames[1]);
        assert!((motion.duration() - 0.3).abs() < 1e-12);
    }

    #[test]
    fn unfit_recordings_say_what_is_missing() {
        let whole = || Some(column(0.0, &[]));
        let refused = |frames: &[Option<Body>], stature| {
            CapturedMotion::new(&recording(frames, stature)).unwrap_err().to_string()
        };
        let says = refused(&[whole(), whole()], None);
        assert!(says.contains("how tall"), "{says}");
        let says = refused(&[whole(), None], Some(1.7));
        assert!(says.contains("1 frames with a person; give at least 2"), "{says}");
        let no_wrist = || Some(column(0.0, &[LeftWrist]));
        let says = refused(&[no_wrist(), no_wrist()], Some(1.7));
        assert!(says.contains("left wrist"), "{says}");
        let says = CapturedMotion::from_argument("fly").unwrap_err().to_string();
        assert_eq!(
            says,
            "motion \"fly\": give walk, balance, punch, dance, get-up, or a recording of a person"
        );
        let says = CapturedMotion::from_argument("Cargo.toml").unwrap_err().to_string();
        assert!(says.starts_with("Cargo.toml: "), "{says}");
    }
}
