//! The loop down to torque: MOCA follows, is pushed, is held, and has bad measurements.

mod giving_way;

use ergo_map::ErgonomicsQuadratic;
use hrsw::Attachment;
use hrsw_safety::{Fault, SafetyState};
use moca_model::whole_body::Data;
use moca_model::whole_body::simulation::{Contact, RandomSource};
use moca_model::whole_body::state::ExternalWrench;
use moca_model::whole_body::torque::Compensation;
use moca_model::{
    Controller, ControllerSettings, DynamicRobot, DynamicRobotSettings, FollowingErrorSettings,
    MOCA_HOME, MOCA_TOOL, TorqueController, TorqueLoopSettings,
};
use nalgebra::{Isometry3, Matrix3, Vector3, Vector6};

use crate::drive::{FRAME, PERIOD, percept};
use crate::shared::MOCA;

/// Random numbers by SplitMix64.
#[derive(Debug, Clone)]
pub(crate) struct Noise(pub(crate) u64);

impl Noise {
    pub(crate) fn new(seed: u64) -> Self {
        Self(seed)
    }
}

impl RandomSource for Noise {
    fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.uniform()).sum::<f64>() - 6.0
    }

    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// The robot without people, whose tool goes where it is told.
struct Loop {
    controller: TorqueController,
    robot: DynamicRobot,
    noise: Noise,
    tick: u32,
    external: Vec<ExternalWrench>,
}

impl Loop {
    fn new(settings: ControllerSettings) -> Self {
        let ergonomics =
            ErgonomicsQuadratic::new(Matrix3::identity(), Vector3::zeros(), 1.0).unwrap();
        let controller = Controller::new(MOCA.clone(), ergonomics, settings, &MOCA_HOME).unwrap();
        Self {
            controller: TorqueController::new(
                controller,
                TorqueLoopSettings::new(Compensation::BARE),
            )
            .unwrap(),
            robot: DynamicRobot::new(&MOCA, &DynamicRobotSettings::default(), &MOCA_HOME).unwrap(),
            noise: Noise(5),
            tick: 0,
            external: Vec::new(),
        }
    }

    /// Sets the middle of the workspace.
    fn assign(&mut self, middle: Vector3<f64>) {
        let space = self.controller.controller().space().workspace();
        let rotation = space.world_from_workspace().rotation;
        let centre = (space.position().min() + space.position().max()) * 0.5;
        let place = Isometry3::from_parts((middle - rotation * centre).into(), rotation);
        let space = self.controller.controller_mut().space_mut();
        space.assign(Some(Attachment::World(place))).unwrap();
    }

    fn step(&mut self) {
        self.robot.measure(&mut self.noise).unwrap();
        let now = f64::from(self.tick) * PERIOD;
        if self.tick.is_multiple_of(FRAME) {
            self.controller.observe(percept(now, None)).unwrap();
        }
        self.controller.step(now, self.robot.measured()).unwrap();
        self.obey();
    }

    fn obey(&mut self) {
        let (command, torque) = (self.controller.controller().command(), self.controller.torque());
        self.robot.step(command, torque, &self.external, PERIOD, &mut self.noise).unwrap();
        self.tick += 1;
    }

    fn run(&mut self, seconds: f64) {
        let end = f64::from(self.tick) * PERIOD + seconds - 0.5 * PERIOD;
        while f64::from(self.tick) * PERIOD < end {
            self.step();
        }
    }

    fn tool(&self) -> Vector3<f64> {
        let mut data = Data::new(&MOCA);
        let posed = data.pose(&MOCA, self.robot.simulation().position()).unwrap();
        posed.world_from(MOCA.frame_id(MOCA_TOOL).unwrap()).unwrap().translation.vector
    }

    fn push(&mut self, force: Vector3<f64>) {
        let frame = MOCA.frame_id(MOCA_TOOL).unwrap();
        let wrench = Vector6::new(force.x, force.y, force.z, 0.0, 0.0, 0.0);
        self.external = vec![ExternalWrench { frame, wrench }];
    }

