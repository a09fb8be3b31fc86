//! Limits hold for all tasks and from all starts.

use nalgebra::{Point3, UnitQuaternion, Vector3};
use proptest::prelude::*;
use whole_body::ik::IkBuilder;
use whole_body::limits::{FrameVelocityLimit, WheelLimit};
use whole_body::robot::LimitOverride;
use whole_body::stack::TaskId;
use whole_body::tasks::{OrientationTask, PositionTask, PostureTask};
use whole_body::{Description, Ik, Model};

use crate::support::monitor::Monitor;
use crate::support::stacks::{PERIOD, Random, bush, humanoid, moca, panda, two_arms};
use crate::support::{last_frame, pose};

/// Number of ticks for each robot. The environment variable `WHOLE_BODY_TICKS` sets another one for all five.
fn ticks() -> u64 {
    let asked = std::env::var("WHOLE_BODY_TICKS").ok().and_then(|text| text.parse::<u64>().ok());
    asked.map_or(3000, |all| all / 5)
}

/// Number of random cases of each property. The environment variable `WHOLE_BODY_CASES` sets another one.
fn cases() -> u32 {
    std::env::var("WHOLE_BODY_CASES").ok().and_then(|text| text.parse().ok()).unwrap_or(12)
}

struct Tasks {
    position: TaskId<PositionTask>,
    orientation: TaskId<OrientationTask>,
    posture: TaskId<PostureTask>,
}

fn tasks(builder: &mut IkBuilder, model: &Model) -> Tasks {
    let tip = last_frame(model);
    Tasks {
        position: builder.push("position", PositionTask::new(tip)),
        orientation: builder.push("orientation", OrientationTask::new(tip)),
        posture: builder.push("posture", PostureTask::new()),
    }
}

fn random_targets(ik: &mut Ik, tasks: &Tasks, model: &Model, random: &mut Random) {
    let elsewhere = random.configuration(model, 0.1);
    let near = pose(model, &elsewhere, last_frame(model));
    let mut vector = |size: f64| Vector3::from_fn(|_, _| random.within(-size, size));
    let (place, speed, turn) = (vector(0.3), vector(1.0), vector(3.0));
    let point = Point3::from(near.translation.vector + place);
    ik.task_mut(tasks.position).unwrap().set_moving_target(point, speed).unwrap();
    let orientation = UnitQuaternion::from_scaled_axis(turn);
    ik.task_mut(tasks.orientation).unwrap().set_target(orientation).unwrap();
    ik.task_mut(tasks.posture).unwrap().set_target(&elsewhere).unwrap();
}

/// Random starts, some outside the limits, and random targets that jump.
fn soak(model: &Model, seed: u64, ticks: u64) {
    let mut random = Random(seed);
    let (mut done, episode) = (0, 700);
    while done < ticks {
        let mut builder = Ik::builder(model);
        let tasks = tasks(&mut builder, model);
        let mut ik = builder.build().unwrap();
        let mut q = random.configuration(model, 0.1);
        let mut monitor = Monitor::new(model, &q);
        for tick in 0..episode {
            if tick % 150 == 0 {
                random_targets(&mut ik, &tasks, model, &mut random);
            }
            let step = ik.step(&q, PERIOD).unwrap();
            assert_eq!(step.status(), whole_body::stack::Status::Solved);
            step.integrate(&mut q).unwrap();
            monitor.check(&q);
        }
        done += episode;
    }
}

#[test]
fn of_a_panda_hold() {
    soak(&panda(), 1, ticks());
}

#[test]
fn of_two_arms_on_a_base_hold() {
    soak(&two_arms(), 2, ticks());
}

#[test]
fn of_a_humanoid_hold() {
    soak(&humanoid(), 3, ticks());
}

#[test]
fn of_a_bush_hold() {
    soak(&bush(), 4, ticks());
}

#[test]
fn of_moca_hold() {
    soak(&moca(), 5, ticks());
}

#[test]
fn joints_outside_come_back_and_rest_there() {
    let model = panda();
    let mut q = vec![3.2, -2.0, 0.0, 0.3, 0.0, 4.2, -3.3];
    let mut builder = Ik::builder(&model);
    let posture = builder.push("posture", PostureTask::new());
    let mut ik = builder.build().unwrap();
    ik.task_mut(posture).unwrap().set_target(&q.clone()).unwrap();
    let mut monitor = Monitor::new(&model, &q);
    for _ in 0..2000 {
        ik.step(&q, PERIOD).unwrap().integrate(&mut q).unwrap();
        monitor.check(&q);
    }
    for (q, limits) in q.iter().zip(model.limits()) {
        assert!(*q <= limits.upper + 1e-9 && *q >= limits.lower - 1e-9);
    }
    assert!((q[0] - model.limits()[0].upper).abs() < 1e-6, "the posture still pulls outwards");
    assert!(ik.velocity().iter().all(|v| v.abs() < 1e-6));
}

