//! A robot that is drawn into itself.

use moca_model::whole_body::ik::IkBuilder;
use moca_model::whole_body::limits::VelocityInterval;
use moca_model::whole_body::stack::TaskLevel;
use moca_model::whole_body::tasks::PositionTask;
use moca_model::whole_body::{Data, Ik, Model};
use moca_model::{Error, MOCA_BASE_JOINTS, MOCA_HOME, SelfCollisionLimit, moca, moca_safety};
use nalgebra::{Point3, Vector3};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Distance of two segments by points on them \[m\], at most 2 mm too large for those of an arm.
fn sampled(first: [Vector3<f64>; 2], second: [Vector3<f64>; 2]) -> f64 {
    let points = |[start, end]: [Vector3<f64>; 2]| {
        (0..=100).map(move |share| start + (end - start) * (f64::from(share) / 100.0))
    };
    let apart =
        |a: Vector3<f64>| points(second).map(move |b| (a - b).norm()).fold(f64::MAX, f64::min);
    points(first).map(apart).fold(f64::MAX, f64::min)
}

/// Least distance of the pairs of MOCA's own bodies at a configuration \[m\].
fn least(model: &Model, data: &mut Data, q: &[f64]) -> f64 {
    let safety = moca_safety();
    let posed = data.pose(model, q).unwrap();
    let placed = |index: usize| {
        let body = &safety.bodies[index];
        let pose = posed.world_from(model.frame_id(&body.link).unwrap()).unwrap();
        let ends = [body.capsule.start(), body.capsule.end()];
        (ends.map(|end| (pose * Point3::from(*end)).coords), body.capsule.radius())
    };
    let distances = safety.own_pairs.iter().map(|&(i, j)| {
        let ((first, one), (second, other)) = (placed(i), placed(j));
        sampled(first, second) - one - other
    });
    distances.fold(f64::MAX, f64::min)
}

/// Draws the tool to a point while the base stands, and returns the least distance on the way and at the end \[m\].
fn drawn_to(target: Point3<f64>, limit: impl FnOnce(&Model, &mut IkBuilder)) -> [f64; 2] {
    let (model, period) = (moca().unwrap(), 2e-3);
    let mut builder = Ik::builder(&model);
    limit(&model, &mut builder);
    let mut level = TaskLevel::new("tool");
    let task = level.push("tool", PositionTask::new(model.frame_id("panda_hand").unwrap()));
    builder.push_level(level);
    let (mut ik, mut q) = (builder.build_at(&MOCA_HOME).unwrap(), MOCA_HOME.to_vec());
    ik.task_mut(task).unwrap().set_target(target).unwrap();
    let free = VelocityInterval { lower: f64::NEG_INFINITY, upper: f64::INFINITY };
    let mut within = vec![free; MOCA_HOME.len()];
    within[..MOCA_BASE_JOINTS].fill(VelocityInterval { lower: 0.0, upper: 0.0 });
    let (mut data, mut nearest) = (Data::new(&model), f64::MAX);
    for tick in 0..2500 {
        ik.step_within(&q, period, &within).unwrap().integrate(&mut q).unwrap();
        if tick % 10 == 0 {
            nearest = nearest.min(least(&model, &mut data, &q));
        }
    }
    [nearest, least(&model, &mut data, &q)]
}

fn own_bodies(model: &Model) -> SelfCollisionLimit {
    let safety = moca_safety();
    SelfCollisionLimit::new(model, &safety.bodies, &safety.own_pairs).unwrap()
}

#[test]
fn arms_stay_away_from_their_own_base() {
    let mut draw = ChaCha8Rng::seed_from_u64(1);
    let (mut collisions, mut near) = (0, 0);
    for _ in 0..8 {
        let target = Point3::new(
            draw.random_range(-0.1..0.5),
            draw.random_range(-0.3..0.3),
            draw.random_range(0.1..0.5),
        );
        let [nearest, end] = drawn_to(target, |model, builder| {
            builder.limit("own bodies", own_bodies(model));
        });
        // The margin is 0.03 m.
        assert!(nearest > 0.028, "{nearest} m on the way to {target}");
        near += usize::from(end < 0.05);
        let [bare, _] = drawn_to(target, |_, _| {});
        collisions += usize::from(bare < 0.0);
    }
    assert!(collisions >= 4, "only {collisions} of 8 arms collide without the limit");
    assert!(near >= 4, "only {near} of 8 arms come near their margin");
}

#[test]
fn margins_are_those_that_are_asked_for() {
    let target = Point3::new(0.2, 0.0, 0.3);
    for margin in [0.0, 0.1] {
        let [nearest, end] = drawn_to(target, |model, builder| {
            builder.limit("own bodies", own_bodies(model).with_margin(margin, 1.0).unwrap());
        });
        assert!(nearest > margin - 2e-3 && end < margin + 0.02, "{margin}: {nearest} and {end} m");
    }
}

#[test]
fn pairs_without_bodies_are_refused() {
    let (model, safety) = (moca().unwrap(), moca_safety());
    let refused = |pairs: &[(usize, usize)]| {
        SelfCollisionLimit::new(&model, &safety.bodies, pairs).unwrap_err()
    };
    assert!(matches!(refused(&[(0, 99)]), Error::Value { value: 99.0, .. }));
    assert!(matches!(refused(&[]), Error::Value { value: 0.0, .. }));
    let mut strange = safety.bodies.clone();
    strange[safety.own_pairs[0].0].link = "fr3_link1".to_owned();
    let unknown = SelfCollisionLimit::new(&model, &strange, &safety.own_pairs).unwrap_err();
    assert!(unknown.to_string().contains("fr3_link1"), "{unknown}");
    for (margin, deceleration) in [(-0.1, 2.0), (f64::NAN, 2.0), (0.03, 0.0)] {
        assert!(matches!(
            own_bodies(&model).with_margin(margin, deceleration),
            Err(Error::Safety(_))
        ));
    }
}