    fn state(&self) -> SafetyState {
        self.controller.controller().safety().supervisor().state()
    }

    fn cause(&self) -> Option<Fault> {
        self.controller.controller().safety().supervisor().unacknowledged()
    }

    fn excursion(&self) -> f64 {
        let desired = &self.controller.controller().command().joint_position;
        let joints = desired.iter().zip(self.robot.simulation().position()).skip(3);
        joints.fold(0.0, |most: f64, (desired, actual)| most.max((desired - actual).abs()))
    }
}

#[test]
fn the_tool_comes_to_its_place_under_torque() {
    let mut robot = Loop::new(ControllerSettings::default());
    let middle = robot.tool() + Vector3::new(1.0, 0.3, 0.1);
    robot.assign(middle);
    for _ in 0..8000 {
        robot.step();
        let felt = robot.controller.external_force().norm();
        assert!(felt < 30.0, "nobody pushes: {felt} N at tick {}", robot.tick);
    }
    assert_eq!(robot.state(), SafetyState::Normal);
    let controller = robot.controller.controller();
    let desired = controller.command().desired;
    assert!(controller.space().workspace().violation(&desired).amax() < 1e-3, "it is there");
    let gap = (desired.translation.vector - robot.tool()).norm();
    assert!(gap < 5e-3, "{gap} m");
}

/// The commanded state restarts from the measured one until the arm rests, not for as long as the base brakes. Its arm
/// would have no spring and sag.
#[test]
fn arm_keeps_its_place_while_base_brakes() {
    let mut settings = ControllerSettings::default();
    settings.desired.velocity = 1.4;
    settings.horizon = 5.0;
    settings.safety.supervisor.contact_force = 1e6;
    let mut robot = Loop::new(settings);
    let middle = robot.tool() + Vector3::new(5.0, 0.0, 0.0);
    robot.assign(middle);
    robot.run(3.5);
    let speed = |robot: &Loop| robot.robot.simulation().velocity()[0];
    assert!(speed(&robot) > 0.8, "{} m/s", speed(&robot));
    // A force holds the tool back for a moment.
    robot.push(Vector3::new(-250.0, 0.0, 0.0));
    while robot.state() != SafetyState::ProtectiveStop {
        robot.step();
    }
    assert_eq!(robot.cause(), Some(Fault::FollowingError));
    robot.external.clear();
    robot.run(0.4);
    let arm = |robot: &Loop| Vec::from(&robot.robot.simulation().position()[3..]);
    let before = arm(&robot);
    assert!(speed(&robot) > 0.4, "{} m/s", speed(&robot));
    // The push is that of a person who works on the object.
    robot.push(Vector3::new(15.0, 0.0, -15.0));
    robot.run(2.0);
    assert_eq!(robot.state(), SafetyState::ProtectiveStop);
    assert!(speed(&robot).abs() < 1e-3);
    for (joint, (before, after)) in before.iter().zip(arm(&robot)).enumerate() {
        // The bound is 11 Nm on a spring of 600 Nm/rad.
        assert!((after - before).abs() < 0.04, "joint {joint} from {before} to {after}");
    }
}

#[test]
fn hard_push_stops_arm_which_yields() {
    let mut robot = Loop::new(ControllerSettings::default());
    robot.run(0.5);
    // Forces of work do not stop the robot.
    robot.push(Vector3::new(25.0, -25.0, 0.0));
    robot.run(0.5);
    assert_eq!(robot.state(), SafetyState::Normal, "35 N are work");
    let felt = robot.controller.external_force();
    assert!((felt - Vector3::new(25.0, -25.0, 0.0)).norm() < 4.0, "{felt}");
    let start = robot.tool();
    robot.push(Vector3::new(0.0, 90.0, 0.0));
    let mut ticks = 0;
    while robot.state() != SafetyState::ProtectiveStop {
        robot.step();
        ticks += 1;
    }
    assert!(ticks < 60, "noticed after {ticks} ms");
    assert_eq!(robot.cause(), Some(Fault::ContactForce));
    robot.run(0.3);
    assert!(robot.tool().y > start.y + 0.01, "it gives way");
    robot.external.clear();
    robot.run(0.5);
    let there = robot.tool();
    robot.run(1.0);
    assert!((robot.tool() - there).norm() < 2e-3, "it stays where it was left");
    assert_eq!(robot.cause(), Some(Fault::ContactForce));
    robot.controller.controller_mut().safety_mut().supervisor_mut().acknowledge();
    robot.run(1.0);
    assert_eq!(robot.state(), SafetyState::Normal);
}