/// The measurement of a moving arm is lost.
#[test]
fn braking_after_bad_step_keeps_limits() {
    let model = panda();
    let mut builder = Ik::builder(&model);
    let tasks = tasks(&mut builder, &model);
    let mut ik = builder.build().unwrap();
    let mut q = vec![0.0, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785];
    let (mut random, mut monitor) = (Random(6), Monitor::new(&model, &q));
    for _ in 0..3 {
        random_targets(&mut ik, &tasks, &model, &mut random);
        for _ in 0..150 {
            ik.step(&q, PERIOD).unwrap().integrate(&mut q).unwrap();
            monitor.check(&q);
        }
        assert!(ik.velocity().iter().any(|v| v.abs() > 0.1));
        for _ in 0..1000 {
            assert!(ik.step(&[f64::NAN; 7], PERIOD).is_err());
            let velocity = ik.brake(PERIOD).unwrap();
            q.iter_mut().zip(velocity).for_each(|(q, v)| *q += v * PERIOD);
            monitor.check(&q);
        }
        assert!(ik.velocity().iter().all(|v| v.abs() < 1e-9));
    }
}

/// The stretched arm is singular, and the remaining error cannot be reduced.
#[test]
fn arm_rests_at_an_unreachable_target() {
    let model = panda();
    let tool = model.frame_id("panda_hand_tcp").unwrap();
    for far in [
        Vector3::new(1.5, 0.3, 0.5),
        Vector3::new(0.2, -1.6, 0.9),
        Vector3::new(-0.9, 0.8, 0.4),
        Vector3::new(1.0, 1.0, 1.0),
        Vector3::new(0.95, 0.0, 0.3),
    ] {
        let mut builder = Ik::builder(&model);
        let tasks = tasks(&mut builder, &model);
        let mut q = vec![0.0, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785];
        let mut ik = builder.build_at(&q).unwrap();
        ik.task_mut(tasks.position).unwrap().set_target(far).unwrap();
        let mut monitor = Monitor::new(&model, &q);
        let (mut fastest, mut strongest) = (0.0_f64, 0.0_f64);
        for tick in 0..12_000 {
            let step = ik.step(&q, PERIOD).unwrap();
            if tick > 11_000 {
                let most = |values: &[f64]| values.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
                fastest = fastest.max(most(step.velocity()));
                strongest = strongest.max(most(step.acceleration()));
            }
            step.integrate(&mut q).unwrap();
            monitor.check(&q);
        }
        assert!(fastest < 1e-2 && strongest < 0.1, "{far}: {fastest} rad/s, {strongest} rad/s²");
        // The expected point is as far as the arm reaches in that direction from its shoulder.
        let reached = pose(&model, &q, tool).translation.vector;
        let shoulder = Vector3::new(0.0, 0.0, 0.333);
        let (way, wanted) = (reached - shoulder, far - shoulder);
        assert!(way.angle(&wanted) < 0.05 && way.norm() > 0.8, "{reached} for {far}");
    }
}

#[test]
fn periods_may_vary() {
    let model = panda();
    let mut random = Random(6);
    let mut builder = Ik::builder(&model);
    let tasks = tasks(&mut builder, &model);
    let mut ik = builder.build().unwrap();
    let mut q = random.configuration(&model, 0.0);
    for tick in 0..5000 {
        if tick % 300 == 0 {
            random_targets(&mut ik, &tasks, &model, &mut random);
        }
        let period = random.within(0.2e-3, 5e-3);
        ik.step(&q, period).unwrap().integrate(&mut q).unwrap();
        for (q, limits) in q.iter().zip(model.limits()) {
            assert!(*q <= limits.upper + 1e-9 && *q >= limits.lower - 1e-9);
        }
    }
}

