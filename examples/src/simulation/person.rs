//! The body of a person.

use nalgebra::{Point2, Point3, Vector2};
use vision_models::{Action, Body25};

use super::activity::Activity;
use super::motion::{Gait, Goal, Motion};
use super::skeleton;

/// The joints of `BODY_25` in the world (m).
pub type Joints = [Point3<f64>; Body25::COUNT];

/// Where a person is, how they move and what they do.
#[derive(Clone, Debug)]
pub struct Person {
    stature: f64,
    motion: Motion,
    activity: Activity,
}

impl Person {
    /// A standing person of this stature (m); the heading in radians.
    pub(super) fn standing(
        stature: f64,
        floor: Point2<f64>,
        heading: f64,
        gait: Gait,
        activity: Activity,
    ) -> Self {
        let motion = Motion::starting_at(floor, heading, gait, activity.hands());
        Self { stature, motion, activity }
    }

    /// Goes on towards a goal for `dt` (s).
    pub(super) fn advance(&mut self, goal: &Goal, activity: Activity, dt: f64) {
        self.motion.advance(goal, activity.hands(), dt);
        self.activity = activity;
    }

    /// Is elsewhere at once (m).
    pub(super) fn jump(&mut self, displacement: Vector2<f64>) {
        self.motion.floor += displacement;
    }

    pub(super) fn has_reached(&self, goal: &Goal) -> bool {
        self.motion.has_reached(goal)
    }

    /// The stature (m).
    pub fn stature(&self) -> f64 {
        self.stature
    }

    /// The floor below the pelvis, in the world (m).
    pub fn floor(&self) -> Point2<f64> {
        self.motion.floor
    }

    /// The yaw of the forward direction (rad).
    pub fn heading(&self) -> f64 {
        self.motion.heading
    }

    /// Over the floor, in the world (m/s).
    pub fn velocity(&self) -> Vector2<f64> {
        self.motion.velocity
    }

    /// What the person does, in the classes of the recogniser.
    pub fn action(&self) -> Action {
        self.activity.action(self.motion.velocity_in_person())
    }

    /// The joints in the world.
    pub fn joints(&self) -> Joints {
        skeleton::joints(self.stature, &self.motion)
    }
}
