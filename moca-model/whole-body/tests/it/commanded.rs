//! Commands wait for a robot that is held, and brake if nothing can be computed.

use nalgebra::{Point3, UnitQuaternion, Vector3};
use proptest::prelude::*;
use whole_body::ik::{Commanded, FollowingErrorLimit};
use whole_body::robot::JointKind;
use whole_body::stack::TaskId;
use whole_body::tasks::{FrameTask, PositionTask, PostureTask};
use whole_body::{Error, Ik, Model};

use crate::support::pose;
use crate::support::stacks::{PERIOD, Random, humanoid, panda};

const HOME: [f64; 7] = [0.0, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785];

fn robot(model: &Model) -> (Commanded, TaskId<PositionTask>) {
    let tool = model.frame_id("panda_hand_tcp").unwrap();
    let mut builder = Ik::builder(model);
    let position = builder.push("position", PositionTask::new(tool));
    let posture = builder.push("posture", PostureTask::new());
    let mut ik = builder.build().unwrap();
    ik.task_mut(posture).unwrap().set_target(&HOME).unwrap();
    (Commanded::new(ik, &HOME, FollowingErrorLimit::default()).unwrap(), position)
}

/// Checks of velocities, accelerations and jerks of commands against the model.
struct Watch {
    model: Model,
    last: [Vec<f64>; 3],
}

impl Watch {
    fn new(model: &Model) -> Self {
        let rest = vec![0.0; 7];
        Self { model: model.clone(), last: [HOME.to_vec(), rest.clone(), rest] }
    }