/// q* stays within the following-error limit for 3 s at a wall, and the robot jumps by at most 5 mm.
#[test]
fn tool_released_from_wall_does_not_jump() {
    let following_error = FollowingErrorSettings::default().revolute;
    for contact_force in [60.0, 1e6] {
        let mut settings = ControllerSettings::default();
        settings.safety.supervisor.contact_force = contact_force;
        let mut robot = Loop::new(settings);
        let start = robot.tool();
        let frame = MOCA.frame_id(MOCA_TOOL).unwrap();
        let wall = Contact::wall(frame, -Vector3::x_axis(), -(start.x + 0.05));
        robot.robot.simulation_mut().contacts_mut().push(wall);
        robot.assign(start + Vector3::new(1.0, 0.0, 0.0));
        robot.run(1.5);
        let mut excursion = 0.0_f64;
        for _ in 0..3000 {
            robot.step();
            excursion = excursion.max(robot.excursion());
        }
        assert!(robot.robot.simulation().contacts()[0].peak_force > 20.0, "it was at the wall");
        assert_eq!(robot.state(), SafetyState::ProtectiveStop);
        robot.robot.simulation_mut().contacts_mut().clear();
        let before = robot.tool();
        let mut jump = 0.0_f64;
        for _ in 0..1000 {
            robot.step();
            jump = jump.max((robot.tool() - before).norm());
            excursion = excursion.max(robot.excursion());
        }
        // The command of one period comes on top.
        assert!(excursion <= following_error + 2.61e-3 + 1e-3, "{excursion} rad");
        assert!(jump <= 5e-3, "{jump} m");
    }
}

#[test]
fn bad_measurement_leaves_arm_supporting_itself() {
    let mut robot = Loop::new(ControllerSettings::default());
    robot.assign(robot.tool() + Vector3::new(1.0, 0.0, 0.0));
    robot.run(1.5);
    for part in 0..3 {
        let mut copy = robot.robot.clone();
        let mut controller = robot.controller.clone();
        let before = copy.simulation().position().to_vec();
        let torque = controller.torque().to_vec();
        for tick in 0..200_u32 {
            copy.measure(&mut robot.noise).unwrap();
            let mut measured = copy.measured().clone();
            match part {
                0 => measured.position.fill(f64::NAN),
                1 => measured.velocity.fill(f64::NAN),
                _ => measured.torque.fill(Some(f64::NAN)),
            }
            let now = f64::from(robot.tick + tick) * PERIOD;
            let last = controller.torque().to_vec();
            controller.step(now, &measured).unwrap();
            for (torque, last) in controller.torque().iter().zip(&last) {
                assert!(torque.is_finite() && (torque - last).abs() <= 1.0 + 1e-12);
            }
            let command = controller.controller().command();
            assert_eq!(command.fault, Some(Fault::BadMeasurement));
            copy.step(command, controller.torque(), &[], PERIOD, &mut robot.noise).unwrap();
        }
        assert_eq!(torque.len(), 7);
        let supervisor = controller.controller().safety().supervisor();
        assert_eq!(supervisor.state(), SafetyState::ProtectiveStop);
        for (joint, (q, before)) in copy.simulation().position().iter().zip(&before).enumerate() {
            assert!((q - before).abs() < 0.3, "part {part}, joint {joint}: {before} to {q}");
        }
    }
}

