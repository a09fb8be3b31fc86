//! The person's script: their steps in order (paper, Experiments 3 and 4).

use std::{collections::VecDeque, f64::consts::PI};

use super::{
    Occupation, WalkerSettings,
    activity::Activity,
    motion::Goal,
    path::{WORKPLACE, Waypoint},
    person::Person,
};
use nalgebra::{Point2, Vector2};
use rand_chacha::ChaCha8Rng;

/// First place of the person in the world \[m\].
pub(super) const START: Point2<f64> = Point2::new(3.2, 0.0);

/// Heading that faces the robot's first place \[rad\].
pub(super) const TOWARDS_ROBOT: f64 = PI;

/// Default speed of coming and going \[m/s\].
const WALKING_SPEED: f64 = 0.8;

/// Default speed of leading the robot \[m/s\].
const LEADING_SPEED: f64 = 0.3;

/// Time before the end of the recording at which the person begins to leave \[s\].
const TIME_TO_LEAVE: f64 = 6.0;

/// A step: go to a goal, then do an activity for some time.
#[derive(Clone, Copy, Debug)]
struct Step {
    goal: Goal,
    activity: Activity,
    /// Time spent at the goal \[s\].
    dwell: f64,
}

/// The present step and those to come.
#[derive(Clone, Debug)]
pub(super) struct Script {
    step: Step,
    /// Time at which the goal of the step was reached \[s\].
    arrived: Option<f64>,
    to_come: VecDeque<Step>,
    way: Vec<Waypoint>,
    stage: Stage,
    /// Speeds of coming and going, and of leading \[m/s\].
    walking_speed: f64,
    leading_speed: f64,
    /// Activity on the way.
    leading: Activity,
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
    /// Creates a script. `pace` scales the time of each step.
    pub(super) fn new(settings: &WalkerSettings, pace: f64, draw: &mut ChaCha8Rng) -> Self {
        let tool = settings.tool;
        let walking_speed = settings.speed.unwrap_or(WALKING_SPEED);
        let leading_speed = settings.speed.unwrap_or(LEADING_SPEED);
        let goal =
            Goal { floor: WORKPLACE, heading: TOWARDS_ROBOT, speed: walking_speed, stop: true };
        let at_workplace = |activity, dwell| Step { goal, activity, dwell: dwell * pace };
        let (first, to_come, leading) = match settings.occupation {
            Occupation::Working => {
                let steps = VecDeque::from([
                    at_workplace(Activity::DeliverObject, settings.offer),
                    at_workplace(Activity::PickUp(tool), 2.5),
                    at_workplace(Activity::HoldTool(tool), 1.5),
                    at_workplace(Activity::Use(tool), 5.0),
                ]);
                (at_workplace(Activity::CarryObject, 0.3), steps, Activity::Use(tool))
            }
            Occupation::Walking => {
                (at_workplace(Activity::Walk, 0.0), VecDeque::new(), Activity::Walk)
            }
        };
        Self {
            step: first,
            arrived: None,
            to_come,
            leading,
            way: settings.path.waypoints(draw),
            stage: Stage::Arriving,
            walking_speed,
            leading_speed,
            pace,
            duration: settings.duration,
        }
    }

    /// The person's goal and activity from `time` \[s\] on.
    pub(super) fn advance(&mut self, person: &Person, time: f64) -> (Goal, Activity) {
        let time_left = self.duration - time;
        if self.stage == Stage::Leading && time_left < TIME_TO_LEAVE {
            self.stage = Stage::Leaving;
            self.to_come = self.leave(person);
            self.next_step();
        }
        if person.has_reached(&self.step.goal) {
            let arrived = *self.arrived.get_or_insert(time);
            if time - arrived >= self.step.dwell {
                self.next_step();
            }
        }
        (self.step.goal, self.step.activity)
    }

    /// Returns true if the person has come to work and is not leaving.
    pub(super) fn is_leading(&self) -> bool {
        self.stage == Stage::Leading
    }

    fn next_step(&mut self) {
        if self.to_come.is_empty() && self.stage != Stage::Leaving {
            self.stage = Stage::Leading;
            self.to_come = self.way.iter().map(|waypoint| self.lead_to(waypoint)).collect();
        }
        // The person stays as they are once everything is done.
        if let Some(step) = self.to_come.pop_front() {
            self.step = step;
            self.arrived = None;
        }
    }

    fn lead_to(&self, waypoint: &Waypoint) -> Step {
        let goal = Goal {
            floor: waypoint.floor,
            heading: waypoint.heading,
            speed: self.leading_speed,
            stop: waypoint.dwell > 0.0,
        };
        Step { goal, activity: self.leading, dwell: waypoint.dwell * self.pace }
    }

    /// The steps of laying the tool down and walking away from the robot's first place.
    fn leave(&self, person: &Person) -> VecDeque<Step> {
        let here = Goal {
            floor: person.floor(),
            heading: person.heading(),
            speed: self.walking_speed,
            stop: true,
        };
        let away =
            Goal { floor: person.floor() + Vector2::new(2.5, 0.0), heading: 2.0 * PI, ..here };
        let put_down = match self.leading {
            Activity::Use(tool) => {
                Some(Step { goal: here, activity: Activity::PutDown(tool), dwell: 2.5 * self.pace })
            }
            _ => None,
        };
        let away = Step { goal: away, activity: Activity::Walk, dwell: 0.0 };
        put_down.into_iter().chain([away]).collect()
    }
}
