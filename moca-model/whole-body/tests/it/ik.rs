//! Priorities, weights, masks, names, and reports of steps.

use nalgebra::{Point3, Vector3, Vector6};
use proptest::prelude::*;
use whole_body::limits::{End, LimitKind};
use whole_body::stack::TaskLevel;
use whole_body::tasks::{
    Axis, CentreOfMassTask, Feedback, FrameTask, OrientationTask, PositionTask, PostureTask,
    VelocityTask,
};
use whole_body::{Ik, Model};

use crate::support::stacks::{PERIOD, Random, bush, humanoid, moca, panda, two_arms};
use crate::support::{last_frame, pose};

fn robots() -> [Model; 5] {
    [panda(), two_arms(), humanoid(), bush(), moca()]
}

/// Slacks of the first `count` of four levels after one step, from rest or in motion.
fn slacks(model: &Model, seed: u64, count: usize) -> Vec<f64> {
    let mut random = Random(seed);
    let q = random.configuration(model, 0.0);
    let mut around = || Vector3::from_fn(|_, _| random.within(-0.3, 0.3));
    let frames: Vec<_> = model.frames().map(|(frame, _)| frame).collect();
    let middle = frames[frames.len() / 2];
    let (tip, centre) = (pose(model, &q, last_frame(model)), pose(model, &q, middle));
    let targets = [around(), around(), around()];
    let mut builder = Ik::builder(model);
    let mut rows = VelocityTask::new(2);
    let ones = vec![1.0; model.velocity_count()];
    rows.set_row(0, &ones, 0.1, f64::INFINITY).unwrap();
    rows.set_row(1, &ones[..2], -0.2, 0.2).unwrap();
    builder.push("rows", rows);
    if count > 1 {
        let mut task = PositionTask::new(last_frame(model));
        task.set_target(Point3::from(tip.translation.vector + targets[0])).unwrap();
        builder.push("position", task);
    }
    if count > 2 {
        let mut task = OrientationTask::new(last_frame(model));
        let turn = nalgebra::UnitQuaternion::from_scaled_axis(targets[1]);
        task.set_target(turn * tip.rotation).unwrap();
        builder.push("orientation", task);
    }
    if count > 3 {
        let mut task = CentreOfMassTask::new(model).with_axes(&[Axis::X]);
        task.set_target(Point3::from(centre.translation.vector + targets[2])).unwrap();
        builder.push("middle", task);
    }
    let mut ik = builder.build().unwrap();
    let v: Vec<f64> =
        model.limits().iter().map(|l| random.within(-0.3, 0.3) * l.velocity.min(1.0)).collect();
    ik.reset(&v).unwrap();
    let step = ik.step(&q, PERIOD).unwrap();
    step.levels().map(|level| level.slack).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn a_lower_task_never_costs_a_higher_one(seed in any::<u64>(), robot in 0_usize..5) {
        let model = &robots()[robot];
        let all: Vec<_> = (1..=4).map(|count| slacks(model, seed, count)).collect();
        for (fewer, more) in all.iter().zip(&all[1..]) {
            for (one, other) in fewer.iter().zip(more) {
                prop_assert!((one - other).abs() <= 1e-8 * (1.0 + one), "{:?} {:?}", fewer, more);
            }
        }
    }
}

/// Two tasks of one level contradict each other and meet where their weights say.
#[test]
fn weights_of_a_level_divide_what_is_missing() {
    let model = panda();
    let mut q = vec![0.0, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785];
    let tool = model.frame_id("panda_hand_tcp").unwrap();
    let start = pose(&model, &q, tool).translation.vector;
    let mut level = TaskLevel::new("both");
    let weights = Vector3::new(1.0, 3.0, 1.0);
    let task =
        PositionTask::new(tool).with_feedback(Feedback { gain: 20.0, deceleration: f64::INFINITY });
    let one = level.push("one", task.clone().with_weights(weights));
    let other = level.push("other", task);
    let mut builder = Ik::builder(&model);
    builder.push_level(level);
    let posture = builder.push("posture", PostureTask::new());
    let mut ik = builder.build().unwrap();
    let apart = Vector3::new(0.04, 0.04, 0.0);
    ik.task_mut(one).unwrap().set_target(Point3::from(start + apart)).unwrap();
    ik.task_mut(other).unwrap().set_target(Point3::from(start)).unwrap();
    ik.task_mut(posture).unwrap().set_target(&q).unwrap();
    for _ in 0..3000 {
        ik.step(&q, PERIOD).unwrap().integrate(&mut q).unwrap();
    }
    let moved = pose(&model, &q, tool).translation.vector - start;
    assert!((moved - Vector3::new(0.02, 0.03, 0.0)).norm() < 1e-6, "{moved}");
}

