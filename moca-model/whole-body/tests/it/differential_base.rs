//! A base that cannot move sideways.

use nalgebra::{Point3, Vector3};
use proptest::prelude::*;
use whole_body::limits::{FrameVelocityLimit, WheelLimit};
use whole_body::robot::LimitOverride;
use whole_body::stack::{TaskId, TaskLevel, TaskStack};
use whole_body::tasks::{Axis, Feedback, PositionTask, PostureTask, VariableLayout};
use whole_body::{Data, Description, Ik, Model};

use crate::support::monitor::Monitor;
use crate::support::stacks::{PERIOD, Random};

/// A mast half a metre ahead of the axle.
const URDF: &str = r#"<robot name="d">
  <link name="base"><inertial><mass value="20"/>
    <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="mast"><inertial><mass value="1"/>
    <inertia ixx=".1" iyy=".1" izz=".1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="lift" type="prismatic"><parent link="base"/><child link="mast"/>
    <origin xyz=".5 0 0"/><axis xyz="0 0 1"/>
    <limit lower="0" upper="1" velocity=".2" effort="100"/></joint></robot>"#;

fn model(linear: LimitOverride, angular: LimitOverride) -> Model {
    Model::from_urdf(URDF, &Description::on_planar_base(linear, angular)).unwrap()
}

struct Drive {
    ik: Ik,
    tip: TaskId<PositionTask>,
}

fn drive(model: &Model, wheels: WheelLimit) -> Drive {
    let mut builder = Ik::builder(model);
    builder.limit("wheels", wheels);
    let mast = model.frame_id("mast").unwrap();
    // It brakes at half of the base's deceleration.
    let feedback = Feedback { gain: 5.0, deceleration: 0.2 };
    let task = PositionTask::new(mast).with_axes(&[Axis::X, Axis::Y]).with_feedback(feedback);
    let tip = builder.push("tip", task);
    Drive { ik: builder.build_at(&model.neutral()).unwrap(), tip }
}

/// The speed across the heading.
fn sideways(yaw: f64, v: &[f64]) -> f64 {
    (yaw.cos() * v[1] - yaw.sin() * v[0]).abs()
}

#[test]
fn base_does_not_slide_at_full_turn_rate() {
    let model = model(LimitOverride::of_speed(1.0, 0.5), LimitOverride::of_speed(1.5, 1.0));
    let Drive { mut ik, tip } = drive(&model, WheelLimit::differential(2.0, 0.5));
    ik.task_mut(tip).unwrap().set_target(Point3::new(0.5, -4.0, 0.0)).unwrap();
    let mut q = model.neutral();
    let mut monitor = Monitor::new(&model, &q);
    let mut worst = 0.0_f64;
    for _ in 0..12_000 {
        let yaw = q[2];
        let step = ik.step(&q, PERIOD).unwrap();
        worst = worst.max(sideways(yaw, step.velocity()));
        step.integrate(&mut q).unwrap();
        monitor.check(&q);
    }
    assert!(worst < 1e-9, "{worst} m/s sideways");
    let mast = Vector3::new(q[0] + 0.5 * q[2].cos(), q[1] + 0.5 * q[2].sin(), 0.0);
    assert!((mast - Vector3::new(0.5, -4.0, 0.0)).norm() < 1e-3, "{mast}");
}

/// Moves to jumping targets with the given speed, acceleration and range of both axes and of the yaw. It may have
/// another limit and brake at times.
fn soak(seed: u64, linear: [f64; 2], angular: [f64; 2], half: Option<f64>, is_slow: bool) -> f64 {
    let range = half.map(|half| (-half, half));
    let along = LimitOverride { position: range, ..LimitOverride::of_speed(linear[0], linear[1]) };
    let model = model(along, LimitOverride::of_speed(angular[0], angular[1]));
    let mut builder = Ik::builder(&model);
    builder.limit("wheels", WheelLimit::differential(2.0, 0.5));
    let mast = model.frame_id("mast").unwrap();
    if is_slow {
        let [speed, turn] = [Vector3::repeat(0.3), Vector3::repeat(0.7)];
        builder.limit("slow", FrameVelocityLimit::new(mast, speed, turn));
    }
    let tip = builder.push("tip", PositionTask::new(mast).with_axes(&[Axis::X, Axis::Y]));
    builder.push("posture", PostureTask::new());
    let mut q = model.neutral();
    let mut ik = builder.build_at(&q).unwrap();
    let mut monitor = Monitor::new(&model, &q);
    let mut random = Random(seed);
    let mut worst = 0.0_f64;
    for tick in 0..8000 {
        if tick % 700 == 0 {
            let size = half.unwrap_or(2.0) + 0.3;
            let [x, y] = [random.within(-size, size), random.within(-size, size)];
            ik.task_mut(tip).unwrap().set_target(Point3::new(x, y, 0.0)).unwrap();
        }
        let yaw = q[2];
        if tick % 1500 < 1350 {
            let _ = ik.step(&q, PERIOD).unwrap();
        } else {
            ik.brake(PERIOD).unwrap();
        }
        let v = ik.velocity().to_vec();
        worst = worst.max(sideways(yaw, &v));
        let moved: Vec<_> = v.iter().map(|v| v * PERIOD).collect();
        model.integrate(&mut q, &moved).unwrap();
        monitor.check(&q);
    }
    worst
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(16))]

    #[test]
    fn never_slides(
        seed in any::<u64>(), linear in prop::array::uniform2(0.2..2.0_f64),
        angular in prop::array::uniform2(0.3..3.0_f64), half in prop::option::of(0.3..1.5_f64),
        is_slow in any::<bool>(),
    ) {
        let worst = soak(seed, linear, angular, half, is_slow);
        prop_assert!(worst < 1e-9, "{} m/s sideways", worst);
    }
}

proptest! {
    /// Also the rows of a turning base admit what they are told to.
    #[test]
    fn a_differential_base_admits_any_velocity(
        yaw in -3.0..3.0_f64, admitted in prop::array::uniform3(-9.0..9.0_f64), v in prop::array::uniform4(-1.0..1.0_f64),
    ) {
        let model = model(LimitOverride::of_speed(1.0, 0.5), LimitOverride::of_speed(1.5, 1.0));
        let mut limit = WheelLimit::differential(2.0, 0.5);
        limit.admit(admitted.into());
        let mut level = TaskLevel::new("wheels");
        level.constrain("wheels", limit);
        let variables = VariableLayout::new(&model);
        let settings = ahqp_core::Settings::default();
        let mut stack = TaskStack::new(&model, &variables, vec![level], settings).unwrap();
        let mut data = Data::new(&model);
        stack.write(&mut data.pose(&model, &[0.0, 0.0, yaw, 0.5]).unwrap(), &v, PERIOD).unwrap();
        let rows = stack.hierarchy().levels()[0].constraints();
        prop_assert_eq!(rows.len(), 5);
        for (row, lower, upper) in rows.iter() {
            let value: f64 = row.iter().zip(admitted).map(|(a, b)| a * b).sum();
            prop_assert!(lower - 1e-9 <= value && value <= upper + 1e-9, "{lower} {value} {upper}");
        }
    }
}
