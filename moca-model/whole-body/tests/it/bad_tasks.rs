//! Impossible tasks, targets, periods and levels are errors that name them.

use nalgebra::{Point3, Vector3};
use whole_body::ik::IkSettings;
use whole_body::limits::{FrameVelocityLimit, VelocityInterval, WheelLimit};
use whole_body::stack::TaskLevel;
use whole_body::tasks::{
    CentreOfMassTask, DampingTask, FrameTask, JointCouplingTask, ManipulabilityTask, PositionTask,
    PostureTask, RelativeFrameTask, VelocityTask,
};
use whole_body::{Description, Error, Ik, Model, Task};

use crate::support::stacks::{PERIOD, humanoid, panda};

const HOME: [f64; 7] = [0.0, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785];

#[expect(clippy::needless_pass_by_value, reason = "errors come by value")]
fn expect(error: Error, words: &[&str]) {
    let message = error.to_string();
    for word in words {
        assert!(message.contains(word), "no `{word}` in: {message}");
    }
}

fn refused<T: Task>(model: &Model, task: T) -> Error {
    let mut builder = Ik::builder(model);
    builder.push("mine", task);
    builder.build().unwrap_err()
}

#[test]
fn targets_that_were_never_set() {
    let model = panda();
    let tool = model.frame_id("panda_hand").unwrap();
    let mut level = TaskLevel::new("tools");
    level.push("left", FrameTask::new(tool));
    let mut builder = Ik::builder(&model);
    builder.push_level(level);
    let posture = builder.push("posture", PostureTask::new());
    let mut ik = builder.build().unwrap();
    ik.task_mut(posture).unwrap().set_target(&HOME).unwrap();
    expect(ik.step(&HOME, PERIOD).unwrap_err(), &["`left`", "`tools`", "target was never set"]);
    assert!(ik.velocity().iter().all(|v| *v == 0.0));
}

#[test]
fn tasks_that_the_robot_cannot_do() {
    let model = panda();
    let tool = model.frame_id("panda_hand").unwrap();
    let root = model.frame_id("panda_link0").unwrap();
    let link7 = model.frame_id("panda_link7").unwrap();
    let names = ["`mine`", "level `mine`"];
    expect(
        refused(&model, PositionTask::new(root)),
        &["no joint moves frame `panda_link0`", names[0]],
    );
    expect(refused(&model, FrameTask::new(root)), &names);
    expect(refused(&model, RelativeFrameTask::new(link7, tool)), &["panda_link7", "panda_hand"]);
    expect(
        refused(&model, PositionTask::new(tool).with_axes(&[])),
        &["controls no axis, joint or row"],
    );
    expect(refused(&model, PositionTask::new(tool).with_gain(0.0)), &["gain", "positive"]);
    expect(refused(&model, PositionTask::new(tool).with_gain(f64::NAN)), &["gain", "NaN"]);
    let weights = Vector3::new(1.0, -1.0, 1.0);
    expect(refused(&model, PositionTask::new(tool).with_weights(weights)), &["weight", "-1"]);
    expect(refused(&model, ManipulabilityTask::new(tool, -1.0)), &["threshold"]);
    expect(refused(&model, PostureTask::new().with_weights(&[1.0; 3])), &["weights", "3", "7"]);
    expect(refused(&model, DampingTask::new().with_weights(&[1.0; 9])), &["weights", "9", "7"]);
    expect(refused(&model, JointCouplingTask::new(&[])), &["coefficients"]);
    expect(refused(&model, VelocityTask::new(0)), &["controls no axis, joint or row"]);
    expect(refused(&model, WheelLimit::mecanum(1.0, 0.5)), &["no planar base", "panda"]);
    let limit = FrameVelocityLimit::new(tool, Vector3::new(0.1, -1.0, 0.1), Vector3::repeat(1.0));
    expect(refused(&model, limit), &["limit", "-1", "positive"]);
    let other = humanoid();
    let foreign = other.frame_id("left_hand").unwrap();
    expect(refused(&model, PositionTask::new(foreign)), &["another model", "panda"]);
    let floating = other.joint_ids().next().unwrap();
    expect(refused(&other, PostureTask::new().of_joints(&[floating])), &["floating_base", "six"]);
    let weightless = Model::from_urdf(
        r#"<robot name="thin"><link name="a"/><link name="b"/><joint name="j" type="continuous">
           <parent link="a"/><child link="b"/></joint></robot>"#,
        &Description::default(),
    );
    let weightless = weightless.unwrap();
    expect(refused(&weightless, CentreOfMassTask::new(&weightless)), &["mass", "thin"]);
}