#[test]
fn coordinates_that_a_mask_leaves_out_are_free() {
    let model = panda();
    let mut q = vec![0.0, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785];
    let tool = model.frame_id("panda_hand_tcp").unwrap();
    let start = pose(&model, &q, tool);
    let mut builder = Ik::builder(&model);
    let height = builder.push("height", PositionTask::new(tool).with_axes(&[Axis::Z]));
    let pull = builder.push("pull", FrameTask::new(tool));
    let mut ik = builder.build().unwrap();
    let up = Vector3::new(0.0, 0.0, 0.05);
    ik.task_mut(height).unwrap().set_target(Point3::from(start.translation.vector + up)).unwrap();
    let mut aside = start;
    aside.translation.vector += Vector3::new(0.05, 0.05, -0.2);
    ik.task_mut(pull).unwrap().set_target(aside).unwrap();
    for _ in 0..3000 {
        ik.step(&q, PERIOD).unwrap().integrate(&mut q).unwrap();
    }
    let end = pose(&model, &q, tool).translation.vector;
    let wanted = Vector3::new(aside.translation.x, aside.translation.y, start.translation.z + 0.05);
    assert!((end - wanted).norm() < 1e-4, "{end} for {wanted}");
}

/// The frame follows without lag if the target's velocity is given. Otherwise it lags by the velocity over the gain.
#[test]
fn feed_forward_takes_the_lag_away() {
    let model = panda();
    let tool = model.frame_id("panda_hand_tcp").unwrap();
    for (feed_forward, lag) in [(1.0, 0.0), (0.0, 0.05 / 20.0 + 0.05 * 0.05 / 5.0)] {
        let mut q = vec![0.0, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785];
        let start = pose(&model, &q, tool).translation.vector;
        let mut builder = Ik::builder(&model);
        let position = builder.push("position", PositionTask::new(tool));
        let mut ik = builder.build().unwrap();
        let speed = Vector3::new(0.0, 0.05, 0.0);
        let mut behind = 0.0;
        for tick in 0..2000 {
            let target = start + speed * (f64::from(tick) * PERIOD);
            let task = ik.task_mut(position).unwrap();
            task.set_moving_target(Point3::from(target), speed * feed_forward).unwrap();
            behind = (target - pose(&model, &q, tool).translation.vector).norm();
            ik.step(&q, PERIOD).unwrap().integrate(&mut q).unwrap();
        }
        // The expected lag solves v/gain + v²/(2 deceleration).
        assert!((behind - lag).abs() < 2e-5, "{behind} for {lag}");
    }
}

#[test]
fn a_step_names_what_limits_it() {
    let model = panda();
    let mut q = vec![0.0, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785];
    let tool = model.frame_id("panda_hand_tcp").unwrap();
    let mut builder = Ik::builder(&model);
    let frame = builder.push("pose", FrameTask::new(tool));
    let mut ik = builder.build().unwrap();
    let mut target = pose(&model, &q, tool);
    target.translation.vector += Vector3::new(0.0, 2.0, 0.0);
    let turn = Vector6::new(0.0, 20.0, 0.0, 0.0, 0.0, 0.0);
    ik.task_mut(frame).unwrap().set_moving_target(target, turn).unwrap();
    let mut seen = std::collections::HashSet::new();
    for _ in 0..2000 {
        let step = ik.step(&q, PERIOD).unwrap();
        assert!(step.slack(frame).unwrap() > 0.0);
        for active in step.active_limits() {
            seen.insert((active.name.to_owned(), active.kind, active.end));
        }
        step.integrate(&mut q).unwrap();
    }
    let first = |kind| (String::from("panda_joint1"), kind, End::Upper);
    for kind in [LimitKind::Jerk, LimitKind::Acceleration, LimitKind::Velocity, LimitKind::Position]
    {
        assert!(seen.contains(&first(kind)), "{kind:?} in {seen:?}");
    }
}

