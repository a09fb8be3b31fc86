//! Judge of whether and when the right surface is in front of the person, by the true poses.

use hrsw_safety::SafetyState;
use moca_model::{DesiredMotion, Phase};
use nalgebra::{Unit, UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize};
use simulated_people::Truth;
use vision_models::Surface;

use crate::plant::Plant;
use crate::run::Scenario;

/// Tolerance of orientations for the errors of the tracked heading and of the robot's following \[rad\].
const TOLERANCE: f64 = 0.05;

/// A turn of the object.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Turn {
    /// True if the robot has the object.
    pub grasped: bool,
    /// True if the robot began to turn it.
    pub recognised: bool,
    /// True if the right surface is in front of the person when they stop working.
    pub right: bool,
    /// Rotation of the tool from the middle of the room for orientations at that time, as a rotation vector \[rad\].
    pub off: [f64; 3],
    /// Time from the beginning of the turn to the work pose, in which it then stays \[s\].
    pub time: Option<f64>,
    /// Part of that time in which the robot is slowed, stands or retreats because of the person \[s\].
    pub hindered: f64,
    /// Least time that the limits of the desired pose allow \[s\].
    pub least_time: Option<f64>,
}

impl Turn {
    /// The time over the least time; `None` if there was nothing to turn.
    pub fn ratio(&self) -> Option<f64> {
        let least = self.least_time.filter(|least| *least > 0.0)?;
        Some(self.time? / least)
    }
}

/// Compares the true tool with the true person.
#[derive(Debug)]
pub struct Judge<'a> {
    truth: &'a [Truth],
    /// Orientation of the tool in the person's frame in the work pose.
    goal: UnitQuaternion<f64>,
    room: Vector3<f64>,
    desired: DesiredMotion,
    turn: Turn,
    began: Option<f64>,
    arrived: Option<f64>,
}

impl<'a> Judge<'a> {
    /// Creates a judge for a scenario whose person needs this surface, which is opposite to the front.
    pub fn new(scenario: &Scenario, truth: &'a [Truth], needed: Surface) -> Self {
        let space = &scenario.settings.space;
        let half_turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), std::f64::consts::PI);
        let behind = scenario.object.faces.first().is_some_and(|face| face.surface != needed);
        let turned = if behind { half_turn } else { UnitQuaternion::identity() };
        Self {
            truth,
            goal: space.tool * turned,
            room: space.turn,
            desired: scenario.settings.desired,
            turn: Turn::default(),
            began: None,
            arrived: None,
        }
    }

    /// Takes a tick.
    pub fn push(&mut self, time: f64, plant: &Plant) {
        let phase = plant.command().phase;
        self.turn.grasped |= plant.controller().object().is_some();
        let next = self.truth.partition_point(|truth| truth.time <= time);
        let Some(person) = next.checked_sub(1).and_then(|at| self.truth.get(at)) else {
            return;
        };
        // Nothing changes after they stop working.
        if phase == Phase::Apart || !person.action.is_collaborative() {
            return;
        }
        let heading = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), person.heading);
        let off = (heading * self.goal).inverse() * plant.tool().rotation;
        let off = off.scaled_axis();
        let within = (0..3).all(|axis| off[axis].abs() <= self.room[axis] + TOLERANCE);
        if matches!(phase, Phase::Turning { .. }) && self.began.is_none() {
            self.began = Some(time);
            self.turn.recognised = true;
            self.turn.least_time = Some(self.least_time(&off));
        }
        if self.began.is_some() {
            let hindered = plant.command().safety != SafetyState::Normal;
            if hindered && self.arrived.is_none() {
                self.turn.hindered += plant.controller().settings().period;
            }
            self.arrived = if within { self.arrived.or(Some(time)) } else { None };
            self.turn.right = within;
            self.turn.off = off.into();
        }
    }

    /// The least time to turn back by a rotation vector to the edge of the room, without coming to rest there.
    fn least_time(&self, off: &Vector3<f64>) -> f64 {
        let axis = Unit::try_new(*off, 1e-9).unwrap_or_else(Vector3::z_axis);
        // The distance along the geodesic at which it enters the room.
        let edge = (0..3).map(|i| self.room[i] / axis[i].abs()).fold(f64::INFINITY, f64::min);
        let angle = (off.norm() - edge).max(0.0);
        let speed = self.desired.angular_velocity;
        let acceleration = self.desired.angular_acceleration;
        let spent = 0.5 * speed * speed / acceleration;
        if angle <= spent {
            (2.0 * angle / acceleration).sqrt()
        } else {
            speed / acceleration + (angle - spent) / speed
        }
    }

    /// The result.
    pub fn turn(&self) -> Turn {
        let time = match (self.began, self.arrived) {
            (Some(began), Some(arrived)) => Some(arrived - began),
            _ => None,
        };
        Turn { time, ..self.turn }
    }
}
