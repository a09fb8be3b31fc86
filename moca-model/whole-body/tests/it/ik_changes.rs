//! Velocities stay continuous while levels come, go and change places.

use nalgebra::{Point3, Vector3};
use whole_body::{
    FrameVelocityLimit, Ik, OrientationTask, Place, PositionTask, PostureTask, TaskLevel,
};

use crate::support::pose;
use crate::support::stacks::{PERIOD, panda};

const HOME: [f64; 7] = [0.0, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785];

/// Steps, with the acceleration, jerk and Cartesian limits checked.
fn run(ik: &mut Ik, q: &mut [f64], ticks: usize) {
    let limits = ik.model().limits().to_vec();
    for _ in 0..ticks {
        let before = ik.velocity().to_vec();
        let acceleration = ik.acceleration().to_vec();
        let step = ik.step(q, PERIOD).unwrap();
        for (entry, limits) in limits.iter().enumerate() {
            let now = (step.velocity()[entry] - before[entry]) / PERIOD;
            assert!(now.abs() <= limits.acceleration * (1.0 + 1e-9));
            let jerk = (now - acceleration[entry]) / PERIOD;
            assert!(jerk.abs() <= limits.jerk * (1.0 + 1e-6), "{jerk}");
        }
        step.integrate(q).unwrap();
    }
}

#[test]
fn through_all_changes() {
    let model = panda();
    let hand = model.frame_id("panda_hand_tcp").unwrap();
    let mut q = HOME.to_vec();
    let start = pose(&model, &q, hand);
    let mut builder = Ik::builder(&model);
    builder
        .limit("hand", FrameVelocityLimit::new(hand, Vector3::repeat(0.5), Vector3::repeat(1.0)));
    let orientation = builder.push("orientation", OrientationTask::new(hand));
    let posture = builder.push("posture", PostureTask::new());
    let mut ik = builder.build().unwrap();
    ik.task_mut(orientation).unwrap().set_target(start.rotation).unwrap();
    ik.task_mut(posture).unwrap().set_target(&HOME).unwrap();
    run(&mut ik, &mut q, 100);

    let (mut level, mut reach) = (TaskLevel::new("reach"), PositionTask::new(hand));
    let goal = start.translation.vector + Vector3::new(0.1, 0.2, -0.1);
    reach.set_target(Point3::from(goal)).unwrap();
    let task = level.push("hand", reach);
    let id = ik.insert(level, Place::Top, 0.3).unwrap();
    assert!(ik.is_changing());
    run(&mut ik, &mut q, 1500);
    assert_eq!(
        ik.levels().map(|(_, name)| name).collect::<Vec<_>>(),
        ["reach", "orientation", "posture"]
    );
    assert!((pose(&model, &q, hand).translation.vector - goal).norm() < 1e-4);

    let below = ik.level_id("orientation").unwrap();
    ik.swap(id, below, 0.2).unwrap();
    run(&mut ik, &mut q, 100);
    ik.activate(below, 0.0, 0.1).unwrap();
    run(&mut ik, &mut q, 400);
    assert_eq!(ik.activation(below).unwrap(), 0.0);
    ik.remove(id, 0.2).unwrap();
    assert_eq!(ik.levels().map(|(_, name)| name).collect::<Vec<_>>(), ["orientation", "posture"]);
    run(&mut ik, &mut q, 5000);
    // Only the posture is left.
    assert!(q.iter().zip(&HOME).all(|(q, home)| (q - home).abs() < 1e-3), "{q:?}");
    ik.activate(below, 1.0, 0.1).unwrap();
    assert!(ik.task_mut(task).is_err(), "its level is gone");
    run(&mut ik, &mut q, 100);
}

#[test]
fn limits_are_above_all_levels() {
    let model = panda();
    let hand = model.frame_id("panda_hand_tcp").unwrap();
    let mut q = HOME.to_vec();
    let start = pose(&model, &q, hand);
    let mut builder = Ik::builder(&model);
    builder
        .limit("hand", FrameVelocityLimit::new(hand, Vector3::repeat(0.1), Vector3::repeat(1.0)));
    let posture = builder.push("posture", PostureTask::new());
    let mut ik = builder.build().unwrap();
    ik.task_mut(posture).unwrap().set_target(&HOME).unwrap();
    run(&mut ik, &mut q, 10);
    let (mut level, mut reach) = (TaskLevel::new("reach"), PositionTask::new(hand));
    reach.set_target(Point3::from(start.translation.vector + Vector3::new(0.0, 0.5, 0.0))).unwrap();
    level.push("hand", reach);
    ik.insert(level, Place::Top, 0.0).unwrap();
    let mut fastest = 0.0_f64;
    for _ in 0..2000 {
        let before = pose(&model, &q, hand).translation.vector;
        run(&mut ik, &mut q, 1);
        let speed = (pose(&model, &q, hand).translation.vector - before) / PERIOD;
        fastest = fastest.max(speed.amax());
    }
    assert!(fastest > 0.094 && fastest <= 0.1 * (1.0 + 1e-9), "{fastest}");
}