#[test]
fn levels_and_names() {
    let model = panda();
    let tool = model.frame_id("panda_hand").unwrap();
    expect(Ik::builder(&model).build().unwrap_err(), &["no level"]);
    let mut builder = Ik::builder(&model);
    builder.push_level(TaskLevel::new("empty"));
    expect(builder.build().unwrap_err(), &["`empty`", "no tasks"]);
    let mut builder = Ik::builder(&model);
    builder.push("one", PositionTask::new(tool));
    builder.push("one", DampingTask::new());
    expect(builder.build().unwrap_err(), &["level named `one` already"]);
    let mut builder = Ik::builder(&model);
    let mut level = TaskLevel::new("level");
    level.push("twice", PositionTask::new(tool));
    level.push("twice", DampingTask::new());
    builder.push_level(level);
    expect(builder.build().unwrap_err(), &["task named `twice` already"]);
    let mut builder = Ik::builder(&model);
    builder.settings(IkSettings { singularity_threshold: 1.0, ..IkSettings::default() });
    builder.push("rest", DampingTask::new());
    expect(builder.build().unwrap_err(), &["singularities"]);

    let mut builder = Ik::builder(&model);
    let rest = builder.push("rest", DampingTask::new());
    let mut ik = builder.build().unwrap();
    let mut builder = Ik::builder(&model);
    let other = builder.push("rest", DampingTask::new());
    assert!(matches!(ik.task_mut(other), Err(Error::UnknownTask)));
    assert!(ik.task_mut(rest).is_ok());
    let mut builder = Ik::builder(&model);
    builder.push("limits", DampingTask::new());
    expect(builder.build().unwrap_err(), &["already", "limits"]);
    assert!(ik.step(&HOME, PERIOD).is_ok());
}

#[test]
fn states_periods_and_targets() {
    let model = panda();
    let tool = model.frame_id("panda_hand").unwrap();
    let mut builder = Ik::builder(&model);
    let position = builder.push("position", PositionTask::new(tool).with_gain(100.0));
    let mut ik = builder.build().unwrap();
    let task = ik.task_mut(position).unwrap();
    assert!(task.set_target(Point3::new(f64::NAN, 0.0, 0.0)).is_err());
    assert!(task.set_moving_target(Point3::origin(), Vector3::repeat(f64::INFINITY)).is_err());
    task.set_target(Point3::new(0.4, 0.0, 0.4)).unwrap();
    for period in [0.0, -1e-3, f64::NAN, f64::INFINITY] {
        expect(ik.step(&HOME, period).unwrap_err(), &["period", "positive"]);
        assert!(ik.brake(period).is_err());
    }
    expect(ik.step(&HOME, 0.02).unwrap_err(), &["`position`", "100", "0.02", "at most"]);
    expect(ik.step(&HOME[1..], PERIOD).unwrap_err(), &["q has 6", "7"]);
    let mut nan = HOME;
    nan[3] = f64::NAN;
    expect(ik.step(&nan, PERIOD).unwrap_err(), &["panda_joint4", "NaN"]);
    let interval = VelocityInterval { lower: f64::NAN, upper: 0.0 };
    assert!(ik.step_within(&HOME, PERIOD, &[interval; 7]).is_err());
    assert!(ik.step_within(&HOME, PERIOD, &[interval; 3]).is_err());
    assert!(ik.reset(&[0.0; 3]).is_err() && ik.reset(&[f64::NAN; 7]).is_err());
    assert!(ik.velocity().iter().all(|v| *v == 0.0));
    assert!(ik.step(&HOME, PERIOD).is_ok());
}

#[test]
fn rows_of_the_caller() {
    let mut task = VelocityTask::new(1);
    assert!(matches!(task.set_row(1, &[], 0.0, 0.0), Err(Error::Size { .. })));
    assert!(task.set_row(0, &[f64::NAN], 0.0, 0.0).is_err());
    expect(
        task.set_row(0, &[1.0], 1.0, 0.0).unwrap_err(),
        &["upper bound of row 0 is 0", "lower bound 1"],
    );
    assert!(task.set_row(0, &[1.0], f64::NAN, 0.0).is_err());
    assert!(task.set_weight(0, -1.0).is_err() && task.set_weight(3, 1.0).is_err());
    task.set_row(0, &[1.0; 9], 0.0, 0.0).unwrap();
    let mut builder = Ik::builder(&panda());
    builder.push("rows", task);
    expect(builder.build().unwrap().step(&HOME, PERIOD).unwrap_err(), &["`rows`", "9", "7"]);
}
