//! Targets that a robot cannot reach.

use allocation_counter::measure;
use nalgebra::{Point3, Unit, Vector3};
use whole_body::stack::TaskId;
use whole_body::tasks::{FrameTask, OrientationTask, PositionTask, PostureTask};
use whole_body::{Description, Ik, Model};

use crate::support::monitor::Monitor;
use crate::support::pose;
use crate::support::stacks::{PERIOD, panda};

/// Directions from the shoulder.
const DIRECTIONS: [[f64; 3]; 16] = [
    [1.0, 0.0, 0.0],
    [0.0, 0.0, 1.0],
    [-1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, -1.0, 0.0],
    [0.0, 0.0, -1.0],
    [1.0, 1.0, 1.0],
    [-1.0, 0.3, 0.8],
    [0.2, -1.0, 0.5],
    [-0.7, -0.7, 0.1],
    [0.001, 0.0, 1.0],
    [-1.0, 0.001, 0.3],
    [1.0, 0.0, 1.0],
    [0.0, 1.0, 1.0],
    [0.6, 0.0, -0.6],
    [0.5, -1.0, 0.0],
];
/// \[m\]
const DISTANCES: [f64; 2] = [1.2, 2.0];

struct Arm {
    model: Model,
    tool: &'static str,
    shoulder: Vector3<f64>,
    start: Vec<f64>,
}

fn panda_arm() -> Arm {
    let start = vec![0.0, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785];
    Arm { model: panda(), tool: "panda_hand_tcp", shoulder: Vector3::new(0.0, 0.0, 0.333), start }
}

/// The left one of two arms on a lift.
fn left_arm() -> Arm {
    let urdf = include_str!("../../examples/urdf/two_arms.urdf");
    let tips = vec!["left_hand".to_owned()];
    let model = Model::from_urdf(urdf, &Description { tips, ..Description::default() }).unwrap();
    let mut start = model.neutral();
    for (joint, angle) in [("left_elbow", -1.5), ("left_shoulder_pitch", 0.5)] {
        let id = model.joint_id(joint).unwrap();
        start[model.joint(id).unwrap().position_index] = angle;
    }
    Arm { model, tool: "left_hand", shoulder: Vector3::new(0.0, 0.2, 1.2), start }
}

struct Reach {
    ik: Ik,
    position: TaskId<PositionTask>,
}

/// A stack with position over orientation over posture.
fn reach(arm: &Arm) -> Reach {
    let tool = arm.model.frame_id(arm.tool).unwrap();
    let mut builder = Ik::builder(&arm.model);
    let position = builder.push("position", PositionTask::new(tool));
    builder.push("orientation", OrientationTask::new(tool));
    builder.push("posture", PostureTask::new());
    Reach { ik: builder.build_at(&arm.start).unwrap(), position }
}

/// The largest velocity and acceleration in the last of twelve seconds.
fn last_second(arm: &Arm, target: &Vector3<f64>) -> [f64; 2] {
    let Reach { mut ik, position } = reach(arm);
    ik.task_mut(position).unwrap().set_target(Point3::from(*target)).unwrap();
    let mut q = arm.start.clone();
    let mut monitor = Monitor::new(&arm.model, &q);
    let most = |values: &[f64]| values.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
    let mut worst = [0.0_f64; 2];
    for tick in 0..12_000 {
        let step = ik.step(&q, PERIOD).unwrap();
        if tick >= 11_000 {
            let now = [most(step.velocity()), most(step.acceleration())];
            worst = [worst[0].max(now[0]), worst[1].max(now[1])];
        }
        step.integrate(&mut q).unwrap();
        monitor.check(&q);
    }
    worst
}

/// Checks some of the targets. The environment variable `WHOLE_BODY_TARGETS` checks all and prints how many end at
/// rest.
fn rests_at(arm: &Arm, some: &[(usize, usize)]) {
    let all = std::env::var("WHOLE_BODY_TARGETS").is_ok();
    let (mut count, mut moving) = (0, Vec::new());
    for (i, direction) in DIRECTIONS.into_iter().enumerate() {
        for (j, distance) in DISTANCES.into_iter().enumerate() {
            if !all && !some.contains(&(i, j)) {
                continue;
            }
            let way = Unit::new_normalize(Vector3::from(direction)).into_inner();
            let [v, a] = last_second(arm, &(arm.shoulder + distance * way));
            let rests = v < 1e-2 && a < 0.1;
            assert!(all || rests, "{direction:?} at {distance} m: {v} rad/s, {a} rad/s²");
            count += 1;
            if !rests {
                moving.push((direction, distance, v, a));
            }
        }
    }
    let rested = count - moving.len();
    assert!(!all, "{rested} of {count} are rested at, all but {moving:?}");
}

#[test]
fn a_panda_comes_to_rest() {
    rests_at(&panda_arm(), &[(0, 1), (1, 0), (2, 1), (5, 0), (7, 0), (9, 1), (11, 0), (14, 0)]);
}

#[test]
fn an_arm_on_a_lift_comes_to_rest() {
    rests_at(&left_arm(), &[(0, 1), (1, 1), (4, 0), (6, 0), (8, 1), (13, 0), (14, 1), (15, 0)]);
}

/// A stretched arm has to bend first, which takes longer than the way itself.
#[test]
fn a_target_that_comes_back_is_reached() {
    let arm = panda_arm();
    let Reach { mut ik, position } = reach(&arm);
    let mut q = arm.start.clone();
    let tool = arm.model.frame_id(arm.tool).unwrap();
    let near = pose(&arm.model, &q, tool).translation.vector + Vector3::new(0.1, 0.1, 0.1);
    let apart = |q: &[f64]| (pose(&arm.model, q, tool).translation.vector - near).norm();
    for (target, ticks) in [(Vector3::new(-2.0, 0.6, 1.9), 6000), (near, 6000)] {
        ik.task_mut(position).unwrap().set_target(Point3::from(target)).unwrap();
        for _ in 0..ticks {
            ik.step(&q, PERIOD).unwrap().integrate(&mut q).unwrap();
        }
    }
    assert!(apart(&q) < 1e-4, "{} m", apart(&q));
}

#[test]
fn steps_out_of_reach_allocate_nothing() {
    let arm = panda_arm();
    let tool = arm.model.frame_id(arm.tool).unwrap();
    let mut builder = Ik::builder(&arm.model);
    let task = builder.push("pose", FrameTask::new(tool));
    builder.push("posture", PostureTask::new());
    let mut ik = builder.build_at(&arm.start).unwrap();
    let mut q = arm.start.clone();
    let mut target = pose(&arm.model, &q, tool);
    target.translation.vector.x += 2.0;
    ik.task_mut(task).unwrap().set_target(target).unwrap();
    ik.step(&q, PERIOD).unwrap().integrate(&mut q).unwrap();
    let counted = measure(|| {
        for _ in 0..3000 {
            ik.step(&q, PERIOD).unwrap().integrate(&mut q).unwrap();
        }
    });
    assert_eq!(counted.count_total, 0);
}
