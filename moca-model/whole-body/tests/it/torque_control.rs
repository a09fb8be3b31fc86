//! A Panda under torque control follows, supports itself, is held and released.

use nalgebra::{Point3, Vector3};
use whole_body::simulation::{
    Contact, JointDrive, RandomSource, RigidBodySimulation, SensorSettings, Sensors, Transmission,
};
use whole_body::stack::TaskId;
use whole_body::tasks::{OrientationTask, PositionTask, PostureTask};
use whole_body::torque::{
    Compensation, Following, FollowingErrorSettings, ImpedanceSettings, JointState, TorqueControl,
    TorqueSettings,
};
use whole_body::{Data, Description, Error, Ik, Model};

use crate::momentum::{HOME, arm};
use crate::simulation::Noise;
use crate::support::stacks::Random;

const PERIOD: f64 = 1e-3;

/// A Panda with friction and rotors, noisy and late sensors, lost commands, and a stack that moves the tool.
struct Loop {
    model: Model,
    ik: Ik,
    tool: TaskId<PositionTask>,
    control: TorqueControl,
    robot: RigidBodySimulation,
    sensors: Sensors,
    commands: Transmission,
    noise: Noise,
    /// True if the robot did not follow. It then stays where it is.
    held: bool,
    torque: Vec<f64>,
}

impl Loop {
    fn new(settings: TorqueSettings) -> Self {
        let model = arm(true);
        let frame = model.frame_id("panda_tcp").unwrap();
        let mut builder = Ik::builder(&model);
        let tool = builder.push("tool", PositionTask::new(frame));
        builder.push("orientation", OrientationTask::new(frame));
        builder.push("posture", PostureTask::new());
        let drives = [JointDrive::Torque { rotor_inertia: 0.1 }; 7];
        let sensors = SensorSettings {
            position_noise: vec![2e-5; 7],
            velocity_noise: vec![2e-3; 7],
            torque_noise: vec![0.05; 7],
            delay: 1,
            loss: 0.01,
        };
        let mut torque = vec![0.0; 7];
        let mut data = Data::new(&model);
        data.pose(&model, &HOME).unwrap().gravity_into(&mut torque).unwrap();
        Self {
            ik: builder.build_at(&HOME).unwrap(),
            control: TorqueControl::new(&model, settings, &HOME).unwrap(),
            robot: RigidBodySimulation::new(&model, &drives, &HOME).unwrap(),
            sensors: Sensors::new(sensors, &HOME).unwrap(),
            commands: Transmission::new(0, 0.01, &torque).unwrap(),
            noise: Noise(Random(7)),
            held: false,
            tool,
            torque,
            model,
        }
    }

    /// One period towards a target at rest.
    fn step(&mut self, target: Point3<f64>) {
        self.step_along(target, Vector3::zeros());
    }

    /// One period towards a target that moves at `velocity` \[m/s\].
    fn step_along(&mut self, target: Point3<f64>, velocity: Vector3<f64>) {
        self.sensors.measure(&self.robot, &mut self.noise).unwrap();
        let task = self.ik.task_mut(self.tool).unwrap();
        task.set_moving_target(target, velocity).unwrap();
        self.held |= self.control.following() != Following::Follows;
        let velocity = if self.held {
            self.ik.brake(PERIOD).unwrap()
        } else {
            self.ik.step(self.control.desired(), PERIOD).unwrap().velocity()
        };
        let measured =
            JointState { position: self.sensors.position(), velocity: self.sensors.velocity() };
        let torque = self.control.step(velocity, measured, 0.0, PERIOD).unwrap();
        for (joint, (torque, last)) in torque.iter().zip(&self.torque).enumerate() {
            assert!(torque.abs() <= self.model.limits()[joint].effort);
            assert!((torque - last).abs() <= 1.0 + 1e-12, "at most 1000 Nm/s");
        }
        self.torque.copy_from_slice(torque);
        let torque = self.commands.pass(torque, self.noise.uniform()).unwrap();
        self.robot.step(torque, &[], PERIOD).unwrap();
    }

    fn point(&self, q: &[f64]) -> Point3<f64> {
        let mut data = Data::new(&self.model);
        let frame = self.model.frame_id("panda_tcp").unwrap();
        let pose = data.pose(&self.model, q).unwrap().world_from(frame).unwrap();
        pose.translation.vector.into()
    }

    fn excursion(&self) -> f64 {
        let joints = self.control.desired().iter().zip(self.robot.position());
        joints.fold(0.0, |most, (desired, actual)| most.max((desired - actual).abs()))
    }
}

