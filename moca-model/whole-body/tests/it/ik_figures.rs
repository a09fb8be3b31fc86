//! Numbers that the documentation states for a Panda on a circle.

use nalgebra::{Point3, Vector3};
use whole_body::tasks::{OrientationTask, PositionTask, PostureTask};
use whole_body::{Ik, Model};

use crate::support::monitor::Monitor;
use crate::support::pose;
use crate::support::stacks::{PERIOD, panda, panda_of_acceleration};

const HOME: [f64; 7] = [0.0, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785];

/// Largest errors \[m, rad\] at full speed, and a second after the path has slowed down.
#[derive(Debug)]
struct Errors {
    position: f64,
    orientation: f64,
    late_position: f64,
    late_orientation: f64,
    saturated: usize,
}

/// The minimum-jerk curve from 0 to 1.
fn smooth(s: f64) -> f64 {
    let s = s.clamp(0.0, 1.0);
    s * s * s * (10.0 - s * (15.0 - 6.0 * s))
}

/// Follows circles of 0.1 m in the y-z plane. They reach full speed within a second and slow down to a tenth from 6 to
/// 6.5 s.
fn circle(time_of_round: f64) -> Errors {
    circle_of(&panda(), time_of_round)
}

fn circle_of(model: &Model, time_of_round: f64) -> Errors {
    let tool = model.frame_id("panda_hand_tcp").unwrap();
    let mut q = HOME.to_vec();
    let start = pose(model, &q, tool);
    let mut builder = Ik::builder(model);
    let position = builder.push("position", PositionTask::new(tool));
    let orientation = builder.push("orientation", OrientationTask::new(tool));
    let posture = builder.push("posture", PostureTask::new());
    let mut ik = builder.build().unwrap();
    ik.task_mut(orientation).unwrap().set_target(start.rotation).unwrap();
    ik.task_mut(posture).unwrap().set_target(&HOME).unwrap();
    let mut errors = Errors {
        position: 0.0,
        orientation: 0.0,
        late_position: 0.0,
        late_orientation: 0.0,
        saturated: 0,
    };
    let mut monitor = Monitor::new(model, &q);
    let mut angle = 0.0_f64;
    for tick in 0..8500 {
        let time = f64::from(tick) * PERIOD;
        let rate = std::f64::consts::TAU / time_of_round
            * (smooth(time) - 0.9 * smooth((time - 6.0) / 0.5));
        let (sine, cosine) = angle.sin_cos();
        let target = start.translation.vector + 0.1 * Vector3::new(0.0, sine, cosine - 1.0);
        let now = pose(model, &q, tool);
        let apart = (now.translation.vector - target).norm();
        let turned = now.rotation.angle_to(&start.rotation);
        errors.position = errors.position.max(apart);
        errors.orientation = errors.orientation.max(turned);
        if time > 7.5 {
            errors.late_position = errors.late_position.max(apart);
            errors.late_orientation = errors.late_orientation.max(turned);
        }
        let velocity = 0.1 * rate * Vector3::new(0.0, cosine, -sine);
        let task = ik.task_mut(position).unwrap();
        task.set_moving_target(Point3::from(target), velocity).unwrap();
        let step = ik.step(&q, PERIOD).unwrap();
        errors.saturated += step.active_limits().count();
        step.integrate(&mut q).unwrap();
        monitor.check(&q);
        angle += rate * PERIOD;
    }
    errors
}

#[test]
fn slow_circle_errs_less_than_tenth_of_millimetre() {
    let errors = circle(4.0);
    assert!(errors.position < 1e-4 && errors.orientation < 1e-4, "{errors:?}");
}

#[test]
fn fast_circle_errs_less_than_half_a_millimetre() {
    let errors = circle(1.25);
    assert!(errors.position < 5e-4 && errors.orientation < 5e-4, "{errors:?}");
}

/// At 0.8 s a round, joints saturate. The position stays, and the orientation recovers within a second after the path
/// has slowed down. At 0.7 s the position cannot be kept either.
#[test]
fn where_joints_saturate_the_position_comes_first() {
    let errors = circle(0.8);
    assert!(errors.saturated > 100, "{errors:?}");
    assert!(errors.position < 1e-3 && errors.orientation > 0.05, "{errors:?}");
    assert!(errors.late_orientation < 1e-3 && errors.late_position < 1e-4, "{errors:?}");
    for round in [1.0, 0.9, 0.75, 0.7] {
        let errors = circle(round);
        assert!(
            errors.late_orientation < 1e-3 && errors.late_position < 1e-4,
            "{round}: {errors:?}"
        );
    }
}

/// At 1 s a round, joints with at most 0.8 of a Panda's accelerations saturate. From 0.65 down they cannot keep the
/// position either.
#[test]
fn where_accelerations_saturate_the_position_comes_first() {
    let errors = circle_of(&panda_of_acceleration(0.7), 1.0);
    assert!(errors.saturated > 1000, "{errors:?}");
    assert!(errors.position < 5e-4 && errors.orientation > 0.02, "{errors:?}");
    assert!(errors.late_orientation < 1e-3 && errors.late_position < 1e-4, "{errors:?}");
    for share in [0.8, 0.65, 0.5, 0.4] {
        let errors = circle_of(&panda_of_acceleration(share), 1.0);
        assert!(errors.saturated > 1000, "{share}: {errors:?}");
        assert!(
            errors.late_orientation < 1e-3 && errors.late_position < 1e-4,
            "{share}: {errors:?}"
        );
    }
}
