//! The body of a person.

use std::sync::Arc;

use nalgebra::{Point2, Point3, Rotation3, Vector2, Vector3};
use rand_chacha::ChaCha8Rng;
use vision_models::{Action, Body25};

use super::activity::Activity;
use super::arm::{Arm, elbow_side};
use super::captured::{CapturedMotion, Performance};
use super::joints::Joints;
use super::motion::{Gait, Goal, Motion};
use super::movement::Movement;
use super::skeleton;

/// A person's place, motion and activity.
#[derive(Clone, Debug)]
pub struct Person {
    stature: f64,
    motion: Motion,
    activity: Activity,
    /// The motion of a real person that they repeat in place of their own.
    performance: Option<Performance>,
}

/// Shoulder, elbow and wrist.
const LEFT_ARM: [Body25; 3] = [Body25::LeftShoulder, Body25::LeftElbow, Body25::LeftWrist];
const RIGHT_ARM: [Body25; 3] = [Body25::RightShoulder, Body25::RightElbow, Body25::RightWrist];
/// Length from the wrist to the fingertips \[m\].
const FINGERTIPS: f64 = 0.15;

/// Largest speed of a part of an arm in a movement on the spot \[m/s\].
const FASTEST_MOVEMENT: f64 = 5.0;

/// Largest rate at which an elbow turns about the line between shoulder and wrist \[rad/s\].
const SWIVEL_RATE: f64 = 4.0;

/// Largest number of times that the step of the hands is halved.
const MOST_HALVINGS: usize = 10;

impl Person {
    /// Creates a standing person of this stature \[m\]; the heading is in radians.
    pub(super) fn standing(
        stature: f64,
        floor: Point2<f64>,
        heading: f64,
        gait: Gait,
        activity: Activity,
    ) -> Self {
        let motion = Motion::starting_at(floor, heading, gait, activity.hands());
        Self { stature, motion, activity, performance: None }
    }

    /// Creates a person who repeats the motion of a real one, whatever their goals.
    pub(super) fn performing(motion: Arc<CapturedMotion>, activity: Activity) -> Self {
        let stature = motion.stature();
        let performance = Performance::new(motion);
        let (floor, heading) = performance.place(0.0);
        let performance = Some(performance);
        Self { performance, ..Self::standing(stature, floor, heading, Gait::NATURAL, activity) }
    }

    /// Moves towards a goal for `dt` \[s\].
    pub(super) fn advance(&mut self, goal: &Goal, activity: Activity, dt: f64) {
        if let Some(performance) = &mut self.performance {
            performance.advance(dt);
            let (floor, heading) = performance.place(self.motion.heading);
            self.motion.be_at(floor, heading, dt);
            self.activity = activity;
            return;
        }
        let (before, bent, hands) = (self.arms(), self.bent_elbows(), self.motion.hands);
        let moving = self.is_busy().then(|| self.motion.moving.clone());
        self.motion.advance(goal, activity.hands(), dt);
        self.activity = activity;
        self.turn_elbows(&bent, dt);
        let speed = self.motion.gait.arm_speed;
        for _ in 0..MOST_HALVINGS {
            if !self.arms_moved_by_more_than(speed * dt, &before) {
                break;
            }
            for (hand, from) in self.motion.hands.iter_mut().zip(hands) {
                *hand = hand.lerp(&from, 0.5);
            }
            self.turn_elbows(&bent, dt);
        }
        // A hand that stretches or folds the arm swings the elbow faster than people do.
        let Some(moving) = moving else { return };
        let mut elapsed = dt;
        for _ in 0..MOST_HALVINGS {
            if !self.arms_moved_by_more_than(speed.max(FASTEST_MOVEMENT) * dt, &before) {
                break;
            }
            elapsed *= 0.5;
            self.motion.moving.clone_from(&moving);
            self.motion.moving.advance(elapsed);
            self.turn_elbows(&bent, dt);
        }
    }