/// Root mean square errors are at most 1 mm for the command and 5 mm for the robot, with friction and noise.
#[test]
fn torque_control_follows_a_circle() {
    for radius in [0.1, 0.2] {
        let mut panda = Loop::new(TorqueSettings::new(Compensation::BARE));
        let start = panda.point(&HOME);
        let (mut commanded, mut actual) = (0.0, 0.0);
        let (mut angle, mut rate) = (0.0_f64, 0.0_f64);
        let mut ticks = 0;
        while angle < 1.5 * std::f64::consts::TAU {
            rate = (rate + PERIOD * 0.5 / radius).min(0.25 / radius); // it speeds up with 0.5 m/s²
            angle += rate * PERIOD;
            let target = start + radius * Vector3::new(0.0, angle.sin(), angle.cos() - 1.0);
            let along = Vector3::new(0.0, angle.cos(), -angle.sin());
            panda.step_along(target, radius * rate * along);
            if angle > 0.5 * std::f64::consts::TAU {
                commanded += (panda.point(panda.control.desired()) - target).norm_squared();
                actual += (panda.point(panda.robot.position()) - target).norm_squared();
                ticks += 1;
            }
        }
        assert!(!panda.held);
        let rms = |sum: f64| 1e3 * (sum / f64::from(ticks)).sqrt();
        assert!(rms(commanded) < 1.0, "{} mm commanded", rms(commanded));
        assert!(rms(actual) < 5.0, "{} mm actual", rms(actual));
    }
}

/// q* stays within the following-error limit for 3 s at a wall, and the robot jumps by at most 5 mm.
#[test]
fn arm_released_from_wall_does_not_jump() {
    let mut panda = Loop::new(TorqueSettings::new(Compensation::BARE));
    panda
        .control
        .limit_following_error(FollowingErrorSettings { revolute: 0.05, prismatic: 0.1 })
        .unwrap();
    let start = panda.point(&HOME);
    let tool = panda.model.frame_id("panda_tcp").unwrap();
    let wall = Contact::wall(tool, -Vector3::x_axis(), -(start.x + 0.1));
    panda.robot.contacts_mut().push(wall);
    let mut excursion = 0.0_f64;
    for tick in 0..3000 {
        let way = (1e-3 * f64::from(tick) * 0.2).min(0.25); // 0.2 m/s, to 0.15 m behind the wall
        panda.step(start + Vector3::new(way, 0.0, 0.0));
        excursion = excursion.max(panda.excursion());
    }
    assert!(panda.held && panda.robot.contacts()[0].peak_force > 20.0, "it was at the wall");
    panda.robot.contacts_mut().clear();
    let before = panda.point(panda.robot.position());
    let mut jump = 0.0_f64;
    for _ in 0..1000 {
        panda.step(start);
        jump = jump.max((panda.point(panda.robot.position()) - before).norm());
        excursion = excursion.max(panda.excursion());
    }
    // The command of one period may come on top, and noise.
    assert!(excursion <= 0.05 + 2.61e-3 + 1e-4, "{excursion} rad");
    assert!(jump <= 5e-3, "{jump} m");
}

#[test]
fn an_arm_that_is_to_stay_stays() {
    let mut panda = Loop::new(TorqueSettings::new(Compensation::BARE));
    let start = panda.point(&HOME);
    for _ in 0..1000 {
        panda.step(start);
    }
    assert!((panda.point(panda.robot.position()) - start).norm() < 1e-4);
}

#[test]
fn yielding_arm_follows_the_pushing_hand() {
    let mut panda = Loop::new(TorqueSettings::new(Compensation::BARE));
    let start = panda.point(&HOME);
    let tool = panda.model.frame_id("panda_tcp").unwrap();
    let push = nalgebra::Vector6::new(0.0, 20.0, 0.0, 0.0, 0.0, 0.0);
    let push = [whole_body::state::ExternalWrench { frame: tool, wrench: push }];
    for _ in 0..500 {
        panda.control.give_way();
        let measured =
            JointState { position: panda.robot.position(), velocity: panda.robot.velocity() };
        let torque = panda.control.step(&[0.0; 7], measured, 0.0, PERIOD).unwrap();
        panda.robot.step(torque, &push, PERIOD).unwrap();
        assert!(panda.excursion() < 2e-3);
    }
    assert!(panda.point(panda.robot.position()).y > start.y + 0.02, "it gives way");
}