#[test]
fn a_frame_keeps_its_cartesian_limits() {
    let model = panda();
    let tool = model.frame_id("panda_hand_tcp").unwrap();
    let mut random = Random(7);
    let mut builder = Ik::builder(&model);
    let (linear, angular) = (Vector3::new(0.1, 0.2, 0.3), Vector3::repeat(0.5));
    builder.limit("slow tool", FrameVelocityLimit::new(tool, linear, angular));
    let tasks = tasks(&mut builder, &model);
    let mut ik = builder.build().unwrap();
    let mut q = random.configuration(&model, 0.0);
    let mut monitor = Monitor::new(&model, &q);
    let mut binding = 0;
    for tick in 0..3000 {
        if tick % 300 == 0 {
            random_targets(&mut ik, &tasks, &model, &mut random);
        }
        let before = pose(&model, &q, tool);
        let step = ik.step(&q, PERIOD).unwrap();
        binding += step.active_rows().filter(|row| row.task == "slow tool").count();
        step.integrate(&mut q).unwrap();
        monitor.check(&q);
        let twist = crate::support::twist_between(&before, &pose(&model, &q, tool), PERIOD);
        for (axis, limit) in [0.1, 0.2, 0.3, 0.5, 0.5, 0.5].into_iter().enumerate() {
            assert!(twist[axis].abs() <= limit * (1.0 + 1e-9), "{twist} along {axis} at {tick}");
        }
    }
    assert!(binding > 100, "the limits were active in {binding} rows");
}

#[test]
fn wheel_limits_keep_speed_and_direction() {
    let model = two_arms();
    let base = model.frame_id("base").unwrap();
    for (name, limit) in [
        ("mecanum", WheelLimit::mecanum(0.6, 0.4)),
        ("omni", WheelLimit::omni(0.4, 0.2, &[0.0, 2.0944, -2.0944])),
        ("differential", WheelLimit::differential(0.5, 0.5)),
    ] {
        let mut builder = Ik::builder(&model);
        builder.limit(name, limit);
        let position = builder.push("position", PositionTask::new(base).with_gain(3.0));
        let posture = builder.push("posture", PostureTask::new().with_gain(3.0));
        let mut ik = builder.build().unwrap();
        let mut q = model.neutral();
        let mut random = Random(8);
        let mut monitor = Monitor::new(&model, &q);
        let (mut fastest, mut sideways) = (0.0_f64, 0.0_f64);
        for tick in 0..6000 {
            if tick % 1000 == 0 {
                let mut to = model.neutral();
                to[2] = random.within(-3.0, 3.0);
                let place = Point3::new(random.within(-2.0, 2.0), random.within(-2.0, 2.0), 0.0);
                ik.task_mut(position).unwrap().set_target(place).unwrap();
                ik.task_mut(posture).unwrap().set_target(&to).unwrap();
            }
            let yaw = q[2];
            let step = ik.step(&q, PERIOD).unwrap();
            let v = step.velocity();
            let (sine, cosine) = yaw.sin_cos();
            let (x, y, turn) = (cosine * v[0] + sine * v[1], cosine * v[1] - sine * v[0], v[2]);
            let (used, room) = match name {
                "mecanum" => (x.abs() + y.abs() + 0.4 * turn.abs(), 0.6),
                "omni" => {
                    let rims = [0.0_f64, 2.0944, -2.0944]
                        .map(|angle| (-angle.sin() * x + angle.cos() * y + 0.2 * turn).abs());
                    (rims.into_iter().fold(0.0, f64::max), 0.4)
                }
                _ => {
                    sideways = sideways.max(y.abs());
                    (x.abs() + 0.25 * turn.abs(), 0.5)
                }
            };
            fastest = fastest.max(used / room);
            step.integrate(&mut q).unwrap();
            monitor.check(&q);
        }
        assert!(fastest > 0.99, "{name} was never at its limit: {fastest}");
        assert!(fastest < 1.0 + 1e-9 && sideways < 1e-9, "{name}: {fastest}, {sideways} sideways");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(cases()))]

    /// Limits of acceleration and jerk are random, and targets jump.
    #[test]
    fn wheels_keep_their_speed_with_jerk_limits(
        seed in any::<u64>(), acceleration in 0.3..3.0_f64, time in 0.02..0.5_f64,
        is_omni in any::<bool>(),
    ) {
        let urdf = include_str!("../../examples/urdf/two_arms.urdf");
        let slow = |velocity| LimitOverride {
            jerk: Some(acceleration / time),
            ..LimitOverride::of_speed(velocity, acceleration)
        };
        let description = Description::on_planar_base(slow(1.0), slow(2.0));
        let model = Model::from_urdf(urdf, &description).unwrap();
        let base = model.frame_id("base").unwrap();
        let angles = [0.0_f64, 2.0944, -2.0944];
        let mut builder = Ik::builder(&model);
        builder.limit("wheels", if is_omni {
            WheelLimit::omni(0.4, 0.2, &angles)
        } else {
            WheelLimit::mecanum(0.6, 0.4)
        });
        let position = builder.push("position", PositionTask::new(base).with_gain(3.0));
        let posture = builder.push("posture", PostureTask::new().with_gain(3.0));
        let mut q = model.neutral();
        let mut ik = builder.build_at(&q).unwrap();
        let mut random = Random(seed);
        let mut monitor = Monitor::new(&model, &q);
        for tick in 0..3000 {
            if tick % 300 == 0 {
                let mut to = model.neutral();
                to[2] = random.within(-3.0, 3.0);
                let place = Point3::new(random.within(-2.0, 2.0), random.within(-2.0, 2.0), 0.0);
                ik.task_mut(position).unwrap().set_target(place).unwrap();
                ik.task_mut(posture).unwrap().set_target(&to).unwrap();
            }
            let yaw = q[2];
            let step = ik.step(&q, PERIOD).unwrap();
            let v = step.velocity();
            let (sine, cosine) = yaw.sin_cos();
            let (x, y, turn) = (cosine * v[0] + sine * v[1], cosine * v[1] - sine * v[0], v[2]);
            let used = if is_omni {
                let rim = |a: f64| (-a.sin() * x + a.cos() * y + 0.2 * turn).abs() / 0.4;
                angles.map(rim).into_iter().fold(0.0, f64::max)
            } else {
                (x.abs() + y.abs() + 0.4 * turn.abs()) / 0.6
            };
            prop_assert!(used <= 1.0 + 1e-9, "{} of the limit at {}", used, tick);
            step.integrate(&mut q).unwrap();
            monitor.check(&q);
        }
    }

    /// The robot starts at rest, and targets jump.
    #[test]
    fn frames_keep_their_cartesian_limits(
        seed in any::<u64>(), linear in 0.05..0.5_f64, angular in 0.2..1.5_f64,
    ) {
        let (used, tick) = largest_use_of_cartesian_limits(seed, linear, angular);
        prop_assert!(used <= 1.0 + 1e-9, "{} of the limit at {}", used, tick);
    }
}