    /// Directions from the line between shoulder and wrist to the left and the right elbow, and these lines, in the
    /// person's frame.
    fn bent_elbows(&self) -> [[Option<Vector3<f64>>; 2]; 2] {
        let joints = self.joints();
        let person_from_world =
            skeleton::world_from_person(self.stature, &self.motion).rotation.inverse();
        [LEFT_ARM, RIGHT_ARM].map(|[shoulder, elbow, wrist]| {
            let shoulder = joints[shoulder.index()];
            let to = |joint: Body25| person_from_world * (joints[joint.index()] - shoulder);
            let axis = to(wrist).try_normalize(1e-9);
            let out = axis.map(|axis| to(elbow) - axis * axis.dot(&to(elbow)));
            [out.and_then(|out| out.try_normalize(1e-9)), axis]
        })
    }

    /// Bends the elbows to the side to which they hang, from where they were `bent`, for `dt` \[s\]. The elbow of a hand
    /// near that direction would otherwise swing faster than people do.
    fn turn_elbows(&mut self, bent: &[[Option<Vector3<f64>>; 2]; 2], dt: f64) {
        self.motion.elbows = [1.0, -1.0].map(elbow_side);
        let wanted = self.bent_elbows();
        for ((elbow, [before, _]), [wanted, axis]) in
            self.motion.elbows.iter_mut().zip(bent).zip(wanted)
        {
            let (Some(before), Some(axis)) = (before, axis) else { continue };
            let Some(before) = (before - axis * axis.dot(before)).try_normalize(1e-9) else {
                continue;
            };
            let wanted = wanted.unwrap_or(before);
            let angle = axis.dot(&before.cross(&wanted)).atan2(before.dot(&wanted));
            if angle.abs() > SWIVEL_RATE * dt {
                let step = SWIVEL_RATE.copysign(angle) * dt;
                *elbow = Rotation3::new(axis * step) * before;
            }
        }
    }

    /// Returns true if a point of the arms is farther from where it was than `distance` \[m\].
    fn arms_moved_by_more_than(&self, distance: f64, before: &[Vector3<f64>; 6]) -> bool {
        before.iter().zip(self.arms()).any(|(from, to)| (to - from).norm() > distance)
    }

    /// Elbows, wrists and fingertips \[m, world\].
    fn arms(&self) -> [Vector3<f64>; 6] {
        let joints = self.joints();
        let of = |[_, elbow, wrist]: [Body25; 3]| {
            let (elbow, wrist) = (joints[elbow.index()].coords, joints[wrist.index()].coords);
            let along = (wrist - elbow).try_normalize(1e-9).unwrap_or_default();
            [elbow, wrist, wrist + along * FINGERTIPS]
        };
        let (left, right) = (of(LEFT_ARM), of(RIGHT_ARM));
        std::array::from_fn(|point| if point < 3 { left[point] } else { right[point - 3] })
    }

    /// Moves the right hand to an object \[m, world\] while the arm reaches it. `None` leaves it to the activity.
    pub(super) fn reach_for(&mut self, object: Option<&Point3<f64>>) {
        let arm = Arm::of_stature(self.stature);
        let shoulder = self.right_shoulder();
        let reached = object.filter(|object| (object.coords - shoulder).norm() <= arm.reach());
        self.place_hand(reached, Vector3::zeros());
    }

    /// Moves the right hand towards a point \[m, world\] as far as the arm reaches, however the body is bent. If there is
    /// none, the hand is where the activity has it.
    pub(super) fn reach_towards(&mut self, point: Option<&Point3<f64>>) {
        self.place_hand(point, skeleton::carried(&self.motion));
    }

    /// The right hand is to be as far towards a point (m, world) as the arm reaches; the trunk carries it so far
    /// (statures).
    fn place_hand(&mut self, point: Option<&Point3<f64>>, carried: Vector3<f64>) {
        let (arm, shoulder) = (Arm::of_stature(self.stature), self.right_shoulder());
        let world_from_person = Rotation3::from_axis_angle(&Vector3::z_axis(), self.motion.heading);
        self.motion.reach_for(point.map(|point| {
            let aside = world_from_person * self.motion.elbow(false);
            let [_, wrist] = arm.leading_to(&point.coords, &shoulder, &aside);
            let away = wrist - self.motion.floor.coords.push(0.0);
            world_from_person.inverse() * away / self.stature - carried
        }));
    }

    /// Place of the right shoulder (m, world).
    pub(super) fn right_shoulder(&self) -> Vector3<f64> {
        self.joints()[Body25::RightShoulder.index()].coords
    }

