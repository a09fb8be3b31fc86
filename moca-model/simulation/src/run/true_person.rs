//! The true motion of a simulated person.

use std::path::Path;

use percept_recording::{IfPartial, Recording, RecordingError};
use simulated_people::Joints;
use vision_models::{Body25, Percept};

use super::working_hand::WorkingHand;
use crate::error::Error;
use crate::judges::{Moment, body};

/// Longest time between frames of a truth \[s\]: 50 Hz, and rounding of times.
const LONGEST: f64 = 0.02 + 2e-6;

/// Speed above which a joint has jumped between two ticks \[m/s\]. The hand that goes to the object bends the arm at
/// once, and a jump has no speed.
const FASTEST: f64 = 10.0;

/// The true joints of a simulated person, camera frame by camera frame, in the order of time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TrueMotion {
    /// Time and joints in the world \[s, m\].
    frames: Vec<(f64, Joints)>,
}

impl TrueMotion {
    /// Reads the motion from a recording of the truth: percepts with every joint where it truly is.
    ///
    /// # Errors
    /// The file, if it cannot be read, has frames farther apart than 20 ms, or lacks a joint that distances are
    /// measured from.
    pub fn read(path: &Path) -> Result<Self, Error> {
        let of_file =
            |source: Error| Error::File { path: path.to_owned(), source: Box::new(source) };
        let reader = percept_recording::open(path).map_err(|error| match error {
            // The error already contains the file's name.
            RecordingError::Open { .. } => error.into(),
            error => of_file(error.into()),
        })?;
        let recording = Recording::read(reader, IfPartial::Refuse);
        let percepts = recording.map_err(|error| of_file(error.into()))?.percepts;
        Self::of(&percepts).map_err(of_file)
    }

    fn of(percepts: &[Percept]) -> Result<Self, Error> {
        let unfit = |found: String, wanted| Err(Error::Unfit { found, wanted });
        if percepts.is_empty() {
            return unfit("no frame".to_owned(), "give where the joints truly are");
        }
        let mut motion = Self::default();
        for percept in percepts {
            let time = percept.time;
            if let Some((before, _)) = motion.frames.last()
                && time - before > LONGEST
            {
                let found = format!("no frame from {before} to {time} s");
                return unfit(found, "give true joints at 50 Hz or more");
            }
            let seen = percept.body.clone().unwrap_or_default();
            for joint in body::joints() {
                if seen.get(joint).is_none() {
                    let found = format!("no {} at {time} s", joint.name());
                    return unfit(found, "give all true joints");
                }
            }
            // Other joints are not needed.
            let place = |joint| seen.get(joint).map_or_else(Default::default, |seen| seen.position);
            motion.push(time, Body25::ALL.map(place));
        }
        Ok(motion)
    }

    /// Adds the joints at a time after all earlier ones \[m, s\].
    pub fn push(&mut self, time: f64, joints: Joints) {
        self.frames.push((time, joints));
    }

    /// The joints at a time \[s\]; `None` if nothing is known. They are interpolated between frames, and stand before
    /// the first and after the last one.
    pub fn at(&self, time: f64) -> Option<Joints> {
        let next = self.frames.partition_point(|(frame, _)| *frame <= time);
        let before = next.checked_sub(1).and_then(|before| self.frames.get(before));
        match (before, self.frames.get(next)) {
            (Some((t0, from)), Some((t1, to))) => {
                let share = (time - t0) / (t1 - t0);
                let joint = |joint: usize| from[joint] + (to[joint] - from[joint]) * share;
                Some(std::array::from_fn(joint))
            }
            (Some((_, joints)), None) | (None, Some((_, joints))) => Some(*joints),
            (None, None) => None,
        }
    }
}

/// Joints at a time and a period before; the same for joints that jumped.
type Moving = (Joints, Joints);

/// A simulated person with their hand at the object, for the judge of distances.
#[derive(Debug)]
pub(super) struct TruePerson<'a> {
    motion: &'a TrueMotion,
    period: f64,
    now: Option<Moving>,
    /// Joints when the newest frame that shows them was taken.
    known: Option<Moving>,
}

impl<'a> TruePerson<'a> {
    /// Creates a person with this motion. Ticks are `period` \[s\] apart.
    pub(super) fn new(motion: &'a TrueMotion, period: f64) -> Self {
        Self { motion, period, now: None, known: None }
    }

    /// Takes a frame that shows the person and has arrived.
    pub(super) fn show(&mut self, taken: f64, hand: &WorkingHand) {
        self.known = self.moving(taken, hand);
    }