#[test]
fn arm_without_measured_positions_stops() {
    for lost in [0..10, 4..5, 0..3] {
        let mut robot = Loop::new(ControllerSettings::default());
        robot.assign(robot.tool() + Vector3::new(1.0, 0.0, 0.0));
        robot.run(1.5);
        for _ in 0..3000 {
            robot.robot.measure(&mut robot.noise).unwrap();
            let mut measured = robot.robot.measured().clone();
            measured.position[lost.clone()].fill(f64::NAN);
            let now = f64::from(robot.tick) * PERIOD;
            robot.controller.step(now, &measured).unwrap();
            robot.obey();
        }
        let command = robot.controller.controller().command();
        assert_eq!(command.fault, Some(Fault::BadMeasurement));
        assert!(command.joint_velocity.iter().all(|velocity| *velocity == 0.0));
        let position = robot.robot.simulation().position();
        for (joint, (q, at)) in position.iter().zip(&command.joint_position).enumerate().skip(3) {
            assert!(
                (q - at).abs() < 0.02,
                "{lost:?}, joint {joint}: {at} commanded, {q} after 3 s"
            );
        }
    }
}

#[test]
fn a_tick_down_to_torque_allocates_nothing() {
    let mut robot = Loop::new(ControllerSettings::default());
    robot.assign(robot.tool() + Vector3::new(1.0, 0.0, 0.0));
    robot.push(Vector3::new(0.0, 100.0, 0.0));
    robot.run(0.1);
    let mut nan = robot.robot.measured().clone();
    nan.velocity.fill(f64::NAN);
    let count = allocation_counter::measure(|| {
        for _ in 0..300 {
            robot.robot.measure(&mut robot.noise).unwrap();
            let now = f64::from(robot.tick) * PERIOD;
            robot.controller.step(now, robot.robot.measured()).unwrap();
            nan.position.copy_from_slice(&robot.robot.measured().position);
            if robot.tick == 200 {
                robot.controller.step(now, &nan).unwrap();
            }
            robot.obey();
        }
    })
    .count_total;
    assert_eq!(count, 0);
}

#[test]
fn joints_that_nobody_knows_are_refused() {
    let ergonomics = ErgonomicsQuadratic::new(Matrix3::identity(), Vector3::zeros(), 1.0).unwrap();
    let new = |settings| {
        let controller =
            Controller::new(MOCA.clone(), ergonomics, ControllerSettings::default(), &MOCA_HOME);
        TorqueController::new(controller.unwrap(), settings).unwrap_err().to_string()
    };
    let default = || TorqueLoopSettings::new(Compensation::BARE);
    let error = new(TorqueLoopSettings { joints: Vec::new(), ..default() });
    assert!(error.contains("at least one"), "{error}");
    let mut settings = default();
    settings.joints[2] = "elbow".into();
    assert!(new(settings).contains("elbow"));
}

/// Losses are bridged as by libfranka's robots.
#[test]
fn lost_commands_are_bridged_until_robot_stops() {
    let mut robot = Loop::new(ControllerSettings::default());
    let middle = robot.tool() + Vector3::new(1.4, 0.3, 0.1);
    robot.assign(middle);
    robot.run(1.0);
    assert!(robot.robot.lose(1.5).is_err() && robot.robot.lose(f64::NAN).is_err());
    // Half of all commands are lost, but never twenty in a row. The robot follows.
    robot.robot.lose(0.5).unwrap();
    robot.run(1.0);
    assert!(
        !robot.robot.status().is_stopped() && robot.excursion() < 5e-3,
        "{}",
        robot.excursion()
    );
    assert_eq!((robot.state(), robot.cause()), (SafetyState::Normal, None));

    // All commands are lost. After twenty the robot brakes by itself and the controller is informed.
    let speed = |robot: &Loop| {
        let velocity = robot.robot.simulation().velocity().iter();
        velocity.fold(0.0, |most: f64, velocity| most.max(velocity.abs()))
    };
    assert!(speed(&robot) > 0.1, "it moves: {}", speed(&robot));
    robot.robot.lose(1.0).unwrap();
    let step = |robot: &mut Loop| {
        if robot.robot.status().is_stopped() {
            robot.controller.controller_mut().robot_stopped();
        }
        robot.step();
    };
    for tick in 1..3000 {
        step(&mut robot);
        assert_eq!(robot.robot.status().is_stopped(), tick >= 20, "tick {tick}");
        let expected = if tick > 20 { SafetyState::ProtectiveStop } else { SafetyState::Normal };
        assert_eq!(robot.state(), expected, "tick {tick}");
    }
    assert_eq!(robot.cause(), Some(Fault::RobotStopped));
    assert!(speed(&robot) < 1e-3, "it stands: {}", speed(&robot));

    // A recovered robot makes up for nothing; after the acknowledgement it goes on.
    let at = robot.tool();
    robot.robot.lose(0.0).unwrap();
    robot.robot.recover();
    robot.run(0.5);
    assert!((robot.tool() - at).norm() < 5e-3, "{} m", (robot.tool() - at).norm());
    let supervisor = robot.controller.controller_mut().safety_mut().supervisor_mut();
    supervisor.acknowledge();
    robot.assign(at + Vector3::new(-1.0, 0.0, 0.0));
    robot.run(3.0);
    assert_eq!(robot.state(), SafetyState::Normal);
    assert!((robot.tool() - at).norm() > 0.1, "{} m", (robot.tool() - at).norm());
}

