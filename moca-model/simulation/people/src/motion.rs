//! Motion of the person over the floor, with steps and hands.

use std::f64::consts::TAU;

use nalgebra::{Point2, Rotation2, Vector2, Vector3};

use super::arm::elbow_side;
use super::movement::Moving;

/// Duration of two steps \[s\].
const STRIDE_TIME: f64 = 1.3;

/// Amplitudes of the pelvis's motion about its mean place at 1 m/s \[s\], along the way twice a stride and across it once.
/// Its speed relative to the mean is then 0.15 of the walking speed, root mean square: 0.16 m/s were measured on film at
/// 1.06 m/s.
const SURGE: f64 = 0.15 * STRIDE_TIME / (2.0 * TAU);
const WEAVE: f64 = 0.15 * STRIDE_TIME / TAU;

/// Frequencies of the sway of a standing person along each axis \[Hz\].
const SWAY: [[f64; 2]; 2] = [[0.17, 0.43], [0.23, 0.37]];
/// Amplitude of the velocity of each frequency \[m/s\]. The speed is 0.02 m/s, root mean square.
const SWAY_SPEED: f64 = 0.014;

/// Time constant of the mean velocity \[s\].
const PACE_TIME: f64 = 0.3;

/// Time constant with which the hands follow their targets \[s\].
const HAND_TIME: f64 = 0.25;

/// Limits and style of a person's motion.
///
/// ```
/// use simulated_people::Gait;
///
/// assert!(Gait::CAREFUL.turning_rate < Gait::NATURAL.turning_rate);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gait {
    /// Acceleration of the person \[m/s²\]. Slowing down is planned with less.
    pub acceleration: f64,
    /// Largest turning rate \[rad/s\].
    pub turning_rate: f64,
    /// Largest rate of change of the turning rate \[rad/s²\].
    pub turning_acceleration: f64,
    /// Length of the steps and swing of the arms, as a share of those of a person whose standing feet do not slide.
    pub stride: f64,
    /// Largest speed of the hands relative to the body, in statures a second.
    pub hand_speed: f64,
    /// Motion of the pelvis about its mean place, as a share of that of real people: steps push it to and fro, and it
    /// sways while they stand.
    pub sway: f64,
    /// Largest speed of any part of the arms \[m/s\]. Hands move more slowly where an elbow would swing faster.
    pub arm_speed: f64,
}

impl Gait {
    /// A gait in which standing feet stay in place.
    pub const NATURAL: Self = Self {
        acceleration: 0.8,
        turning_rate: 1.2,
        turning_acceleration: 4.0,
        stride: 1.0,
        sway: 0.0,
        hand_speed: f64::INFINITY,
        arm_speed: f64::INFINITY,
    };

    /// A gait of small sliding steps and quiet hands, whose hands and feet are not much faster than the trunk.
    pub const CAREFUL: Self = Self {
        acceleration: 1.0,
        turning_rate: 0.6,
        turning_acceleration: 3.0,
        stride: 0.2,
        sway: 1.0,
        hand_speed: 0.06,
        arm_speed: 1.5,
    };
}

/// A goal to walk to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Goal {
    /// Place in the world \[m\].
    pub(super) floor: Point2<f64>,
    /// Heading there \[rad\].
    pub(super) heading: f64,
    /// Walking speed \[m/s\].
    pub(super) speed: f64,
    /// True to stop there, false to pass by.
    pub(super) stop: bool,
}

/// The activity of the hands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Hands {
    /// Swing with the steps.
    Swinging,
    /// Hold the object close in front.
    Carrying,
    /// Hold the object out to the robot.
    Reaching,
    /// Take something from a table beside with the right hand, or lay it down.
    AtTable,
    /// Hold a tool close with the right hand.
    Holding,
    /// Both hands work with the tool on the object in front.
    Working,
}

