use moca_drivers::ros2::messages::{Float64MultiArray, Time};
use moca_drivers::ros2::{Commands, JointInterface, Refusal, Topic};
use moca_model::whole_body::control_loop::{JointCommand, JointMeasurement};
use proptest::prelude::*;

use super::{after, twist};

fn at_rest() -> JointCommand {
    JointCommand::at_rest(&JointMeasurement::resting(vec![0.0; 10], 10))
}

fn numbers(data: Vec<f64>) -> Float64MultiArray {
    Float64MultiArray { data, ..Float64MultiArray::default() }
}

proptest! {
    #[test]
    fn a_robot_moves_along_its_own_axes(yaw in -10.0..10.0_f64, x in -1.0..1.0_f64, y in -1.0..1.0_f64) {
        let (mut commands, mut command) = (Commands::new(7), at_rest());
        commands.take_twist(&twist(x, y, 0.3), after(1)).unwrap();
        commands.write(yaw, &mut command);
        let [along_x, along_y, turn] = *command.velocity.first_chunk().unwrap();
        let (sine, cosine) = yaw.sin_cos();
        prop_assert!((along_x - (cosine * x - sine * y)).abs() < 1e-12);
        prop_assert!((along_y - (sine * x + cosine * y)).abs() < 1e-12);
        prop_assert_eq!(turn, 0.3);
    }
}

#[test]
fn torques_go_to_the_arm_in_its_order() {
    let (mut commands, mut command) = (Commands::new(7), at_rest());
    commands.take_effort(&numbers((1..=7).map(f64::from).collect())).unwrap();
    commands.write(0.0, &mut command);
    assert_eq!(command.torque, [0.0, 0.0, 0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]);
}

#[test]
fn invalid_commands_are_refused_and_change_nothing() {
    let mut commands = Commands::new(7);
    commands.take_twist(&twist(0.5, 0.0, 0.0), after(1)).unwrap();
    commands.take_effort(&numbers(vec![1.0; 7])).unwrap();
    let size = Refusal::Size { what: "effort", found: 10, expected: 7 };
    assert_eq!(commands.take_effort(&numbers(vec![2.0; 10])), Err(size));
    let not_finite = Err(Refusal::NotFinite { what: "effort" });
    assert_eq!(commands.take_effort(&numbers(vec![f64::NAN; 7])), not_finite);
    let nan = commands.take_twist(&twist(f64::NAN, 0.0, 0.0), after(1));
    assert_eq!(nan, Err(Refusal::NotFinite { what: "twist" }));
    let mut world = twist(1.0, 0.0, 0.0);
    world.header.frame_id = "odom".to_owned();
    let frame = Refusal::Frame { found: "odom".to_owned(), expected: "base_footprint" };
    assert_eq!(commands.take_twist(&world, after(1)), Err(frame));
    let mut unstamped = twist(1.0, 0.0, 0.0);
    unstamped.header.stamp = Time::default();
    assert_eq!(commands.take_twist(&unstamped, after(1)), Err(Refusal::NoStamp));
    let mut command = at_rest();
    commands.write(0.0, &mut command);
    assert_eq!((command.velocity[0], command.torque[9]), (0.5, 1.0));
}

#[test]
fn topic_type_is_that_of_its_message() {
    let unstamped = Topic::BaseTwist.check_type("geometry_msgs::msg::dds_::Twist_").unwrap_err();
    let (found, expected) =
        ("geometry_msgs/Twist".to_owned(), "geometry_msgs/TwistStamped".to_owned());
    assert_eq!(unstamped, Refusal::Type { found, expected });
    for interface in [JointInterface::Effort, JointInterface::Velocity, JointInterface::Position] {
        let topic = Topic::JointCommands(interface);
        assert!(topic.check_type("std_msgs::msg::dds_::Float64MultiArray_").is_ok());
        assert!(topic.check_type("").is_err());
    }
}