/// Levels that minimise quadratics, with hard constraints, over variables beside q̇.
mod quadratics {
    use nalgebra::{Matrix1, Vector1};
    use whole_body::stack::{Budget, TaskLevel, TaskStack};
    use whole_body::tasks::{QuadraticTask, TaskInput, TaskQuadratic, VariableLayout, Variables};
    use whole_body::{Data, Error};

    use super::*;

    /// ½ (x − target)².
    #[derive(Debug, Clone)]
    struct Near {
        variable: Variables,
        target: f64,
    }

    impl QuadraticTask for Near {
        fn write(
            &mut self,
            _input: &mut TaskInput<'_, '_>,
            quadratic: &mut TaskQuadratic<'_>,
        ) -> Result<(), Error> {
            let range = self.variable.range();
            quadratic.add(range, &Matrix1::new(1.0), &Vector1::new(-self.target))
        }
    }

    #[test]
    fn are_added_within_constraints_and_traded_against_velocities() {
        let model = panda();
        let mut layout = VariableLayout::new(&model);
        let variable = layout.add("rate", 1);
        let mut near = TaskLevel::new("near");
        let one = near.push_quadratic("one", Near { variable: variable.clone(), target: 3.0 });
        near.push_quadratic("other", Near { variable: variable.clone(), target: 5.0 });
        // q̇₀ − x = 0, and x ≤ 3.5.
        let mut rows = VelocityTask::new(2);
        rows.set_row(0, &[1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -1.0], 0.0, 0.0).unwrap();
        rows.set_row(1, &[0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0], f64::NEG_INFINITY, 3.5).unwrap();
        near.constrain("tied", rows);
        let levels = vec![near];
        let mut stack =
            TaskStack::new(&model, &layout, levels, whole_body::stack::Settings::default())
                .unwrap();
        let mut data = Data::new(&model);
        let mut solve = |stack: &mut TaskStack| {
            let mut posed = data.pose(&model, &model.neutral()).unwrap();
            stack.write(&mut posed, &[0.0; 7], PERIOD).unwrap();
            let x = stack.solve(Budget::default()).unwrap().best().to_vec();
            (x[0], x[7])
        };
        let (velocity, rate) = solve(&mut stack);
        assert!((velocity - 3.5).abs() < 1e-9 && (rate - 3.5).abs() < 1e-9);
        // A clone has its own targets, under the same ids.
        let mut clone = stack.clone();
        clone.task_mut(one).unwrap().target = 0.0;
        let (velocity, rate) = solve(&mut clone);
        assert!((velocity - 2.5).abs() < 1e-9 && (rate - 2.5).abs() < 1e-9);
        assert!((solve(&mut stack).0 - 3.5).abs() < 1e-9);
    }

    #[test]
    fn stand_on_levels_of_their_own() {
        let model = panda();
        let mut builder = Ik::builder(&model);
        let variable = builder.variables("rate", 1);
        let mut level = TaskLevel::new("mixed");
        level.push_quadratic("near", Near { variable, target: 1.0 });
        level.push("posture", PostureTask::new());
        builder.push_level(level);
        let error = builder.build().unwrap_err();
        assert!(matches!(error, Error::MixedLevel { .. }), "{error}");
        assert!(error.to_string().contains("mixed"));
    }
}

/// Targets that were not set are set to the present state; others are kept.
#[test]
fn build_at_holds_what_has_no_target() {
    let model = panda();
    let tool = model.frame_id("panda_hand_tcp").unwrap();
    let mut q = vec![0.0, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785];
    let start = pose(&model, &q, tool);
    let mut builder = Ik::builder(&model);
    let mut reach = PositionTask::new(tool);
    reach.set_target(start.translation.vector + Vector3::new(0.0, 0.1, 0.0)).unwrap();
    builder.push("reach", reach);
    builder.push("orientation", OrientationTask::new(tool));
    builder.push("posture", PostureTask::new());
    let mut ik = builder.build_at(&q).unwrap();
    for _ in 0..2000 {
        ik.step(&q, PERIOD).unwrap().integrate(&mut q).unwrap();
    }
    let end = pose(&model, &q, tool);
    assert!((end.translation.vector - start.translation.vector).y - 0.1 < 1e-6);
    assert!(end.rotation.angle_to(&start.rotation) < 1e-6);
}
