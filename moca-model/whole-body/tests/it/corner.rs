//! A base that cannot move sideways in the corner of its room. Its limits of position, acceleration and wheels all
//! apply there.

use nalgebra::Point3;
use whole_body::limits::WheelLimit;
use whole_body::robot::LimitOverride;
use whole_body::stack::Status;
use whole_body::tasks::PositionTask;
use whole_body::{Description, Ik, Model};

use crate::support::stacks::{PERIOD, Random};

const ROBOT: &str = "<robot name='cart'><link name='base'/></robot>";

/// A cart in a room of these sizes with its corner at zero.
fn cart(room: [f64; 2]) -> Model {
    let linear = |size: f64| LimitOverride {
        position: Some((-size, 0.0)),
        ..LimitOverride::of_speed(1.0, 0.5)
    };
    let mut description =
        Description::on_planar_base(linear(room[0]), LimitOverride::of_speed(1.5, 1.0));
    description.limits[1].1 = linear(room[1]);
    Model::from_urdf(ROBOT, &description).unwrap()
}

/// Drives from `q` towards `target`, expecting that every tick is solved. Returns the final configuration.
fn drive(room: [f64; 2], mut q: Vec<f64>, target: [f64; 2], ticks: usize) -> Vec<f64> {
    let model = cart(room);
    let mut builder = Ik::builder(&model);
    builder.limit("wheels", WheelLimit::differential(2.0, 0.5));
    let base = model.frame_id("base").unwrap();
    let position = builder.push("position", PositionTask::new(base));
    let mut ik = builder.build_at(&q).unwrap();
    let target = Point3::new(target[0], target[1], 0.0);
    ik.task_mut(position).unwrap().set_target(target).unwrap();
    for tick in 0..ticks {
        let step =
            ik.step(&q, PERIOD).unwrap_or_else(|error| panic!("tick {tick} at {q:?}: {error}"));
        assert_eq!(step.status(), Status::Solved, "tick {tick}");
        step.integrate(&mut q).unwrap();
    }
    q
}

#[test]
fn a_differential_base_in_a_corner_goes_on() {
    let q = drive([1.0, 1.0], vec![0.0; 3], [0.2, 0.1], 4000);
    assert!(q[0].abs() < 1e-6 && q[1].abs() < 1e-6, "it stays in the corner: {q:?}");
    for seed in 0..60_u64 {
        let mut random = Random(seed);
        let room = [random.within(0.2, 2.0), random.within(0.2, 2.0)];
        let target = [random.within(-0.5, 0.5), random.within(-0.5, 0.5)];
        let yaw = if seed.is_multiple_of(2) { 0.0 } else { random.within(-3.0, 3.0) };
        drive(room, vec![0.0, 0.0, yaw], target, 1500);
    }
}
