//! Active limits that a step reports.

use whole_body::limits::{End, LimitKind};
use whole_body::tasks::PostureTask;
use whole_body::{Description, Ik, Model};

use crate::support::stacks::PERIOD;

/// A revolute joint of this type with this limit.
fn hinge(kind: &str, limit: &str) -> Model {
    let urdf = format!(
        r#"<robot name="p"><link name="a"/><link name="b"/><joint name="j" type="{kind}">
           <parent link="a"/><child link="b"/><axis xyz="0 0 1"/>{limit}</joint></robot>"#
    );
    Model::from_urdf(&urdf, &Description::default()).unwrap()
}

/// The limits that are named after so many ticks on the way to a posture.
fn named(model: &Model, target: f64, ticks: usize) -> Vec<(String, LimitKind, End)> {
    let mut q = vec![0.0];
    let mut builder = Ik::builder(model);
    let posture = builder.push("posture", PostureTask::new());
    let mut ik = builder.build_at(&q).unwrap();
    ik.task_mut(posture).unwrap().set_target(&[target]).unwrap();
    for _ in 1..ticks {
        ik.step(&q, PERIOD).unwrap().integrate(&mut q).unwrap();
    }
    let step = ik.step(&q, PERIOD).unwrap();
    step.active_limits().map(|limit| (limit.name.to_owned(), limit.kind, limit.end)).collect()
}

#[test]
fn joint_without_jerk_limit_reports_position_limit() {
    let model = hinge("revolute", r#"<limit lower="-1" upper="1" velocity="1" effort="1"/>"#);
    assert_eq!(model.limits()[0].jerk, f64::INFINITY);
    assert_eq!(named(&model, 1.5, 3000), [("j".to_owned(), LimitKind::Position, End::Upper)]);
    assert_eq!(named(&model, -1.5, 3000), [("j".to_owned(), LimitKind::Position, End::Lower)]);
    assert_eq!(named(&model, 1.5, 2), [("j".to_owned(), LimitKind::Acceleration, End::Upper)]);
}

#[test]
fn a_joint_without_limits_is_at_none() {
    assert_eq!(named(&hinge("continuous", ""), 1.5, 100), []);
    let fast = hinge("continuous", r#"<limit velocity="1" effort="1"/>"#);
    assert_eq!(named(&fast, 5.0, 1000), [("j".to_owned(), LimitKind::Velocity, End::Upper)]);
    assert_eq!(named(&fast, 0.1, 5000), []);
}
