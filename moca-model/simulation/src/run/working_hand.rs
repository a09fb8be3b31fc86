//! The hand of the recorded person who works on the grasped object.

use std::collections::VecDeque;

use ergo_map::Side;
use nalgebra::Vector3;
use simulated_people::{Arm, Joints};
use vision_models::{Body, Body25, Keypoint, Percept};

/// Largest speed of a hand that goes to the object and back, and follows it \[m/s\].
const SPEED: f64 = 1.0;
/// Largest delay of a frame \[s\].
const LATEST: f64 = 1.0;

/// Tolerance of a tick's time for rounding \[s\].
const ROUNDING: f64 = 1e-7;

/// Shoulder, elbow and wrist of the working arm, and the other shoulder.
const ARMS: [[Body25; 4]; 2] = {
    use Body25::{LeftElbow, LeftShoulder, LeftWrist, RightElbow, RightShoulder, RightWrist};
    [
        [LeftShoulder, LeftElbow, LeftWrist, RightShoulder],
        [RightShoulder, RightElbow, RightWrist, LeftShoulder],
    ]
};

/// Moves the working hand of a recorded person to the object of the simulated robot, which the recording does not know.
/// It stays there while they work on it and their arm reaches it.
#[derive(Debug)]
pub(super) struct WorkingHand {
    arm: Arm,
    joints: [Body25; 4],
    /// Last recorded place of the hand \[m, world\].
    recorded: Option<Vector3<f64>>,
    /// Present place; `None` if it is the recorded one.
    place: Option<Vector3<f64>>,
    /// Earlier places, and their times \[m, s\].
    past: VecDeque<(f64, Option<Vector3<f64>>)>,
}

impl WorkingHand {
    /// Creates the hand of a person of this stature \[m\].
    pub(super) fn new(stature: f64, side: Side) -> Self {
        let [left, right] = ARMS;
        Self {
            arm: Arm::of_stature(stature),
            joints: match side {
                Side::Left => left,
                Side::Right => right,
            },
            recorded: None,
            place: None,
            past: VecDeque::new(),
        }
    }

    /// Advances to `time` by `period` \[s\], towards the object that the person works on \[m, world\] or back to the
    /// recorded place.
    pub(super) fn advance(&mut self, time: f64, period: f64, object: Option<Vector3<f64>>) {
        if let (Some(goal), Some(from)) = (object.or(self.recorded), self.place.or(self.recorded)) {
            let place = from + (goal - from).cap_magnitude(SPEED * period);
            let is_back = object.is_none() && place == goal;
            self.place = Some(place).filter(|_| !is_back);
        }
        self.past.push_back((time, self.place));
        while self.past.front().is_some_and(|(past, _)| time - past > LATEST) {
            self.past.pop_front();
        }
    }

    /// Takes the joints of the person, whose recorded hand is there \[m, world\].
    pub(super) fn follow(&mut self, joints: &Joints) {
        let [_, elbow, wrist, _] = self.joints.map(|joint| joints[joint.index()].coords);
        self.recorded = Some(self.arm.grip(&elbow, &wrist));
    }

    /// The joints of a person with the hand at its place at a time \[m, world, s\].
    pub(super) fn bend(&self, time: f64, mut joints: Joints) -> Joints {
        if let Some(place) = self.place_at(time) {
            let [shoulder, elbow, wrist, other] = self.joints.map(Body25::index);
            let arm = self.arm_to(&place, &joints[shoulder].coords, &joints[other].coords);
            [joints[elbow], joints[wrist]] = arm.map(Into::into);
        }
        joints
    }

    /// The percept of a person with the hand at its place.
    pub(super) fn show(&mut self, percept: &Percept) -> Percept {
        let mut shown = percept.clone();
        let Some(body) = &mut shown.body else { return shown };
        let [shoulder, elbow, wrist, other] = self.joints.map(|joint| body.get(joint));
        let (Some(elbow), Some(wrist)) = (elbow, wrist) else { return shown };
        self.recorded = Some(self.arm.grip(&elbow.position.coords, &wrist.position.coords));
        let place = self.place_at(percept.time);
        if let (Some(place), Some(shoulder), Some(other)) = (place, shoulder, other) {
            let arm = self.arm_to(&place, &shoulder.position.coords, &other.position.coords);
            self.show_arm(body, [elbow, wrist], arm);
        }
        shown
    }