/// The state of the moving person.
#[derive(Clone, Debug)]
pub(super) struct Motion {
    /// Mean place of the pelvis over the floor, in the world \[m\].
    pub(super) floor: Point2<f64>,
    /// Velocity over the floor, in the world \[m/s\].
    pub(super) velocity: Vector2<f64>,
    /// Its mean over some tenths of a second, which the sway belongs to \[m/s\].
    pace: Vector2<f64>,
    /// Yaw of the forward direction \[rad\].
    pub(super) heading: f64,
    pub(super) gait: Gait,
    turning_rate: f64,
    /// Phase of the two steps of a stride, in [0, 2π) \[rad\].
    phase: f64,
    /// Time since the beginning \[s\].
    time: f64,
    /// Left and right hand in the person's frame, as fractions of stature.
    pub(super) hands: [Vector3<f64>; 2],
    /// Sides to which the left and the right elbow are bent, in the person's frame.
    pub(super) elbows: [Vector3<f64>; 2],
    /// Place of the right hand in place of its activity's, as fractions of stature.
    reached_for: Option<Vector3<f64>>,
    /// Flexion of the trunk \[rad\].
    lean: f64,
    /// The movement on the spot besides.
    pub(super) moving: Moving,
}

impl Motion {
    pub(super) fn starting_at(floor: Point2<f64>, heading: f64, gait: Gait, hands: Hands) -> Self {
        Self {
            floor,
            velocity: Vector2::zeros(),
            pace: Vector2::zeros(),
            heading,
            gait,
            turning_rate: 0.0,
            phase: 0.0,
            time: 0.0,
            hands: hands.places(0.0),
            elbows: [elbow_side(1.0), elbow_side(-1.0)],
            reached_for: None,
            lean: 0.0,
            moving: Moving::default(),
        }
    }

    /// Is at another place \[m, rad\] after `dt` \[s\].
    pub(super) fn be_at(&mut self, floor: Point2<f64>, heading: f64, dt: f64) {
        self.velocity = if dt > 0.0 { (floor - self.floor) / dt } else { Vector2::zeros() };
        (self.floor, self.heading) = (floor, heading);
    }

    pub(super) fn has_reached(&self, goal: &Goal) -> bool {
        let near = if goal.stop { 0.02 } else { 0.12 };
        (goal.floor - self.floor).norm() < near
    }

    /// The velocity in the person's frame: x forwards, y to the left \[m/s\].
    pub(super) fn velocity_in_person(&self) -> Vector2<f64> {
        Rotation2::new(-self.heading) * self.velocity
    }

    /// The displacement of the pelvis from its mean place, in the person's frame \[m\].
    pub(super) fn sway(&self) -> Vector2<f64> {
        let along = Rotation2::new(-self.heading) * self.pace;
        let across = Vector2::new(-along.y, along.x);
        let walking =
            along * (SURGE * (2.0 * self.phase).sin()) + across * (WEAVE * self.phase.sin());
        let standing = SWAY.map(|frequencies| {
            let displacements = frequencies.map(|frequency| {
                SWAY_SPEED / (TAU * frequency) * (TAU * frequency * self.time).sin()
            });
            displacements.iter().sum()
        });
        (walking + Vector2::from(standing)) * self.gait.sway
    }

    /// The foot's place relative to the hip's, in the person's frame \[m\]: `x` and `y` along the floor and `z` the
    /// lift. The foot stands for half of a stride, so that it moves against the velocity. In the other half it swings
    /// to its next place.
    pub(super) fn foot(&self, left: bool) -> Vector3<f64> {
        let phase = (self.phase / TAU + if left { 0.0 } else { 0.5 }).fract();
        let velocity = self.velocity_in_person();
        let (along, lift) = if phase < 0.5 {
            (0.25 - phase, 0.0)
        } else {
            let swing = 2.0 * phase - 1.0;
            (-0.25 * (TAU / 2.0 * swing).cos(), (TAU / 2.0 * swing).sin())
        };
        let step = velocity * STRIDE_TIME * along;
        Vector3::new(step.x, step.y, 0.12 * lift * velocity.norm().min(1.0)) * self.gait.stride
    }

    /// The hand's place in the person's frame, as a fraction of stature.
    pub(super) fn hand(&self, left: bool) -> Vector3<f64> {
        let [of_left, of_right] = self.hands;
        if left { of_left } else { of_right }
    }

