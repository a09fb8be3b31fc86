//! A person who walks at random, jumps, vanishes and comes back.

use std::f64::consts::{PI, TAU};

use nalgebra::{Rotation2, Vector2, Vector3};
use rand::Rng;
use rand_chacha::ChaCha8Rng;

use super::body::{self, Joints};

/// How fast people walk at most (m/s): with turning and the swing of the arms no part of the body
/// is then faster than the 1.6 m/s that the protective distance assumes where it is not measured.
/// Every tick checks that.
const SPEED: f64 = 1.0;
/// How they speed up (m/s²).
const ACCELERATION: f64 = 1.0;
/// How fast they turn (rad/s), and how that changes (rad/s²).
const TURNING: f64 = 0.6;
const TURNING_CHANGE: f64 = 3.0;
/// The farthest jump (m).
const JUMP: f64 = 2.0;

/// What the person does for a while.
#[derive(Clone, Copy, Debug)]
struct Plan {
    goal: Vector2<f64>,
    heading: f64,
    speed: f64,
    ends: f64,
}

/// The true state of a person.
#[derive(Clone, Debug)]
pub(super) struct Person {
    draw: ChaCha8Rng,
    stature: f64,
    floor: Vector2<f64>,
    velocity: Vector2<f64>,
    heading: f64,
    turning: f64,
    hands: [Vector3<f64>; 2],
    plan: Plan,
    phase: f64,
    /// Whether they work with the robot, and until when.
    together: (bool, f64),
    /// Whether the camera sees them, and until when.
    visible: (bool, f64),
    next_jump: f64,
    jumped: bool,
}

impl Person {
    /// Somewhere around the robot at `robot`.
    pub(super) fn new(mut draw: ChaCha8Rng, robot: Vector2<f64>) -> Self {
        let direction = Rotation2::new(draw.random_range(0.0..TAU));
        let floor = robot + direction * Vector2::x() * draw.random_range(1.2..4.0);
        let plan = Plan { goal: floor, heading: 0.0, speed: 0.5, ends: 0.0 };
        let visible = (draw.random_bool(0.7), draw.random_range(0.2..3.0));
        Self {
            stature: draw.random_range(1.5..2.0),
            floor,
            velocity: Vector2::zeros(),
            heading: draw.random_range(-PI..PI),
            turning: 0.0,
            hands: [Vector3::new(0.2, 0.08, 0.6), Vector3::new(0.2, -0.08, 0.6)],
            plan,
            phase: draw.random_range(0.0..TAU),
            together: (false, draw.random_range(0.5..3.0)),
            visible,
            next_jump: draw.random_range(2.0..12.0),
            jumped: false,
            draw,
        }
    }

    /// Moves on by `dt` to `time` (s), with the robot's tool above `tool`.
    pub(super) fn advance(&mut self, time: f64, dt: f64, tool: Vector2<f64>) {
        self.jumped = false;
        if time >= self.plan.ends {
            self.plan = self.new_plan(time, tool);
        }
        if time >= self.together.1 {
            self.together = (!self.together.0, time + self.draw.random_range(3.0..10.0));
        }
        if time >= self.visible.1 {
            let next = if self.visible.0 { 0.1..3.0 } else { 1.0..8.0 };
            self.visible = (!self.visible.0, time + self.draw.random_range(next));
        }
        if time >= self.next_jump {
            self.next_jump = time + self.draw.random_range(3.0..15.0);
            self.jumped = true;
            let direction = Rotation2::new(self.draw.random_range(0.0..TAU));
            self.floor += direction * Vector2::x() * self.draw.random_range(0.1..JUMP);
        }
        self.walk(dt);
        self.phase = (self.phase + 2.0 * dt) % TAU;
    }

    fn new_plan(&mut self, time: f64, tool: Vector2<f64>) -> Plan {
        let direction = Rotation2::new(self.draw.random_range(0.0..TAU));
        let away = direction * Vector2::x();
        // To the tool, as to work there; right into the robot; anywhere; or to stay.
        let (goal, facing) = match self.draw.random_range(0..10) {
            0..4 => (tool + away * self.draw.random_range(0.35..0.8), Some(tool)),
            4 => (tool, None),
            5..8 => (tool + away * self.draw.random_range(1.0..4.0), None),
            _ => (self.floor, Some(tool)),
        };
        let towards = facing.unwrap_or(goal) - goal;
        let heading = if towards.norm() > 1e-6 {
            towards.y.atan2(towards.x)
        } else {
            self.draw.random_range(-PI..PI)
        };
        let speed = self.draw.random_range(0.1..SPEED);
        Plan { goal, heading, speed, ends: time + self.draw.random_range(1.0..6.0) }
    }

    fn walk(&mut self, dt: f64) {
        let gap = self.plan.goal - self.floor;
        let distance = gap.norm();
        let speed = self.plan.speed.min((1.2 * ACCELERATION * distance).sqrt()).min(2.0 * distance);
        let wanted = gap.try_normalize(1e-9).unwrap_or_default() * speed;
        self.velocity += (wanted - self.velocity).cap_magnitude(ACCELERATION * dt);
        self.floor += self.velocity * dt;
        let turn = (self.plan.heading - self.heading + PI).rem_euclid(TAU) - PI;
        let rate = (2.0 * turn).clamp(-TURNING, TURNING);
        let change = TURNING_CHANGE * dt;
        self.turning += (rate - self.turning).clamp(-change, change);
        self.heading += self.turning * dt;
    }

    /// The joints in the world (m).
    pub(super) fn joints(&self) -> Joints {
        let swing = 0.04 * self.phase.sin();
        let hands = [
            self.hands[0] + Vector3::new(swing, 0.0, 0.5 * swing),
            self.hands[1] + Vector3::new(-swing, 0.0, 0.5 * swing),
        ];
        let (sine, cosine) = self.heading.sin_cos();
        body::standing(self.stature, &hands).map(|joint| {
            Vector3::new(
                cosine * joint.x - sine * joint.y + self.floor.x,
                sine * joint.x + cosine * joint.y + self.floor.y,
                joint.z,
            )
        })
    }

    /// Whether they jumped in the last step.
    pub(super) fn jumped(&self) -> bool {
        self.jumped
    }

    /// Whether the camera sees them.
    pub(super) fn is_visible(&self) -> bool {
        self.visible.0
    }

    /// Whether they work with the robot.
    pub(super) fn is_together(&self) -> bool {
        self.together.0
    }

    /// The velocity in their own frame (m/s).
    pub(super) fn velocity_in_person(&self) -> Vector2<f64> {
        Rotation2::new(-self.heading) * self.velocity
    }
}
