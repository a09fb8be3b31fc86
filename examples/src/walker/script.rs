//! What the person does, one step after the other (paper, Experiments 3 and 4).

use std::{collections::VecDeque, f64::consts::PI};

use nalgebra::{Point2, Vector2};
use rand_chacha::ChaCha8Rng;
use vision_models::{Action, Tool, WalkingDirection};

use super::{
    WalkerSettings, Waypoint,
    motion::{Goal, Hands, Motion},
    path::WORKPLACE,
};

/// Where the person stands at first, in the world (m).
pub(super) const START: Point2<f64> = Point2::new(3.2, 0.0);

/// The heading that faces the robot's first place (rad).
pub(super) const TOWARDS_ROBOT: f64 = PI;

/// Coming and going (m/s).
const WALKING_SPEED: f64 = 0.8;

/// Leading the robot (m/s).
const LEADING_SPEED: f64 = 0.3;

/// Slower than this, the person stands (m/s).
const STANDING_SPEED: f64 = 0.08;

/// So much before the end of the recording the person begins to leave (s).
const TIME_TO_LEAVE: f64 = 6.0;

/// What the person is busy with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Activity {
    CarryObject,
    DeliverObject,
    PickUp(Tool),
    HoldTool(Tool),
    Use(Tool),
    PutDown(Tool),
    Walk,
}

impl Activity {
    /// The HRI30 class of this activity, given the velocity in the person's frame (m/s).
    pub(super) fn action(self, velocity: Vector2<f64>) -> Action {
        let direction =
            WalkingDirection::nearest(velocity).filter(|_| velocity.norm() > STANDING_SPEED);
        match (self, direction) {
            (Self::CarryObject, _) => Action::WalkingWithObject,
            (Self::DeliverObject, _) => Action::DeliverObject,
            (Self::PickUp(tool), _) => Action::PickUp(tool),
            (Self::HoldTool(tool), _) => Action::NoCollaborative(tool),
            (Self::Use(tool), Some(direction)) => Action::MoveWhileUsing(direction, tool),
            (Self::Use(tool), None) => Action::Using(tool),
            (Self::PutDown(tool), _) => Action::PutDown(tool),
            (Self::Walk, _) => Action::Walking,
        }
    }

    fn hands(self) -> Hands {
        match self {
            Self::CarryObject => Hands::Carrying,
            Self::DeliverObject => Hands::Reaching,
            Self::PickUp(_) | Self::PutDown(_) => Hands::AtTable,
            Self::HoldTool(_) => Hands::Holding,
            Self::Use(_) => Hands::Working,
            Self::Walk => Hands::Swinging,
        }
    }
}

/// Go there, then go on with it for a while.
#[derive(Clone, Copy, Debug)]
struct Step {
    goal: Goal,
    activity: Activity,
    /// Time spent at the goal (s).
    dwell: f64,
}

/// The steps to come and the one that is under way.
#[derive(Clone, Debug)]
pub(super) struct Script {
    step: Step,
    /// When the goal of the step was reached (s).
    arrived: Option<f64>,
    to_come: VecDeque<Step>,
    way: Vec<Waypoint>,
    stage: Stage,
    tool: Tool,
    pace: f64,
    duration: f64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Stage {
    Arriving,
    Leading,
    Leaving,
}

impl Script {
    /// `pace` scales the time that each step takes.
    pub(super) fn new(settings: &WalkerSettings, pace: f64, draw: &mut ChaCha8Rng) -> Self {
        let tool = settings.tool;
        let goal =
            Goal { floor: WORKPLACE, heading: TOWARDS_ROBOT, speed: WALKING_SPEED, stop: true };
        let at_workplace = |activity, dwell| Step { goal, activity, dwell: dwell * pace };
        Self {
            step: at_workplace(Activity::CarryObject, 0.3),
            arrived: None,
            to_come: VecDeque::from([
                at_workplace(Activity::DeliverObject, 3.0),
                at_workplace(Activity::PickUp(tool), 2.5),
                at_workplace(Activity::HoldTool(tool), 1.5),
                at_workplace(Activity::Use(tool), 5.0),
            ]),
            way: settings.path.waypoints(draw),
            stage: Stage::Arriving,
            tool,
            pace,
            duration: settings.duration,
        }
    }

    /// Moves the person on from `time` by `dt` (s) and says what the person is busy with.
    pub(super) fn advance(&mut self, motion: &mut Motion, time: f64, dt: f64) -> Activity {
        let time_left = self.duration - time;
        if self.stage == Stage::Leading && time_left < TIME_TO_LEAVE {
            self.stage = Stage::Leaving;
            self.to_come = self.leave(motion);
            self.next_step();
        }
        if motion.has_reached(&self.step.goal) {
            let arrived = *self.arrived.get_or_insert(time);
            if time - arrived >= self.step.dwell {
                self.next_step();
            }
        }
        motion.advance(&self.step.goal, self.step.activity.hands(), dt);
        self.step.activity
    }

    fn next_step(&mut self) {
        if self.to_come.is_empty() && self.stage != Stage::Leaving {
            self.stage = Stage::Leading;
            self.to_come = self.way.iter().map(|waypoint| self.lead_to(waypoint)).collect();
        }
        // Once everything is done the person stays as they are.
        if let Some(step) = self.to_come.pop_front() {
            self.step = step;
            self.arrived = None;
        }
    }

    fn lead_to(&self, waypoint: &Waypoint) -> Step {
        let goal = Goal {
            floor: waypoint.floor,
            heading: waypoint.heading,
            speed: LEADING_SPEED,
            stop: waypoint.dwell > 0.0,
        };
        Step { goal, activity: Activity::Use(self.tool), dwell: waypoint.dwell * self.pace }
    }

    /// Lays the tool down here and walks away from the robot's first place.
    fn leave(&self, motion: &Motion) -> VecDeque<Step> {
        let here =
            Goal { floor: motion.floor, heading: motion.heading, speed: WALKING_SPEED, stop: true };
        let away = Goal { floor: motion.floor + Vector2::new(2.5, 0.0), heading: 2.0 * PI, ..here };
        VecDeque::from([
            Step { goal: here, activity: Activity::PutDown(self.tool), dwell: 2.5 * self.pace },
            Step { goal: away, activity: Activity::Walk, dwell: 0.0 },
        ])
    }
}