    fn check(&mut self, position: &[f64], period: f64) {
        let rates = |now: &[f64], before: &[f64]| -> Vec<f64> {
            now.iter().zip(before).map(|(now, before)| (now - before) / period).collect()
        };
        let velocity = rates(position, &self.last[0]);
        let acceleration = rates(&velocity, &self.last[1]);
        let jerk = rates(&acceleration, &self.last[2]);
        for (entry, limits) in self.model.limits().iter().enumerate() {
            assert!(velocity[entry].abs() <= limits.velocity * (1.0 + 1e-7));
            assert!(acceleration[entry].abs() <= limits.acceleration * (1.0 + 1e-6));
            assert!(jerk[entry].abs() <= limits.jerk * (1.0 + 1e-6) + 1e-3, "{}", jerk[entry]);
            assert!(
                position[entry] <= limits.upper + 1e-9 && position[entry] >= limits.lower - 1e-9
            );
        }
        self.last = [position.to_vec(), velocity, acceleration];
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// The robot follows with a lag, is held for some time, and is released.
    #[test]
    fn a_held_robot_is_waited_for(seed in any::<u64>(), lag in 0.002..0.02_f64) {
        let model = panda();
        let tool = model.frame_id("panda_hand_tcp").unwrap();
        let (mut robot, position) = robot(&model);
        let mut random = Random(seed);
        let shift = Vector3::from_fn(|_, _| random.within(-0.4, 0.4));
        let goal = pose(&model, &HOME, tool).translation.vector + shift;
        robot.ik_mut().task_mut(position).unwrap().set_target(Point3::from(goal)).unwrap();
        let (mut measured, mut watch) = (HOME.to_vec(), Watch::new(&model));
        let begin = 50 + usize::try_from(seed % 300).unwrap();
        let mut farthest = 0.0_f64;
        for tick in 0..2500 {
            let command = robot.step(&measured, PERIOD);
            prop_assert!(command.fault.is_none());
            watch.check(command.position, PERIOD);
            let is_held = tick >= begin && tick < begin + 1200;
            for (measured, commanded) in measured.iter_mut().zip(command.position) {
                if !is_held {
                    *measured += (commanded - *measured) * PERIOD / lag;
                }
                if tick > begin + 600 {
                    farthest = farthest.max((commanded - *measured).abs());
                }
            }
        }
        prop_assert!(farthest <= 0.1 + 1e-6, "{}", farthest);
        // The released robot goes on.
        let apart = measured.iter().zip(robot.position()).map(|(a, b)| (a - b).abs());
        prop_assert!(apart.fold(0.0, f64::max) < 0.1);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// The robot stops suddenly at a random moment.
    #[test]
    fn sudden_stop_is_overrun_within_the_bound(seed in any::<u64>(), begin in 50..900_u32) {
        let model = panda();
        let tool = model.frame_id("panda_hand_tcp").unwrap();
        let (mut robot, position) = robot(&model);
        let mut random = Random(seed);
        let shift = Vector3::from_fn(|_, _| random.within(-0.8, 0.8));
        let goal = pose(&model, &HOME, tool).translation.vector + shift;
        robot.ik_mut().task_mut(position).unwrap().set_target(goal).unwrap();
        let bounds = model.limits().iter().map(|limits| {
            FollowingErrorLimit::default().bound(JointKind::Revolute, limits)
        });
        let bounds: Vec<f64> = bounds.collect();
        let mut measured = HOME.to_vec();
        for tick in 0..1800 {
            let command = robot.step(&measured, PERIOD);
            for ((measured, commanded), bound) in measured.iter_mut().zip(command.position).zip(&bounds) {
                prop_assert!((commanded - *measured).abs() <= *bound);
                if tick < begin {
                    *measured += (commanded - *measured) * PERIOD / 0.02;
                }
            }
        }
        // In the end the command waits at the following-error limit.
        let apart = measured.iter().zip(robot.position()).map(|(a, b)| (a - b).abs());
        prop_assert!(apart.fold(0.0, f64::max) <= 0.1 + 1e-6);
    }
}

#[test]
fn a_following_robot_is_never_slowed() {
    let model = panda();
    let tool = model.frame_id("panda_hand_tcp").unwrap();
    let (mut robot, position) = robot(&model);
    let goal = pose(&model, &HOME, tool).translation.vector + Vector3::new(-0.2, 0.5, 0.0);
    robot.ik_mut().task_mut(position).unwrap().set_target(Point3::from(goal)).unwrap();
    let (mut measured, mut q) = (HOME.to_vec(), HOME.to_vec());
    let mut builder = Ik::builder(&model);
    let alone = builder.push("position", PositionTask::new(tool));
    let posture = builder.push("posture", PostureTask::new());
    let mut ik = builder.build().unwrap();
    ik.task_mut(alone).unwrap().set_target(Point3::from(goal)).unwrap();
    ik.task_mut(posture).unwrap().set_target(&HOME).unwrap();
    for _ in 0..1500 {
        let command = robot.step(&measured, PERIOD);
        ik.step(&q, PERIOD).unwrap().integrate(&mut q).unwrap();
        for ((measured, commanded), alone) in measured.iter_mut().zip(command.position).zip(&q) {
            *measured += (commanded - *measured) * PERIOD / 0.02;
            assert!((commanded - alone).abs() < 1e-6);
        }
    }
}

#[test]
fn what_cannot_be_computed_brakes_and_says_why() {
    let model = panda();
    let tool = model.frame_id("panda_hand_tcp").unwrap();
    let (mut robot, position) = robot(&model);
    let goal = pose(&model, &HOME, tool).translation.vector + Vector3::new(0.0, 0.5, 0.0);
    robot.ik_mut().task_mut(position).unwrap().set_target(Point3::from(goal)).unwrap();
    let (mut measured, mut watch) = (HOME.to_vec(), Watch::new(&model));
    for _ in 0..150 {
        let command = robot.step(&measured, PERIOD);
        watch.check(command.position, PERIOD);
        measured.copy_from_slice(command.position);
    }
    let bad = [f64::NAN; 7];
    for tick in 0..1000 {
        let command = robot.step(&bad, PERIOD);
        let fault = command.fault.unwrap().to_string();
        assert!(matches!(command.fault, Some(Error::Braking { .. })));
        assert!(fault.contains("brakes") && fault.contains("panda_joint1"), "{fault}");
        assert!(tick < 900 || command.velocity.iter().all(|v| v.abs() < 1e-9));
        watch.check(command.position, PERIOD);
    }
    let before = robot.position().to_vec();
    for period in [0.0, -1e-3, f64::NAN, f64::INFINITY] {
        assert!(robot.step(&measured, period).fault.is_some());
    }
    assert_eq!(robot.position(), before);
    for _ in 0..300 {
        let command = robot.step(&before, PERIOD);
        assert!(command.fault.is_none());
        watch.check(command.position, PERIOD);
    }
}

/// A humanoid that stands on its feet, with a task for one tool.
fn standing(model: &Model, shift: Vector3<f64>) -> Commanded {
    let q = model.neutral();
    let mut builder = Ik::builder(model);
    for foot in ["left_foot", "right_foot"] {
        builder.push(foot, FrameTask::new(model.frame_id(foot).unwrap()));
    }
    let tool = model.frame_id("left_hand").unwrap();
    let reach = builder.push("tool", PositionTask::new(tool));
    builder.push("posture", PostureTask::new());
    let mut ik = builder.build_at(&q).unwrap();
    let goal = pose(model, &q, tool).translation.vector + shift;
    ik.task_mut(reach).unwrap().set_target(goal).unwrap();
    Commanded::new(ik, &q, FollowingErrorLimit::default()).unwrap()
}

#[test]
fn the_command_of_a_floating_base_waits_too() {
    let model = humanoid();
    // Only the following-error limit holds the base.
    let base = model.frame_id("pelvis").unwrap();
    let mut builder = Ik::builder(&model);
    let task = builder.push("base", FrameTask::new(base));
    builder.push("posture", PostureTask::new());
    let q = model.neutral();
    let mut ik = builder.build_at(&q).unwrap();
    let mut goal = pose(&model, &q, base);
    goal.translation.vector += Vector3::new(1.0, -0.5, 0.2);
    goal.append_rotation_wrt_center_mut(&UnitQuaternion::from_euler_angles(0.4, -0.8, 1.2));
    ik.task_mut(task).unwrap().set_target(goal).unwrap();
    let mut robot = Commanded::new(ik, &q, FollowingErrorLimit::default()).unwrap();
    let mut apart = vec![0.0; model.velocity_count()];
    for _ in 0..2000 {
        let command = robot.step(&q, PERIOD);
        assert!(command.fault.is_none());
        model.difference(&q, command.position, &mut apart).unwrap();
        // Rotation vectors change at the angular velocity except for half their product: 5 % at 0.1 rad.
        assert!(apart[..3].iter().all(|apart| apart.abs() < 0.1 + 1e-9), "{apart:?}");
        assert!(apart[3..6].iter().all(|apart| apart.abs() < 0.105), "{apart:?}");
    }
    assert!(apart[..6].iter().all(|apart| apart.abs() > 0.09), "{apart:?}");
}

#[test]
fn an_estimate_that_drifts_moves_no_base() {
    let model = humanoid();
    let [mut robot, mut other] = [(); 2].map(|()| standing(&model, Vector3::zeros()));
    for tick in 0..3000 {
        let mut measured = robot.position().to_vec();
        measured[0] += 1e-4 * f64::from(tick);
        assert!(robot.step(&measured, PERIOD).fault.is_none());
        let exact = other.position().to_vec();
        assert!(other.step(&exact, PERIOD).fault.is_none());
    }
    for (one, other) in robot.position().iter().zip(other.position()) {
        assert!((one - other).abs() < 1e-6, "{one} for {other}");
    }
}
