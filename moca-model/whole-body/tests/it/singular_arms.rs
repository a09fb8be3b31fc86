//! Arms that start at or near singular configurations, with targets within their reach.

use nalgebra::{Isometry3, Point3, Quaternion, Translation3, UnitQuaternion, Vector3};
use whole_body::tasks::{FrameTask, OrientationTask, PositionTask, PostureTask};
use whole_body::{Ik, Model};

use crate::support::arms::{arm, arms};
use crate::support::monitor::Monitor;
use crate::support::stacks::{PERIOD, panda};
use crate::support::{last_frame, pose};

/// 200 starts of 12 arms, with targets 3 and 10 cm away that are in reach by more than 1 %.
///
/// Each line has the arm, the target (position, then the quaternion's i, j, k, w), the time to it without damping \[s\]
/// and the start. The time is `inf` if the target is not reached.
const STARTS: &str = include_str!("singular_starts.txt");

fn apart(target: &Isometry3<f64>, now: &Isometry3<f64>) -> f64 {
    (target.translation.vector - now.translation.vector).norm()
}

/// Motion that the pose leaves open.
#[derive(Clone, Copy, PartialEq)]
enum Rest {
    Still,
    Posture,
}

fn ik(model: &Model, q: &[f64], target: Isometry3<f64>, rest: Rest) -> Ik {
    let mut builder = Ik::builder(model);
    let task = builder.push("pose", FrameTask::new(last_frame(model)));
    if rest == Rest::Posture {
        builder.push("posture", PostureTask::new());
    }
    let mut ik = builder.build_at(q).unwrap();
    ik.task_mut(task).unwrap().set_target(target).unwrap();
    ik
}

/// Returns the time at which the tool is within 1 mm of its place, and the speed of the fastest joint a second later.
/// `None` if it is not there in ten seconds or does not stay. Limits hold on the way.
fn arrival(model: &Model, start: &[f64], target: Isometry3<f64>, rest: Rest) -> Option<[f64; 2]> {
    let (tool, mut q) = (last_frame(model), start.to_vec());
    let mut ik = ik(model, start, target, rest);
    let mut monitor = Monitor::new(model, &q);
    let mut arrived = None;
    for tick in 0..10_000_u32 {
        if arrived.is_none() && apart(&target, &pose(model, &q, tool)) < 1e-3 {
            arrived = Some(tick);
        }
        if arrived.is_some_and(|since| tick > since + 1000) {
            break;
        }
        ik.step(&q, PERIOD).unwrap().integrate(&mut q).unwrap();
        monitor.check(&q);
    }
    let fastest = ik.velocity().iter().fold(0.0_f64, |most, v| most.max(v.abs()));
    let stays = apart(&target, &pose(model, &q, tool)) < 1e-3;
    arrived.filter(|_| stays).map(|tick| [f64::from(tick) * PERIOD, fastest])
}

/// The three arms that do not arrive do not arrive without damping either: on the way a wrist joint comes to its limit,
/// and another turn of the wrist would be needed. Bounded least squares by a trust region (SciPy) from the same starts
/// stay at the same limits, 12, 34 and 5 mm away. The targets are reached on another branch.
///
/// A second after they have arrived the arms rest, but for one joint at 0.012 rad/s. A posture below the pose still draws
/// redundant joints, as slowly as its feedback says; arms without such joints rest with it, too.
#[test]
fn nearly_all_singular_starts_arrive() {
    let arms = arms();
    let (mut missed, mut late, mut moving, mut fastest) = (Vec::new(), Vec::new(), 0, 0.0_f64);
    for (number, line) in STARTS.lines().enumerate() {
        let (arm, numbers) = line.split_once(' ').unwrap();
        let model = &arms[arm.parse::<usize>().unwrap()];
        let numbers: Vec<f64> = numbers.split(' ').map(|text| text.parse().unwrap()).collect();
        let turn = Quaternion::new(numbers[6], numbers[3], numbers[4], numbers[5]);
        let target = Isometry3::from_parts(
            Translation3::new(numbers[0], numbers[1], numbers[2]),
            UnitQuaternion::new_unchecked(turn),
        );
        let undamped = numbers[7];
        let start = &numbers[8..];
        if let Some([time, speed]) = arrival(model, start, target, Rest::Posture) {
            if time > 1.5 * undamped.max(0.1) {
                late.push(number);
            }
            let alone = if model.velocity_count() == 6 {
                speed
            } else {
                arrival(model, start, target, Rest::Still).unwrap()[1]
            };
            moving += usize::from(alone > 0.01);
            fastest = alone.max(fastest);
        } else {
            assert!(undamped.is_infinite(), "{number} is reached without damping");
            missed.push(number);
        }
    }
    assert!(missed.len() <= 3, "not reached: {missed:?}");
    assert!(late.len() <= 1, "late: {late:?}");
    assert!(moving <= 1 && fastest < 0.013, "{moving} arms move on, at up to {fastest} rad/s");
}