/// Fast joints cancel each other at the tool. One reaches its limit, or the tool rotates beside them.
#[test]
fn joints_that_cancel_at_a_frame_stop_together() {
    for (seed, linear, angular) in [
        (14383529963883085110, 0.122, 0.944),
        (2459872489240293171, 0.264, 0.712),
        (13210018171784308505, 0.068, 0.484),
        (5033118888923405780, 0.093, 0.774),
        (4955984671668881241, 0.071, 0.440),
    ] {
        let (used, tick) = largest_use_of_cartesian_limits(seed, linear, angular);
        assert!(used <= 1.0 + 1e-9, "seed {seed}: {used} of the limit at {tick}");
    }
}

/// The largest velocity of a Panda's tool over its limits \[m/s, rad/s\], and its tick. The robot starts at rest, and
/// targets jump.
fn largest_use_of_cartesian_limits(seed: u64, linear: f64, angular: f64) -> (f64, usize) {
    let model = panda();
    let tool = model.frame_id("panda_hand_tcp").unwrap();
    let mut random = Random(seed);
    let mut builder = Ik::builder(&model);
    let limits = [Vector3::repeat(linear), Vector3::repeat(angular)];
    builder.limit("tool", FrameVelocityLimit::new(tool, limits[0], limits[1]));
    let tasks = tasks(&mut builder, &model);
    let mut q = random.configuration(&model, 0.0);
    let mut ik = builder.build_at(&q).unwrap();
    let mut most = (0.0, 0);
    for tick in 0..1500 {
        if tick % 200 == 0 {
            random_targets(&mut ik, &tasks, &model, &mut random);
        }
        let before = pose(&model, &q, tool);
        ik.step(&q, PERIOD).unwrap().integrate(&mut q).unwrap();
        let twist = crate::support::twist_between(&before, &pose(&model, &q, tool), PERIOD);
        let used = (twist.fixed_rows::<3>(0).amax() / linear)
            .max(twist.fixed_rows::<3>(3).amax() / angular);
        if used > most.0 {
            most = (used, tick);
        }
    }
    most
}
