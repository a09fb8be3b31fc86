//! A person who walks at random, jumps, vanishes and comes back.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use nalgebra::{Point2, Point3, Rotation2, Vector2};
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use vision_models::Tool;

use super::activity::Activity;
use super::captured::CapturedMotion;
use super::motion::{Gait, Goal};
use super::movement::Movement;
use super::person::Person;

/// Largest walking speed \[m/s\]. In a [`Gait::CAREFUL`] no part of the body except the arms is then faster than 1.6
/// m/s. The protective distance assumes that speed for parts without a measured one.
const SPEED: f64 = 1.0;

/// Speed below which they stand and may start a movement on the spot \[m/s\].
const STANDING: f64 = 0.05;

/// Probability of a movement on the spot in place of a walk.
const MOVEMENTS: f64 = 0.3;

/// Largest jump \[m\].
const JUMP: f64 = 2.0;

/// A person who behaves unexpectedly around the tool of a robot.
#[derive(Clone, Debug)]
pub struct Wanderer {
    draw: ChaCha8Rng,
    person: Person,
    goal: Goal,
    /// Time at which the goal is given up \[s\].
    goal_ends: f64,
    /// True if they work with the robot, and the time of the next change \[s\].
    together: (bool, f64),
    /// True if the camera sees them, and the time of the next change \[s\].
    in_view: (bool, f64),
    next_jump: f64,
    jumped: bool,
    /// The movement to start once they stand.
    movement: Option<Movement>,
    /// The movement that they always repeat where they stand.
    only: Option<Movement>,
}

impl Wanderer {
    /// Creates a person around the robot at `robot` \[m\]. The same draws give the same person.
    pub fn new(mut draw: ChaCha8Rng, robot: Vector2<f64>) -> Self {
        let direction = Rotation2::new(draw.random_range(0.0..TAU));
        let floor = Point2::from(robot + direction * Vector2::x() * draw.random_range(1.2..4.0));
        let heading = draw.random_range(-PI..PI);
        let stature = draw.random_range(1.5..2.0);
        let in_view = draw.random_bool(0.7);
        // A person who is absent at first may stay away for as long as a joint outside its range needs to return.
        let in_view = (in_view, draw.random_range(if in_view { 0.2..3.0 } else { 0.2..9.0 }));
        Self {
            person: Person::standing(stature, floor, heading, Gait::CAREFUL, Activity::Walk),
            goal: Goal { floor, heading, speed: 0.5, stop: true },
            goal_ends: 0.0,
            together: (false, draw.random_range(0.5..3.0)),
            in_view,
            next_jump: draw.random_range(2.0..12.0),
            jumped: false,
            movement: None,
            only: None,
            draw,
        }
    }

    /// Creates a person who never works with the robot, stays in view and does not jump.
    pub fn passing_by(draw: ChaCha8Rng, robot: Vector2<f64>) -> Self {
        Self {
            together: (false, f64::INFINITY),
            in_view: (true, f64::INFINITY),
            next_jump: f64::INFINITY,
            ..Self::new(draw, robot)
        }
    }

    /// The same person, but for their motion, which is that of a real one around the same place. They jump, vanish, and
    /// begin and end working as before, but neither walk nor move a hand to the object.
    #[must_use]
    pub fn performing(mut self, motion: CapturedMotion) -> Self {
        let motion = motion.moved_to(self.person.floor(), self.person.heading());
        self.person = Person::performing(Arc::new(motion), activity(self.together.0));
        self
    }

    /// Creates a person near the object that the robot holds, in this direction from the robot \[m\], who repeats a
    /// movement there. They may work with the robot.
    pub fn repeating(
        draw: ChaCha8Rng,
        movement: Movement,
        (tool, outwards): (Point2<f64>, Vector2<f64>),
        together: bool,
    ) -> Self {
        let mut person = Self::passing_by(draw, tool.coords);
        let draw = &mut person.draw;
        let direction = Rotation2::new(draw.random_range(-0.6..0.6)) * outwards.normalize();
        let floor = tool + direction * draw.random_range(0.4..0.8);
        let heading = (-direction.y).atan2(-direction.x);
        let (stature, activity) = (draw.random_range(1.5..2.0), activity(together));
        Self {
            person: Person::standing(stature, floor, heading, Gait::CAREFUL, activity),
            goal: Goal { floor, heading, speed: 0.5, stop: true },
            goal_ends: 2.0,
            together: (together, f64::INFINITY),
            only: Some(movement),
            ..person
        }
    }

