//! Measurements that stop, freeze, come late or seldom, of a simulated robot whose true state is judged.

use ergo_map::ErgonomicsQuadratic;
use hrsw::{Attachment, Fault};
use moca_model::whole_body::{Compensation, RandomSource};
use moca_model::{
    Controller, ControllerSettings, DynamicRobot, DynamicRobotSettings, MOCA_HOME, Measured,
    TorqueController, TorqueLoopSettings,
};
use nalgebra::{Isometry3, Matrix3, UnitQuaternion, Vector3};

use crate::drive::{FRAME, PERIOD, percept};
use crate::shared::MOCA;
use crate::torque::Noise;

/// What measurements do from a tick on.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Trouble {
    None,
    /// Nothing comes for so many ticks.
    Silent(u32),
    /// The same comes for so many ticks.
    Frozen(u32),
}

/// A robot that is always on its way to another place.
#[derive(Clone)]
struct Moving {
    controller: TorqueController,
    robot: DynamicRobot,
    noise: Noise,
    tick: u32,
    /// A measurement comes in every so many ticks.
    every: u32,
    position: Vec<f64>,
    velocity: Vec<f64>,
    torque: Vec<Option<f64>>,
    age: f64,
    worst_error: f64,
}

impl Moving {
    fn new(delay: usize, every: u32, seed: u64) -> Self {
        let comfort = ErgonomicsQuadratic::new(Matrix3::identity(), Vector3::zeros(), 1.0).unwrap();
        let mut settings = ControllerSettings::default();
        settings.desired.velocity = 1.0;
        settings.desired.angular_velocity = 2.0;
        let controller = Controller::new(MOCA.clone(), comfort, settings, &MOCA_HOME).unwrap();
        let settings = DynamicRobotSettings { delay, loss: 0.0, ..DynamicRobotSettings::default() };
        Self {
            controller: TorqueController::new(
                controller,
                TorqueLoopSettings::new(Compensation::BARE),
            )
            .unwrap(),
            robot: DynamicRobot::new(&MOCA, &settings, &MOCA_HOME).unwrap(),
            noise: Noise(seed),
            tick: 0,
            every,
            position: MOCA_HOME.to_vec(),
            velocity: vec![0.0; 10],
            torque: vec![Some(0.0); 10],
            age: 0.0,
            worst_error: 0.0,
        }
    }

    fn wander(&mut self) {
        let mut random = |scale: f64| scale * (2.0 * self.noise.uniform() - 1.0);
        let place = Vector3::new(0.6 + random(0.5), random(0.6), 0.8 + random(0.35));
        let turn =
            UnitQuaternion::from_scaled_axis(Vector3::new(random(0.6), random(0.6), random(0.8)));
        let space = self.controller.controller().space().workspace();
        let rotation = turn * space.world_from_workspace().rotation;
        let centre = (space.position().min() + space.position().max()) * 0.5;
        let pose = Isometry3::from_parts((place - rotation * centre).into(), rotation);
        let space = self.controller.controller_mut().space_mut();
        space.assign(Some(Attachment::World(pose))).unwrap();
    }

    fn step(&mut self, trouble: Trouble) {
        if self.tick.is_multiple_of(700) && trouble == Trouble::None {
            self.wander();
        }
        self.robot.measure(&mut self.noise).unwrap();
        let comes = self.tick.is_multiple_of(self.every);
        match trouble {
            Trouble::None if comes => {
                let measured = self.robot.measured();
                self.position.copy_from_slice(measured.position);
                self.velocity.copy_from_slice(measured.velocity);
                self.torque.copy_from_slice(measured.torque);
                self.age = 0.0;
            }
            Trouble::Frozen(_) => self.age = 0.0,
            _ => self.age += PERIOD,
        }
        let now = f64::from(self.tick) * PERIOD;
        if self.tick.is_multiple_of(FRAME) {
            self.controller.observe(&percept(now, None)).unwrap();
        }
        let measured = Measured {
            position: &self.position,
            velocity: &self.velocity,
            torque: &self.torque,
            age: self.age,
        };
        self.controller.step(now, &measured).unwrap();
        let (command, torque) = (self.controller.controller().command(), self.controller.torque());
        self.robot.step(command, torque, &[], PERIOD, &mut self.noise).unwrap();
        let desired = command.joint_position.iter().zip(self.robot.simulation().position()).skip(3);
        let error = desired.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        self.worst_error = self.worst_error.max(error);
        self.tick += 1;
    }