    /// The place of the hand at a time \[m, s\]; `None` if it is the recorded one.
    fn place_at(&self, time: f64) -> Option<Vector3<f64>> {
        let there = |(past, _): &&(f64, _)| *past <= time + ROUNDING;
        self.past.iter().rev().find(there).and_then(|(_, place)| *place)
    }

    /// Elbow and wrist of an arm whose hand is at `place` \[m, world\]. The elbow is down and away from the body.
    fn arm_to(
        &self,
        place: &Vector3<f64>,
        shoulder: &Vector3<f64>,
        other: &Vector3<f64>,
    ) -> [Vector3<f64>; 2] {
        let outwards = (shoulder - other).try_normalize(1e-9).unwrap_or_default();
        let aside = outwards * 0.4 - Vector3::z();
        self.arm.leading_to(place, shoulder, &aside)
    }

    /// Sets elbow and wrist to these places, with the confidence that they have.
    fn show_arm(&self, body: &mut Body, seen: [Keypoint; 2], joints: [Vector3<f64>; 2]) {
        let [_, elbow, wrist, _] = self.joints;
        for ((joint, seen), place) in [elbow, wrist].into_iter().zip(seen).zip(joints) {
            body.set(joint, Some(Keypoint { position: place.into(), ..seen }));
        }
    }
}

#[cfg(test)]
mod tests {
    use simulated_people::{CameraSettings, Walker, WalkerSettings};

    use super::*;

    const PERIOD: f64 = 1e-3;

    /// A percept of a person whose arms are seen.
    fn percept() -> Percept {
        let seen = |percept: &Percept| {
            let body = percept.body.as_ref();
            body.is_some_and(|body| {
                ARMS.as_flattened().iter().all(|&joint| body.get(joint).is_some())
            })
        };
        let camera = CameraSettings::PERFECT;
        let settings = WalkerSettings { camera, ..WalkerSettings::default() };
        Walker::new(settings).unwrap().find(seen).unwrap()
    }

    fn grip(percept: &Percept, arm: &Arm) -> Vector3<f64> {
        let body = percept.body.as_ref().unwrap();
        let at = |joint| body.get(joint).unwrap().position.coords;
        arm.grip(&at(Body25::RightElbow), &at(Body25::RightWrist))
    }

    #[test]
    fn the_hand_goes_to_the_object_and_back() {
        let (percept, mut hand) = (percept(), WorkingHand::new(1.75, Side::Right));
        assert_eq!(hand.show(&percept), percept);
        let arm = Arm::of_stature(1.75);
        let body = percept.body.as_ref().unwrap();
        let shoulder = body.get(Body25::RightShoulder).unwrap().position.coords;
        let object = shoulder + Vector3::new(-0.4, 0.1, -0.3);
        let mut time = percept.time;
        let mut go = |hand: &mut WorkingHand, object, seconds: f64| {
            let end = time + seconds;
            while time < end {
                time += PERIOD;
                hand.advance(time, PERIOD, object);
            }
            hand.show(&Percept { time, ..percept.clone() })
        };
        let from = grip(&percept, &arm);
        let begun = go(&mut hand, Some(object), 0.05);
        assert!((grip(&begun, &arm) - from).norm() <= SPEED * 0.052);
        let there = go(&mut hand, Some(object), 2.0);
        assert!((grip(&there, &arm) - object).norm() < 1e-9);
        // Frames show the hand where it was when they were taken.
        let late = Percept { time: there.time, ..percept.clone() };
        go(&mut hand, None, 0.2);
        assert_eq!(hand.show(&late).body, there.body);
        let back = go(&mut hand, None, 2.0);
        assert_eq!(back.body, percept.body);
    }

    #[test]
    fn what_is_not_seen_stays_unseen() {
        let (mut percept, mut hand) = (percept(), WorkingHand::new(1.75, Side::Right));
        hand.show(&percept);
        percept.time += 1.0;
        hand.advance(percept.time, PERIOD, Some(Vector3::new(0.5, 0.0, 1.0)));
        percept.body.as_mut().unwrap().set(Body25::RightWrist, None);
        assert_eq!(hand.show(&percept), percept);
    }
}