#[test]
fn what_torque_control_cannot_use() {
    let model = arm(false);
    let new = |settings| TorqueControl::new(&model, settings, &HOME);
    let default = || TorqueSettings::new(Compensation::BARE);
    let error = new(TorqueSettings { joints: vec!["elbow".into()], ..default() }).unwrap_err();
    assert!(matches!(error, Error::UnknownName { .. }));
    let error =
        new(TorqueSettings { joints: vec!["panda_joint4".into()], ..default() }).unwrap_err();
    assert!(matches!(error, Error::Size { what: "stiffness", got: 7, wanted: 1 }));
    assert!(TorqueControl::new(&model, default(), &[0.0; 6]).is_err());
    let mut control = new(default()).unwrap();
    for [revolute, prismatic] in [[0.0, 0.1], [f64::NAN, 0.1]] {
        let refused = control.limit_following_error(FollowingErrorSettings { revolute, prismatic });
        assert!(matches!(refused, Err(Error::Value { .. })));
    }
    let rest = JointState { position: &HOME, velocity: &[0.0; 7] };
    let nan = JointState { position: &[f64::NAN; 7], velocity: &[0.0; 7] };
    assert!(control.step(&[0.0; 7], nan, 0.0, PERIOD).is_err());
    assert!(control.step(&[f64::INFINITY; 7], rest, 0.0, PERIOD).is_err());
    assert!(control.step(&[0.0; 6], rest, 0.0, PERIOD).is_err());
    assert!(control.step(&[0.0; 7], rest, 0.0, -1.0).is_err());
    assert_eq!(control.desired(), HOME);
    // Only one joint has a torque drive. The desired position of the others is the measured one.
    let impedance = ImpedanceSettings {
        stiffness: vec![600.0],
        damping: vec![20.0],
        ..ImpedanceSettings::default()
    };
    let joints = vec!["panda_joint4".to_owned()];
    let mut elbow = new(TorqueSettings { joints, impedance, ..default() }).unwrap();
    let mut moved = HOME;
    moved[0] = 0.05;
    let state = JointState { position: &moved, velocity: &[0.0; 7] };
    assert_eq!(elbow.step(&[0.1; 7], rest, 0.0, PERIOD).unwrap().len(), 1);
    elbow.step(&[0.1; 7], state, 0.0, PERIOD).unwrap();
    assert_eq!(elbow.desired()[0], 0.05);
    assert!((elbow.desired()[3] - HOME[3] - 2e-4).abs() < 1e-12);
}

/// A cart that slides along y and carries a hinge about z, whose link points along x.
const CART: &str = r#"<robot name="cart"><link name="world"/>
  <link name="cart"><inertial><mass value="20"/>
    <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="link"><inertial><origin xyz="0.5 0 0"/><mass value="5"/>
    <inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="slide" type="prismatic"><parent link="world"/><child link="cart"/><axis xyz="0 1 0"/>
    <limit lower="-9" upper="9" velocity="2" effort="500"/></joint>
  <joint name="hinge" type="revolute"><parent link="cart"/><child link="link"/><axis xyz="0 0 1"/>
    <limit lower="-2" upper="2" velocity="2" effort="50"/></joint></robot>"#;

/// The spring alone would be deflected by 5 kg · 0.5 m · 0.5 m/s² / 100 Nm/rad = 12.5 mrad.
#[test]
fn accelerating_base_does_not_push_arm() {
    let model = Model::from_urdf(CART, &Description::default()).unwrap();
    let settings = TorqueSettings {
        joints: vec!["hinge".into()],
        impedance: ImpedanceSettings {
            stiffness: vec![100.0],
            damping: vec![20.0],
            ..ImpedanceSettings::default()
        },
        ..TorqueSettings::new(Compensation::BARE)
    };
    let mut control = TorqueControl::new(&model, settings, &[0.0; 2]).unwrap();
    let drives =
        [JointDrive::Velocity { time_constant: 0.03 }, JointDrive::Torque { rotor_inertia: 0.1 }];
    let mut robot = RigidBodySimulation::new(&model, &drives, &[0.0; 2]).unwrap();
    let mut speed = 0.0;
    for tick in 0..1_000 {
        speed += 0.5 * PERIOD;
        let measured = JointState { position: robot.position(), velocity: robot.velocity() };
        let torque = control.step(&[speed, 0.0], measured, 0.0, PERIOD).unwrap()[0];
        robot.step(&[speed, torque], &[], PERIOD).unwrap();
        if tick > 300 {
            assert!(robot.position()[1].abs() < 1e-3, "{} rad", robot.position()[1]);
        }
    }
}

/// A joint that follows velocities moves on at its own in the time without measurements.
#[test]
fn joints_without_torque_drives_are_predicted_too() {
    let model = arm(false);
    let impedance = ImpedanceSettings {
        stiffness: vec![600.0],
        damping: vec![20.0],
        ..ImpedanceSettings::default()
    };
    let joints = vec!["panda_joint4".to_owned()];
    let settings = TorqueSettings { joints, impedance, ..TorqueSettings::new(Compensation::BARE) };
    let mut control = TorqueControl::new(&model, settings, &HOME).unwrap();
    let mut velocity = [0.0; 7];
    velocity[0] = 0.1;
    let mut position = HOME;
    for _ in 0..5 {
        position[0] += 0.1 * PERIOD;
        let measured = JointState { position: &position, velocity: &velocity };
        control.step(&velocity, measured, 0.0, PERIOD).unwrap();
    }
    for tick in 1..=2 {
        let measured = JointState { position: &position, velocity: &velocity };
        control.step(&velocity, measured, PERIOD * f64::from(tick), PERIOD).unwrap();
        let expected = position[0] + 0.1 * PERIOD * f64::from(tick);
        assert!((control.desired()[0] - expected).abs() < 1e-12, "after {tick} ms");
    }
}