/// An ABB IRB 1600 in the middle of its range moves 3 cm down.
#[test]
fn an_elbow_over_the_first_axis_comes_back() {
    let model = arm("irb1600");
    let q = vec![0.0; 6];
    let mut target = pose(&model, &q, last_frame(&model));
    target.translation.vector.z -= 0.03;
    let [time, speed] = arrival(&model, &q, target, Rest::Posture).unwrap();
    assert!(time < 0.3 && speed < 0.01, "{time} s, {speed} rad/s");
}

/// A UR5 with its wrist stretched moves along a direction that it has.
#[test]
fn lost_direction_does_not_slow_other_motion() {
    let model = arm("ur5");
    for (wrist, elbow) in [(0.0, 1.6), (0.0, 1.0), (0.02, 1.0)] {
        let q = vec![0.0, -0.6, elbow, 0.2, wrist, 0.0];
        let mut target = pose(&model, &q, last_frame(&model));
        target.translation.vector.x -= 0.1;
        let [time, speed] = arrival(&model, &q, target, Rest::Posture).unwrap();
        assert!(time < 0.7 && speed < 0.01, "{wrist} {elbow}: {time} s, {speed} rad/s");
    }
}

/// The path leads through singular configurations, but no target is given up for good.
#[test]
fn a_panda_arrives_far_away() {
    let model = panda();
    let there = [1.3003, -0.7164, 1.533, -1.6466, 1.2488, 2.6647, 1.6661];
    let target = pose(&model, &there, last_frame(&model));
    let mut q = vec![0.0, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785];
    let mut ik = ik(&model, &q, target, Rest::Posture);
    for _ in 0..5000 {
        ik.step(&q, PERIOD).unwrap().integrate(&mut q).unwrap();
    }
    let end = pose(&model, &q, last_frame(&model));
    let turn = end.rotation.angle_to(&target.rotation);
    assert!(apart(&target, &end) < 1e-6 && turn < 1e-6, "{} m", apart(&target, &end));
}

/// Out of reach the arm comes to rest by itself, and leaves when the target comes back.
#[test]
fn returning_target_is_reached_from_rest() {
    let model = panda();
    let mut q = vec![0.0, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785];
    let tool = last_frame(&model);
    let mut builder = Ik::builder(&model);
    let task = builder.push("position", PositionTask::new(tool));
    builder.push("orientation", OrientationTask::new(tool));
    builder.push("posture", PostureTask::new());
    let mut ik = builder.build_at(&q).unwrap();
    let near = pose(&model, &q, tool).translation.vector + Vector3::new(0.1, 0.1, 0.1);
    for target in [Vector3::new(1.5, 0.3, 0.5), near] {
        ik.task_mut(task).unwrap().set_target(Point3::from(target)).unwrap();
        for _ in 0..10_000 {
            ik.step(&q, PERIOD).unwrap().integrate(&mut q).unwrap();
        }
        let fastest = ik.velocity().iter().fold(0.0_f64, |most, v| most.max(v.abs()));
        assert!(fastest < 0.01, "{target}: {fastest} rad/s");
    }
    let end = (pose(&model, &q, tool).translation.vector - near).norm();
    assert!(end < 1e-6, "{end} m");
}