/// A robot that has stopped by itself gets no command to move when it takes commands again.
#[test]
fn command_restarts_at_rest_after_robot_stop() {
    let mut robot = Loop::new(ControllerSettings::default());
    let middle = robot.tool() + Vector3::new(2.0, 0.5, 0.1);
    robot.assign(middle);
    robot.run(2.0);
    assert!(robot.robot.simulation().velocity()[0] > 0.1);
    robot.robot.lose(1.0).unwrap();
    for _ in 0..300 {
        if robot.robot.status().is_stopped() {
            robot.controller.controller_mut().robot_stopped();
        }
        robot.step();
    }
    robot.robot.lose(0.0).unwrap();
    robot.robot.recover();
    for _ in 0..500 {
        let before = robot.robot.simulation().velocity().to_vec();
        robot.step();
        let now = robot.robot.simulation().velocity();
        for (joint, (now, before)) in now.iter().zip(&before).enumerate().take(3) {
            // The robot still brakes by itself at its limit, and is not pushed on.
            let faster = (now.abs() - before.abs()) / PERIOD;
            assert!(faster < 0.6, "joint {joint} is driven at {faster} m/s²");
        }
    }
}

/// Gravity is added once, either by the robot or by the controller. If both add it, the arm goes up.
#[test]
fn gravity_is_added_by_one_of_both() {
    for (compensation, robot_adds, stays) in [
        (Compensation::FRANKA, true, true),
        (Compensation::BARE, false, true),
        (Compensation::BARE, true, false),
        (Compensation::FRANKA, false, false),
    ] {
        let mut robot = Loop::new(ControllerSettings::default());
        let settings = TorqueLoopSettings::new(compensation);
        let controller = robot.controller.controller().clone();
        robot.controller = TorqueController::new(controller, settings).unwrap();
        let start = robot.tool();
        let mut data = Data::new(&MOCA);
        let mut gravity = vec![0.0; 10];
        for _ in 0..1000 {
            robot.robot.measure(&mut robot.noise).unwrap();
            let now = f64::from(robot.tick) * PERIOD;
            robot.controller.step(now, robot.robot.measured()).unwrap();
            let mut torque = robot.controller.torque().to_vec();
            if robot_adds {
                let position = robot.robot.simulation().position();
                data.pose(&MOCA, position).unwrap().gravity_into(&mut gravity).unwrap();
                torque.iter_mut().zip(&gravity[3..]).for_each(|(own, gravity)| *own += gravity);
            }
            let command = robot.controller.controller().command();
            robot.robot.step(command, &torque, &[], PERIOD, &mut robot.noise).unwrap();
            robot.tick += 1;
        }
        let gone = (robot.tool() - start).norm();
        assert_eq!(gone < 5e-3, stays, "{compensation:?}, {robot_adds}: {gone} m");
    }
}