    /// Leans (rad) and squats (statures) from now on.
    pub(super) fn bend(&mut self, lean: f64, drop: f64) {
        self.motion.moving.keep(lean, drop);
    }

    /// Begins a movement on the spot.
    pub(super) fn begin(&mut self, movement: Movement, draw: &mut ChaCha8Rng) {
        self.motion.moving.begin(movement, draw);
    }

    /// Returns true while a movement is in progress, as it always is while they repeat a motion.
    pub(super) fn is_busy(&self) -> bool {
        self.performance.is_some() || !self.motion.moving.is_over()
    }

    /// Displaces the person at once \[m\].
    pub(super) fn jump(&mut self, displacement: Vector2<f64>) {
        self.motion.floor += displacement;
        if let Some(performance) = &mut self.performance {
            performance.jump(displacement);
        }
    }

    /// Moves the person in a direction (m), who goes no longer against it.
    pub(super) fn slide(&mut self, away: Vector2<f64>, distance: f64) {
        self.motion.floor += away * distance;
        self.motion.velocity -= away * self.motion.velocity.dot(&away).min(0.0);
    }

    /// Stands at once.
    pub(super) fn halt(&mut self) {
        self.motion.velocity = Vector2::zeros();
    }

    pub(super) fn has_reached(&self, goal: &Goal) -> bool {
        self.performance.is_some() || self.motion.has_reached(goal)
    }

    /// The stature \[m\].
    pub fn stature(&self) -> f64 {
        self.stature
    }

    /// The point on the floor below the pelvis, in the world \[m\]: without its sway, unless they repeat the motion of
    /// a real person.
    pub fn floor(&self) -> Point2<f64> {
        self.motion.floor
    }

    /// The yaw of the forward direction \[rad\].
    pub fn heading(&self) -> f64 {
        self.motion.heading
    }

    /// The velocity over the floor of [`floor`](Self::floor), in the world \[m/s\].
    pub fn velocity(&self) -> Vector2<f64> {
        self.motion.velocity
    }

    /// The person's action, in the classes of the recogniser.
    pub fn action(&self) -> Action {
        self.activity.action(self.motion.velocity_in_person())
    }

    /// The joints in the world.
    pub fn joints(&self) -> Joints {
        match &self.performance {
            Some(performance) => performance.joints(),
            None => skeleton::joints(self.stature, &self.motion),
        }
    }
}

#[cfg(test)]
mod tests {
    use rand::{Rng, SeedableRng};
    use vision_models::Tool;

    use super::*;

    /// The place of the right grip.
    fn grip(person: &Person) -> Vector3<f64> {
        let joints = person.joints();
        let at = |joint: Body25| joints[joint.index()].coords;
        let arm = Arm::of_stature(person.stature());
        arm.grip(&at(Body25::RightElbow), &at(Body25::RightWrist))
    }

    #[test]
    fn working_hand_goes_to_a_reachable_object() {
        let (floor, heading) = (Point2::new(1.0, 2.0), 2.5);
        let works = Activity::Use(Tool::Drill);
        let goal = Goal { floor, heading, speed: 0.5, stop: true };
        for gait in [Gait::CAREFUL, Gait::NATURAL] {
            let gait = Gait { sway: 0.0, ..gait };
            let begin = Person::standing(1.75, floor, heading, gait, works);
            let work = |object: Option<&Point3<f64>>| {
                let mut person = begin.clone();
                for _ in 0..8000 {
                    person.reach_for(object);
                    person.advance(&goal, works, 1e-3);
                }
                grip(&person)
            };
            let rest = work(None);
            // The object is nearer, higher, and to the right.
            for away in [[0.16, -0.12, 0.0], [0.0, 0.0, 0.2], [0.09, 0.12, 0.1]] {
                let object = Point3::from(rest + Vector3::from(away));
                assert!((work(Some(&object)) - object.coords).norm() < 1e-3, "{away:?}");
            }
            let far = Point3::from(rest + Vector3::new(0.0, 0.0, 2.0));
            assert!((work(Some(&far)) - rest).norm() < 1e-9, "out of reach");
        }
    }