    fn fault(&self) -> Option<Fault> {
        self.controller.controller().command().fault
    }

    fn speeds(&self) -> Vec<f64> {
        self.robot.simulation().velocity().iter().skip(3).map(|v| v.abs()).collect()
    }
}

#[test]
fn explore() {
    for (delay, every, known) in [
        (0, 1, 0),
        (1, 1, 1),
        (2, 1, 2),
        (3, 1, 3),
        (4, 1, 4),
        (5, 1, 5),
        (6, 1, 6),
        (8, 1, 8),
        (1, 4, 1),
        (4, 2, 4),
        (4, 4, 4),
        (1, 4, 0),
        (2, 1, 1),
        (3, 1, 2),
        (4, 1, 3),
        (5, 1, 4),
    ] {
        let mut robot = Moving::new(delay, every, 7);
        robot.controller.set_delay(1e-3 * f64::from(known));
        let mut fastest = 0.0_f64;
        let mut rough = 0.0_f64;
        let mut faults = std::collections::BTreeMap::new();
        for _ in 0..6000 {
            let before = robot.speeds();
            robot.step(Trouble::None);
            fastest = robot.speeds().into_iter().fold(fastest, f64::max);
            rough += robot.speeds().iter().zip(before).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
            if let Some(f) = robot.fault() {
                *faults.entry(f.to_string()).or_insert(0) += 1;
            }
        }
        println!(
            "delay {delay} every {every} known {known}: fastest {fastest:.2} error {:.4} rough {:.5} faults {faults:?}",
            robot.worst_error,
            (rough / 6000.0).sqrt()
        );
    }
    {
        let mut robot = Moving::new(1, 1, 9);
        let mut best = (0.0, None, 0usize, 0u32);
        for _ in 0..50 {
            for _ in 0..170 {
                robot.step(Trouble::None);
            }
            let mut copy = robot.clone();
            let before = copy.speeds();
            for tick in 0..100u32 {
                copy.step(Trouble::Silent(100));
                for (joint, (now, before)) in copy.speeds().iter().zip(&before).enumerate() {
                    let beyond = now - (1.2 * before + 0.1);
                    if beyond > best.0 {
                        best = (beyond, Some(robot.clone()), joint, tick);
                    }
                }
            }
        }
        println!("worst {} joint {} tick {}", best.0, best.2, best.3);
        let mut copy = best.1.unwrap();
        for tick in 0..100u32 {
            copy.step(Trouble::Silent(100));
            if tick < 60 && tick % 4 == 0 {
                let c = copy.controller.controller().command();
                println!(
                    "{tick} true {:.2?} told {:.3?}",
                    &copy.robot.simulation().velocity()[..6],
                    &c.joint_velocity[..6]
                );
                println!("    torque {:.2?} {:?}", copy.controller.torque(), c.fault);
            }
        }
    }
    for (trouble, after) in [
        (Trouble::Silent(3), 0),
        (Trouble::Silent(5), 0),
        (Trouble::Silent(19), 100),
        (Trouble::Silent(100), 100),
        (Trouble::Silent(400), 100),
        (Trouble::Frozen(3), 0),
        (Trouble::Frozen(100), 100),
        (Trouble::Frozen(400), 100),
    ] {
        let mut robot = Moving::new(1, 1, 9);
        let mut worst = (0.0_f64, 0.0, 0.0, 0u32, 0usize);
        let (mut latest, mut none) = (0, 0);
        for _ in 0..50 {
            for _ in 0..170 {
                robot.step(Trouble::None);
            }
            let mut copy = robot.clone();
            let before = copy.speeds();
            let ticks = match trouble {
                Trouble::Silent(t) | Trouble::Frozen(t) => t,
                Trouble::None => 0,
            };
            let mut first = None;
            for tick in 0..ticks + after {
                copy.step(if tick < ticks { trouble } else { Trouble::None });
                for (joint, (now, before)) in copy.speeds().iter().zip(&before).enumerate() {
                    let beyond = now - (1.2 * before + 0.1);
                    if beyond > worst.0 {
                        worst = (beyond, *now, *before, tick, joint);
                    }
                }
                if copy.fault().is_some() && first.is_none() {
                    first = Some(tick);
                }
            }
            match first {
                Some(t) => latest = latest.max(t),
                None => none += 1,
            }
        }
        println!(
            "{trouble:?}: worst beyond {worst:.3?}; fault at most at {latest}, none in {none}"
        );
    }
}