    /// The side to which the elbow is bent, in the person's frame.
    pub(super) fn elbow(&self, left: bool) -> Vector3<f64> {
        let [of_left, of_right] = self.elbows;
        if left { of_left } else { of_right }
    }

    /// The flexion of the trunk \[rad\].
    pub(super) fn lean(&self) -> f64 {
        self.lean
    }

    /// Sets the place of the right hand in the person's frame, as fractions of stature. `None` leaves it to its
    /// activity.
    pub(super) fn reach_for(&mut self, place: Option<Vector3<f64>>) {
        self.reached_for = place;
    }

    /// Advances by `dt` \[s\] in steps of a hundredth of a second.
    pub(super) fn advance(&mut self, goal: &Goal, hands: Hands, dt: f64) {
        let steps = (dt / 0.01).ceil().max(1.0);
        let mut left = steps;
        while left > 0.0 {
            self.step(goal, hands, dt / steps);
            left -= 1.0;
        }
    }

    fn step(&mut self, goal: &Goal, hands: Hands, dt: f64) {
        let Gait { acceleration, turning_rate, turning_acceleration, stride, hand_speed, .. } =
            self.gait;
        let to_goal = goal.floor - self.floor;
        let distance = to_goal.norm();
        // The person slows down in time, and at the end like a damped spring.
        let braking = (1.2 * acceleration * distance).sqrt().min(2.0 * distance);
        let speed = if goal.stop { goal.speed.min(braking) } else { goal.speed };
        let wanted = to_goal.try_normalize(1e-9).unwrap_or_default() * speed;
        self.velocity += (wanted - self.velocity).cap_magnitude(acceleration * dt);
        self.floor += self.velocity * dt;

        let rate = (3.0 * (goal.heading - self.heading)).clamp(-turning_rate, turning_rate);
        let change = turning_acceleration * dt;
        self.turning_rate += (rate - self.turning_rate).clamp(-change, change);
        self.heading += self.turning_rate * dt;

        self.phase = (self.phase + TAU * dt / STRIDE_TIME) % TAU;
        self.pace += (self.velocity - self.pace) * (dt / PACE_TIME).min(1.0);
        self.time += dt;
        let follow = dt / HAND_TIME;
        let swing = stride * self.velocity_in_person().x * (self.phase - TAU / 8.0).sin();
        let [left, right] = hands.places(swing);
        let places = [left, self.reached_for.unwrap_or(right)];
        for (hand, place) in self.hands.iter_mut().zip(places) {
            *hand += ((place - *hand) * follow).cap_magnitude(hand_speed * dt);
        }
        self.lean += (hands.lean() - self.lean) * follow;
        self.moving.advance(dt);
    }
}

impl Hands {
    /// Target places of the left and the right hand in the person's frame, as fractions of stature. `swing` is the
    /// velocity of the arms' swing \[m/s\].
    fn places(self, swing: f64) -> [Vector3<f64>; 2] {
        let swinging = |sign: f64| {
            let forwards = 0.05 - 0.12 * sign * swing;
            Vector3::new(forwards, sign * 0.14, 0.505 + 0.6 * forwards * forwards)
        };
        match self {
            Self::Swinging => [swinging(1.0), swinging(-1.0)],
            Self::Carrying => [Vector3::new(0.18, 0.07, 0.6), Vector3::new(0.18, -0.07, 0.6)],
            Self::Reaching => [Vector3::new(0.28, 0.05, 0.66), Vector3::new(0.28, -0.05, 0.66)],
            Self::AtTable => [swinging(1.0), Vector3::new(0.16, -0.22, 0.52)],
            Self::Holding => [swinging(1.0), Vector3::new(0.12, -0.13, 0.55)],
            Self::Working => [Vector3::new(0.22, 0.06, 0.61), Vector3::new(0.25, -0.04, 0.62)],
        }
    }

    /// The lean of the trunk \[rad\].
    fn lean(self) -> f64 {
        match self {
            Self::Swinging | Self::Carrying | Self::Holding => 0.03,
            Self::Reaching | Self::Working => 0.08,
            Self::AtTable => 0.15,
        }
    }
}