    #[test]
    fn no_arm_whips_beside_an_object() {
        let works = Activity::Use(Tool::Drill);
        let goal = Goal { floor: Point2::origin(), heading: 0.0, speed: 0.5, stop: true };
        let mut fastest = 0.0_f64;
        for (index, movement) in (0..12_u64).flat_map(|seed| Movement::ALL.map(|any| (seed, any))) {
            let mut draw = ChaCha8Rng::seed_from_u64(index);
            let stature = draw.random_range(1.5..2.0);
            let mut person = Person::standing(stature, Point2::origin(), 0.0, Gait::CAREFUL, works);
            let object = Point3::new(
                draw.random_range(0.1..0.7),
                draw.random_range(-0.6..0.4),
                draw.random_range(0.6..1.6),
            );
            person.begin(movement, &mut draw);
            // They may stop working in the middle of it.
            let mut left = draw.random_range(200..2000);
            while person.is_busy() {
                let before = person.arms();
                let activity = if left > 0 { works } else { Activity::Walk };
                person.reach_for(Some(&object).filter(|_| left > 0));
                person.advance(&goal, activity, 1e-3);
                left = (left - 1).max(0);
                let moved = before.iter().zip(person.arms()).map(|(from, to)| (to - from).norm());
                fastest = moved.fold(fastest, |fastest, moved| fastest.max(moved / 1e-3));
            }
        }
        assert!(fastest <= FASTEST_MOVEMENT + 1e-9, "{fastest}");
        assert!(fastest > 2.0, "hands of people come to 2 m/s: {fastest}");
    }

    #[test]
    fn an_elbow_turns_slowly_past_its_hanging_direction() {
        let (floor, works) = (Point2::origin(), Activity::Use(Tool::Drill));
        let goal = Goal { floor, heading: 0.0, speed: 0.5, stop: true };
        let mut person = Person::standing(1.75, floor, 0.0, Gait::NATURAL, works);
        let shoulder = person.right_shoulder();
        let hanging = elbow_side(-1.0).normalize() * 0.35;
        let across = hanging.cross(&Vector3::z()).normalize();
        let (mut fastest, mut farthest) = (0.0_f64, 0.0_f64);
        for tick in 0..6000 {
            let object =
                Point3::from(shoulder + hanging + across * (0.15 - 5e-5 * f64::from(tick)));
            let [elbow, before] = [3, 4].map(|point| person.arms()[point]);
            person.reach_for(Some(&object));
            person.advance(&goal, works, 1e-3);
            if tick > 1000 {
                let [elbow_now, now] = [3, 4].map(|point| person.arms()[point]);
                fastest = fastest.max((elbow_now - elbow).norm() / 1e-3);
                farthest = farthest.max((now - before).norm() / 1e-3);
            }
        }
        assert!(fastest < 1.5, "an elbow at {fastest} m/s beside a wrist at {farthest} m/s");
        assert!(fastest > 0.3, "the elbow never turned: {fastest} m/s");
    }

    #[test]
    fn arm_parts_keep_the_gait_speed_limit() {
        let (floor, works) = (Point2::origin(), Activity::Use(Tool::Drill));
        let goal = Goal { floor, heading: 0.0, speed: 0.5, stop: true };
        let mut person = Person::standing(1.75, floor, 0.0, Gait::CAREFUL, works);
        let shoulder = person.joints()[Body25::RightShoulder.index()];
        let mut fastest = 0.0_f64;
        // The object moves around the side to which the elbow hangs, where the elbow turns about an arm that hardly
        // moves.
        for turn in 0..40 {
            let angle = f64::from(turn) * 3.35;
            let across = Vector3::new(angle.cos(), angle.sin(), 0.0) * 0.25;
            let object = shoulder + across + elbow_side(-1.0).normalize() * 0.35;
            for _ in 0..5000 {
                let before = person.arms();
                person.reach_for(Some(&object));
                person.advance(&goal, works, 1e-3);
                let moved = before.iter().zip(person.arms()).map(|(from, to)| (to - from).norm());
                fastest = moved.fold(fastest, |fastest, moved| fastest.max(moved / 1e-3));
            }
        }
        let most = Gait::CAREFUL.arm_speed;
        assert!(fastest <= most + 1e-9, "{fastest}");
        assert!(fastest > 0.5 * most, "the hand never came to where elbows turn: {fastest}");
    }
}
