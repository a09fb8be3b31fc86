//! The gripper, by the action `control_msgs/GripperCommand`.

use std::sync::Arc;
use std::sync::atomic::{AtomicU8, Ordering};
use std::time::{Duration, Instant};

use moca_model::whole_body::control_loop::Grip;
use ros2_client::action::{ActionClient, GoalId};
use ros2_client::service::RmwRequestId;

use super::error::Ros2Error;
use super::messages::{GripperCommand, GripperFeedback, GripperResult};
use super::node::RosNode;

/// Place of each finger of an open gripper, that of Franka's hand \[m\].
pub(super) const OPEN: f64 = 0.04;
/// Largest effort of a finger \[N\].
pub(super) const EFFORT: f64 = 30.0;

/// Time after which a goal without an answer is sent again.
const ANSWERS: Duration = Duration::from_secs(1);

/// Codes of what is wanted, and of what the gripper holds.
const NOTHING: u8 = 0;
const NO: u8 = 1;
const YES: u8 = 2;

/// Order of a loop to its gripper, and the gripper's answer. Neither end ever waits for the other.
#[derive(Clone, Debug, Default)]
pub(super) struct GripState {
    closed: Arc<AtomicU8>,
    holds: Arc<AtomicU8>,
}

impl GripState {
    /// Says what the gripper is to do; `None` leaves it alone.
    pub(super) fn want(&self, grip: Option<Grip>) {
        let code = match grip {
            None => NOTHING,
            Some(Grip::Open) => NO,
            Some(Grip::Close) => YES,
        };
        self.closed.store(code, Ordering::Release);
    }

    /// Returns whether the gripper holds something; `None` if it did not say.
    pub(super) fn holds(&self) -> Option<bool> {
        match self.holds.load(Ordering::Acquire) {
            NO => Some(false),
            YES => Some(true),
            _ => None,
        }
    }

    fn wanted(&self) -> Option<bool> {
        match self.closed.load(Ordering::Acquire) {
            NO => Some(false),
            YES => Some(true),
            _ => None,
        }
    }

    fn say(&self, holds: Option<bool>) {
        let code = holds.map_or(NOTHING, |holds| if holds { YES } else { NO });
        self.holds.store(code, Ordering::Release);
    }
}

/// The client of the gripper's action.
pub(super) struct Gripper {
    client: ActionClient<GripperCommand, GripperResult, GripperFeedback>,
    state: GripState,
    /// Last order, and the stage that it has reached.
    asked: Option<(bool, Stage)>,
}

/// Stages of a goal.
#[derive(Clone, Copy)]
enum Stage {
    /// Sent at this moment, and not answered yet.
    Sent(RmwRequestId, GoalId, Instant),
    /// Accepted; the result comes as the answer to this request.
    Accepted(RmwRequestId),
    /// Over.
    Done,
}

impl Gripper {
    pub(super) fn new(node: &mut RosNode, state: GripState) -> Result<Self, Ros2Error> {
        Ok(Self { client: node.gripper()?, state, asked: None })
    }

    /// Sends what is newly wanted, and takes the answers that have come. A goal that cannot be sent is tried again at the
    /// next call, and one without an answer after a second.
    pub(super) fn update(&mut self) {
        let wanted = self.state.wanted();
        if let Some(close) = wanted
            && self.asked.is_none_or(|(asked, _)| asked != close)
        {
            let position = if close { 0.0 } else { OPEN };
            let goal = GripperCommand { position, max_effort: EFFORT };
            if let Ok((request, goal)) = self.client.send_goal(goal) {
                self.state.say(None);
                self.asked = Some((close, Stage::Sent(request, goal, Instant::now())));
            }
        }
        let Some((close, stage)) = &mut self.asked else { return };
        match *stage {
            Stage::Sent(request, goal, at) => match self.client.receive_goal_response(request) {
                Ok(Some(answer)) if answer.accepted => {
                    if let Ok(request) = self.client.request_result(goal) {
                        *stage = Stage::Accepted(request);
                    }
                }
                Ok(Some(_)) | Err(_) => *stage = Stage::Done,
                // A goal is lost while no gripper is there.
                Ok(None) if at.elapsed() > ANSWERS => self.asked = None,
                Ok(None) => {}
            },
            Stage::Accepted(request) => match self.client.receive_result(request) {
                Ok(Some((_, result))) => {
                    // Fingers that reach each other hold nothing. Those that stop before hold what is between them.
                    let holds = *close && result.stalled && !result.reached_goal;
                    self.state.say(Some(holds));
                    *stage = Stage::Done;
                }
                Ok(None) => {}
                Err(_) => *stage = Stage::Done,
            },
            Stage::Done => {}
        }
    }
}