    /// Advances by `dt` to `time` \[s\]. The robot holds an object at `object` \[m\]. The hand is there while they work
    /// with the robot and the arm reaches it, unless they repeat the motion of a real person.
    pub fn advance(&mut self, time: f64, dt: f64, object: &Point3<f64>) {
        if time >= self.goal_ends && !self.person.is_busy() && self.movement.is_none() {
            if self.only.is_some() || self.draw.random_bool(MOVEMENTS) {
                let any = Movement::ALL[self.draw.random_range(0..Movement::ALL.len())];
                self.movement = Some(self.only.unwrap_or(any));
                let (floor, heading) = (self.person.floor(), self.person.heading());
                self.goal = Goal { floor, heading, speed: 0.5, stop: true };
            } else {
                self.goal = self.new_goal(object.xy());
                self.goal_ends = time + self.draw.random_range(1.0..6.0);
            }
        }
        let stands = self.person.velocity().norm() < STANDING;
        if let Some(movement) = self.movement.take_if(|_| stands) {
            self.person.begin(movement, &mut self.draw);
            self.goal.floor = self.person.floor();
            self.goal_ends = time + self.draw.random_range(0.5..1.5);
        }
        if time >= self.together.1 {
            self.together = (!self.together.0, time + self.draw.random_range(3.0..10.0));
        }
        if time >= self.in_view.1 {
            let next = if self.in_view.0 { 0.1..3.0 } else { 1.0..8.0 };
            self.in_view = (!self.in_view.0, time + self.draw.random_range(next));
        }
        self.jumped = time >= self.next_jump;
        if self.jumped {
            self.next_jump = time + self.draw.random_range(3.0..15.0);
            let direction = Rotation2::new(self.draw.random_range(0.0..TAU));
            let jump = direction * Vector2::x() * self.draw.random_range(0.1..JUMP);
            self.person.jump(jump);
            // A person who moves on the spot stays in place.
            if self.person.is_busy() {
                self.goal.floor += jump;
            }
        }
        self.person.reach_for(Some(object).filter(|_| self.together.0));
        self.person.advance(&self.goal, activity(self.together.0), dt);
    }

    fn new_goal(&mut self, tool: Point2<f64>) -> Goal {
        let direction = Rotation2::new(self.draw.random_range(0.0..TAU));
        let away = direction * Vector2::x();
        // Goals are the tool, as for work; the robot itself; any place; or the present one.
        let (floor, facing) = match self.draw.random_range(0..10) {
            0..4 => (tool + away * self.draw.random_range(0.35..0.8), Some(tool)),
            4 => (tool, None),
            5..8 => (tool + away * self.draw.random_range(1.0..4.0), None),
            _ => (self.person.floor(), Some(tool)),
        };
        let towards = facing.unwrap_or(floor) - floor;
        let heading = if towards.norm() > 1e-6 {
            towards.y.atan2(towards.x)
        } else {
            self.draw.random_range(-PI..PI)
        };
        // The shorter way around.
        let turn = (heading - self.person.heading() + PI).rem_euclid(TAU) - PI;
        let heading = self.person.heading() + turn;
        Goal { floor, heading, speed: self.draw.random_range(0.1..SPEED), stop: true }
    }

    /// The person.
    pub fn person(&self) -> &Person {
        &self.person
    }

    /// Returns true if they jumped in the last step.
    pub fn jumped(&self) -> bool {
        self.jumped
    }

    /// Returns true if the camera sees them.
    pub fn is_in_view(&self) -> bool {
        self.in_view.0
    }
}

fn activity(together: bool) -> Activity {
    if together { Activity::Use(Tool::Drill) } else { Activity::Walk }
}
