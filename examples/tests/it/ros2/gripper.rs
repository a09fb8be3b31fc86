//! A gripper on ROS 2.

use std::thread;
use std::time::Duration;

use moca_drivers::TopicNames;
use moca_drivers::ros2::messages::{GripperCommand, GripperResult};
use moca_drivers::ros2::ros2_client::action::{
    ActionServer, ActionServerQosPolicies, GetResultResponse, GoalStatusEnum, SendGoalResponse,
};
use moca_drivers::ros2::ros2_client::builtin_interfaces::Time;
use moca_drivers::ros2::ros2_client::qos::{History, WhenFull};
use moca_drivers::ros2::ros2_client::{
    ActionTypeName, Context, ContextOptions, Name, NodeName, NodeOptions, QosProfile,
    ServiceMapping,
};
use moca_drivers::ros2::{JointInterface, RobotJoints, Ros2Side, RosDomain};
use moca_model::MOCA_HOME;
use moca_model::whole_body::control_loop::{Grip, JointCommand, RobotSide};

use crate::robot_side::at_rest;

type Server = ActionServer<GripperCommand, GripperResult, GripperResult>;

/// Answers each goal of a gripper whose fingers stop at 1 cm of something. Returns the goal, if one came.
fn answer(server: &Server) -> Option<GripperCommand> {
    let goal = server.receive_goal().unwrap().map(|(request, sent)| {
        let answer = SendGoalResponse { accepted: true, stamp: Time::ZERO };
        server.send_goal_response(request, answer).unwrap();
        sent.goal
    });
    if let Some((request, _)) = server.receive_result_request().unwrap() {
        let result =
            GripperResult { position: 0.01, effort: 30.0, stalled: true, reached_goal: false };
        let status = GoalStatusEnum::Succeeded;
        server.send_result(request, GetResultResponse { status, result }).unwrap();
    }
    goal
}

#[test]
fn grippers_are_asked_and_say_what_they_hold() {
    // No other test uses this domain.
    let domain = RosDomain::parse("81").unwrap();
    let options = ContextOptions::new().domain_id(domain.number());
    let context = Context::with_options(options).unwrap();
    let options = NodeOptions::new().enable_rosout(false).start_parameter_services(false);
    let mut node = context.new_node(NodeName::new("/", "hand").unwrap(), options).unwrap();
    let qos = QosProfile::publisher_default()
        .reliability_reliable(WhenFull::Fail)
        .history(History::KeepLast { depth: 10 });
    let server: Server = node
        .create_action_server(
            ServiceMapping::Enhanced,
            &Name::parse("/hand/grip").unwrap(),
            &ActionTypeName::new("control_msgs", "GripperCommand"),
            ActionServerQosPolicies {
                goal_service: qos.clone(),
                result_service: qos.clone(),
                cancel_service: qos.clone(),
                feedback_publisher: qos.clone(),
                status_publisher: qos,
            },
        )
        .unwrap();
    let names = TopicNames { gripper: "/hand/grip".to_owned(), ..TopicNames::default() };
    let (mut side, _) =
        Ros2Side::join(domain, &names, RobotJoints::moca(), JointInterface::Effort).unwrap();
    let mut measured = at_rest(MOCA_HOME.len());
    let mut command = JointCommand::at_rest(&measured);
    side.receive(&mut measured).unwrap();
    assert_eq!(measured.robot.holds, None, "it was not asked yet");
    let mut said = |grip: Grip, holds: bool| {
        command.grip = Some(grip);
        let mut goals = Vec::new();
        for _ in 0..2000 {
            side.send(&command).unwrap();
            goals.extend(answer(&server));
            side.receive(&mut measured).unwrap();
            if measured.robot.holds == Some(holds) && !goals.is_empty() {
                return goals;
            }
            thread::sleep(Duration::from_millis(10));
        }
        panic!("{grip:?}: holds {:?} after {} goals", measured.robot.holds, goals.len())
    };
    let closing = said(Grip::Close, true);
    assert!(closing.iter().all(|goal| goal.position == 0.0 && goal.max_effort > 0.0));
    let opening = said(Grip::Open, false);
    assert!(opening[0].position > 0.01, "{opening:?}");
    side.close().unwrap();
}