    /// Advances to the tick at `time` \[s\].
    pub(super) fn advance(&mut self, time: f64, hand: &WorkingHand) {
        self.now = self.moving(time, hand);
    }

    /// The tick for the judge. `contact` says whether all parts except the head may touch the robot.
    pub(super) fn moment(&self, contact: bool) -> Option<Moment<'_>> {
        let person = moving_parts(self.now.as_ref()?);
        Some(Moment { person, known: self.known.as_ref().map(moving_parts), contact })
    }

    fn moving(&self, time: f64, hand: &WorkingHand) -> Option<Moving> {
        let joints = |time: f64| Some(hand.bend(time, self.motion.at(time)?));
        let (now, before) = (joints(time)?, joints(time - self.period)?);
        let most = FASTEST * self.period;
        let from = |joint: usize| {
            let jumped = (now[joint] - before[joint]).norm() > most;
            if jumped { now[joint] } else { before[joint] }
        };
        Some((now, std::array::from_fn(from)))
    }
}

fn moving_parts((now, before): &Moving) -> (&Joints, Option<&Joints>) {
    (now, Some(before))
}

#[cfg(test)]
mod tests {
    use ergo_map::Side;
    use nalgebra::{Point3, Vector3};
    use vision_models::Body25;

    use super::*;

    const PERIOD: f64 = 1e-3;

    #[test]
    fn joints_move_evenly_from_frame_to_frame() {
        let at = |x: f64| [Point3::new(x, 0.0, 1.0); Body25::COUNT];
        let mut motion = TrueMotion::default();
        assert_eq!(motion.at(0.0), None);
        motion.push(1.0, at(0.0));
        motion.push(1.5, at(0.2));
        motion.push(2.0, at(0.2));
        for (time, x) in [(0.0, 0.0), (1.0, 0.0), (1.25, 0.1), (1.5, 0.2), (1.7, 0.2), (9.0, 0.2)] {
            let joints = motion.at(time).unwrap();
            assert!(joints.iter().all(|joint| (joint.x - x).abs() < 1e-12), "{time}");
        }
    }

    /// A person who walks along y at 0.5 m/s, with an arm that is not stretched.
    fn walk() -> TrueMotion {
        let mut motion = TrueMotion::default();
        for frame in 0..100 {
            let time = 0.05 * f64::from(frame);
            let mut joints = [Point3::new(1.0, 0.5 * time, 1.0); Body25::COUNT];
            for (joint, [x, y, z]) in [
                (Body25::LeftShoulder, [0.0, -0.2, 0.4]),
                (Body25::RightShoulder, [0.0, 0.2, 0.4]),
                (Body25::RightElbow, [0.0, 0.25, 0.1]),
                (Body25::RightWrist, [-0.2, 0.2, 0.1]),
            ] {
                joints[joint.index()] += Vector3::new(x, y, z);
            }
            motion.push(time, joints);
        }
        motion
    }

    fn speed((now, before): &Moving, joint: Body25) -> f64 {
        (now[joint.index()] - before[joint.index()]).norm() / PERIOD
    }

    /// The parts have their true speeds in every tick, also at the times of frames.
    #[test]
    fn person_walking_to_object_has_true_speed() {
        let (motion, mut hand) = (walk(), WorkingHand::new(1.75, Side::Right));
        let mut person = TruePerson::new(&motion, PERIOD);
        assert!(person.moment(false).is_none());
        for tick in 0..3000 {
            let time = PERIOD * f64::from(tick);
            hand.follow(&motion.at(time).unwrap());
            let object = (tick > 1000).then(|| Vector3::new(0.6, 0.3 + 0.4 * time, 1.2));
            hand.advance(time, PERIOD, object);
            person.advance(time, &hand);
            if tick % 50 == 20 {
                person.show(f64::from(tick / 50) * 0.05, &hand);
            }
            if tick < 100 {
                continue;
            }
            for moving in [person.now.as_ref().unwrap(), person.known.as_ref().unwrap()] {
                assert!((speed(moving, Body25::MidHip) - 0.5).abs() < 1e-6, "{tick}");
                // The arm is bent to the object in one tick: it jumps.
                let wrist = speed(moving, Body25::RightWrist);
                assert!(wrist < 1.3, "tick {tick}: {wrist} m/s");
            }
            let wrist = speed(person.now.as_ref().unwrap(), Body25::RightWrist);
            assert!(tick < 2500 || (wrist - 0.4).abs() < 0.1, "tick {tick}: {wrist} m/s");
        }
    }
}
