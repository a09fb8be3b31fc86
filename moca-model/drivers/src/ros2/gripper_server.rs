//! Gripper of a robot on the ROS graph, by the action `control_msgs/GripperCommand`.

use std::fmt;

use moca_model::whole_body::control_loop::Grip;
use ros2_client::action::{ActionServer, GetResultResponse, GoalStatusEnum, SendGoalResponse};
use ros2_client::builtin_interfaces::Time;
use ros2_client::service::RmwRequestId;

use super::error::Ros2Error;
use super::gripper::{EFFORT, OPEN};
use super::messages::{GripperCommand, GripperFeedback, GripperResult};
use super::node::RosNode;

/// The server of the gripper's action. It accepts every goal, and the newest one counts.
pub(super) struct GripperServer {
    server: ActionServer<GripperCommand, GripperResult, GripperFeedback>,
    wanted: Option<Grip>,
    /// Requests for results that are not known yet.
    waiting: Vec<RmwRequestId>,
}

impl fmt::Debug for GripperServer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("GripperServer").field("wanted", &self.wanted).finish_non_exhaustive()
    }
}

impl GripperServer {
    pub(super) fn new(node: &mut RosNode) -> Result<Self, Ros2Error> {
        Ok(Self { server: node.gripper_server()?, wanted: None, waiting: Vec::new() })
    }

    /// Takes the goals that have come, and answers as soon as the gripper `holds` something or nothing, as it should.
    /// Returns what the gripper is to do.
    pub(super) fn update(&mut self, holds: Option<bool>) -> Option<Grip> {
        while let Ok(Some((request, sent))) = self.server.receive_goal() {
            let answer = SendGoalResponse { accepted: true, stamp: Time::ZERO };
            if self.server.send_goal_response(request, answer).is_ok() {
                let closes = sent.goal.position < OPEN / 2.0;
                self.wanted = Some(if closes { Grip::Close } else { Grip::Open });
            }
        }
        while let Ok(Some((request, _))) = self.server.receive_result_request() {
            self.waiting.push(request);
        }
        let closed = self.wanted == Some(Grip::Close);
        if holds == Some(closed) {
            // Fingers that hold something stop before they reach each other.
            let (position, effort) = if closed { (OPEN / 2.0, EFFORT) } else { (OPEN, 0.0) };
            let result = GripperResult { position, effort, stalled: closed, reached_goal: !closed };
            for request in self.waiting.drain(..) {
                let status = GoalStatusEnum::Succeeded;
                // A client that hears nothing asks again.
                let _ = self.server.send_result(request, GetResultResponse { status, result });
            }
        }
        self.wanted
    }
}
