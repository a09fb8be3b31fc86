//! The arm yields to pushes and weights within bounds.

use super::*;

/// An arm yields to a push slowly and by a limited distance. Nothing holds a joint that is pushed harder than its motor
/// can hold. The wrist's 12 Nm are less than 80 N at the tool.
#[test]
fn giving_way_is_bounded_in_speed_and_travel() {
    for (force, travel) in [
        (Vector3::new(0.0, 0.0, -80.0), 0.25),
        (Vector3::new(80.0, 0.0, 0.0), 0.25),
        (Vector3::new(0.0, 80.0, 0.0), 0.3),
    ] {
        let mut robot = Loop::new(ControllerSettings::default());
        robot.run(0.5);
        let start = robot.tool();
        robot.push(force);
        let (mut fastest, mut is_overpowered) = (0.0_f64, [false; 7]);
        for _ in 0..10_000 {
            robot.step();
            let speeds = robot.robot.simulation().velocity().iter().zip(MOCA.limits()).skip(3);
            let joints = speeds.zip(robot.controller.torque()).zip(&mut is_overpowered);
            for (((velocity, limit), torque), is_overpowered) in joints {
                *is_overpowered |= torque.abs() >= limit.effort;
                if !*is_overpowered {
                    fastest = fastest.max(velocity.abs() / limit.velocity);
                }
            }
        }
        assert_eq!(robot.cause(), Some(Fault::ContactForce));
        let gone = (robot.tool() - start).norm();
        assert!(gone > 0.15 && gone < travel, "{force}: {gone} m");
        // The arm accelerates until the push is noticed, then yields at a tenth of its speed.
        assert!(fastest < 0.5, "{force}: {fastest} of its speed");
        let strong = [&is_overpowered[..4], &is_overpowered[6..]].concat();
        assert!(!strong.contains(&true), "{force}: {is_overpowered:?}");
    }
}

/// An undeclared payload of five kilograms does not sink and is reported.
#[test]
fn undeclared_payload_is_held_and_reported() {
    let mut settings = ControllerSettings::default();
    settings.safety.supervisor.contact_force = 40.0;
    let mut robot = Loop::new(settings);
    robot.run(0.5);
    let start = robot.tool();
    robot.push(Vector3::new(0.0, 0.0, -5.0 * 9.81));
    let mut named = None;
    for tick in 0..20_000 {
        robot.step();
        if robot.controller.unknown_payload().is_some() && named.is_none() {
            named = Some(tick);
        }
    }
    let gone = start.z - robot.tool().z;
    let mass = robot.controller.unknown_payload().unwrap();
    assert!((mass - 5.0).abs() < 0.6, "{mass} kg");
    assert!(named.unwrap() < 4000 && gone < 0.3, "{named:?} {gone}");
    assert_eq!(robot.state(), SafetyState::ProtectiveStop);
}
