//! A simulated person as they truly are.

use vision_models::Body25;

use super::working_hand::WorkingHand;
use crate::separation::{Moment, body};
use crate::simulation::Joints;

/// A part that moves faster than this between two ticks has jumped \[m/s\]: the hand that goes to the object bends
/// the arm at once, and a jump has no speed.
const FASTEST: f64 = 10.0;

/// Where the joints of a simulated person truly are, camera frame by camera frame, in the order of time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TrueMotion {
    /// Time and joints in the world \[s, m\].
    frames: Vec<(f64, Joints)>,
}

impl TrueMotion {
    /// Adds where the joints are at a time that is later than all before \[m, s\].
    pub fn push(&mut self, time: f64, joints: Joints) {
        self.frames.push((time, joints));
    }

    /// Where they are at a time \[s\]: even from frame to frame, and standing before the first and after the last;
    /// none if nothing is known.
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

/// Joints at a time, and a period before; none after a jump.
type Moving = (Joints, Option<Joints>);

/// A simulated person with their hand at the object, for the judge of distances.
#[derive(Debug)]
pub(super) struct TruePerson<'a> {
    motion: &'a TrueMotion,
    period: f64,
    now: Option<Moving>,
    /// When the newest frame was taken that shows them.
    known: Option<Moving>,
}

impl<'a> TruePerson<'a> {
    /// One who moves so; ticks are `period` \[s\] apart.
    pub(super) fn new(motion: &'a TrueMotion, period: f64) -> Self {
        Self { motion, period, now: None, known: None }
    }

    /// A frame that shows them has arrived.
    pub(super) fn show(&mut self, taken: f64, hand: &WorkingHand) {
        self.known = self.moving(taken, hand);
    }

    /// Goes on to the tick at `time` \[s\].
    pub(super) fn advance(&mut self, time: f64, hand: &WorkingHand) {
        self.now = self.moving(time, hand);
    }

    /// The tick, for the judge; `contact` says whether all but the head may touch the robot.
    pub(super) fn moment(&self, contact: bool) -> Option<Moment<'_>> {
        let person = moving_parts(self.now.as_ref()?);
        Some(Moment { person, known: self.known.as_ref().map(moving_parts), contact })
    }

    fn moving(&self, time: f64, hand: &WorkingHand) -> Option<Moving> {
        let joints = |time: f64| Some(hand.bend(time, self.motion.at(time)?));
        let (now, before) = (joints(time)?, joints(time - self.period)?);
        let most = FASTEST * self.period;
        let jumped = body::joints()
            .any(|joint: Body25| (now[joint.index()] - before[joint.index()]).norm() > most);
        Some((now, (!jumped).then_some(before)))
    }
}

fn moving_parts((now, before): &Moving) -> (&Joints, Option<&Joints>) {
    (now, before.as_ref())
}

#[cfg(test)]
mod tests {
    use nalgebra::Point3;

    use super::*;

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
}
