//! Distances, protective separation, approach rows and speed caps.

mod bad_input;

use crate::support::*;
use ahqp_core::{AugmentedState, Rows, integrate_pose};
use hrsw_safety::{
    ApproachRows, Capsule, Contact, ContactLimit, Error, JointMotion, MeasuredVelocity, Nearest,
    PersonBody, RobotBody, SeparationSettings, SpeedCap, Supervisor, SupervisorSettings, proximity,
};
use nalgebra::{DMatrix, DVector, Isometry3, Matrix3x6, Matrix6xX, Vector3, Vector6};
use parry3d_f64::math::{Pose, Vector};
use parry3d_f64::shape::Capsule as ParryCapsule;
use proptest::prelude::*;

const JOINTS: usize = 4;

/// Returns the capsule after `time` of the twist, which is linear at `origin`.
fn carried(capsule: &Capsule, twist: &Vector6<f64>, origin: &Vector3<f64>, time: f64) -> Capsule {
    let at = Isometry3::translation(origin.x, origin.y, origin.z);
    capsule.placed(&at.inverse()).placed(&integrate_pose(&at, twist, time))
}

/// Returns the distances of the capsules and of their segments.
fn parry_distances(a: &Capsule, b: &Capsule) -> (f64, f64) {
    let shape = |c: &Capsule| {
        let point = |v: &Vector3<f64>| Vector::new(v.x, v.y, v.z);
        ParryCapsule::new(point(c.start()), point(c.end()), c.radius())
    };
    let (a, b) = (shape(a), shape(b));
    let here = Pose::IDENTITY;
    let capsules = parry3d_f64::query::distance(&here, &a, &here, &b).unwrap().distance;
    let segments = parry3d_f64::query::distance(&here, &a.segment, &here, &b.segment).unwrap();
    (capsules, segments.distance)
}

fn settings() -> impl Strategy<Value = SeparationSettings> {
    (0.0..2.5_f64, 0.01..0.5_f64, 0.3..10.0_f64, 0.0..0.3_f64, 0.0..0.1_f64).prop_map(
        |(human_speed, reaction_time, deceleration, intrusion, uncertainty)| SeparationSettings {
            human_speed,
            arm_speed: human_speed,
            reaction_time,
            deceleration,
            base: None,
            intrusion,
            human_uncertainty: uncertainty,
            robot_uncertainty: 0.5 * uncertainty,
        },
    )
}

fn jacobian() -> impl Strategy<Value = Matrix6xX<f64>> {
    prop::collection::vec(-1.0..1.0_f64, 6 * JOINTS).prop_map(Matrix6xX::from_vec)
}

fn joints() -> impl Strategy<Value = [f64; JOINTS]> {
    prop::array::uniform4(-1.0..1.0_f64)
}

fn robot() -> impl Strategy<Value = Vec<RobotBody>> {
    let body =
        (capsule(0.8), 0..=JOINTS).prop_map(|(capsule, joints)| RobotBody { capsule, joints });
    prop::collection::vec(body, 1..6)
}

fn person() -> impl Strategy<Value = Vec<PersonBody>> {
    let velocity = (vector(1.0), 0.0..0.5_f64)
        .prop_map(|(mean, uncertainty)| MeasuredVelocity { mean, uncertainty });
    let body = (
        capsule(1.5),
        prop::option::of(velocity),
        0.0..2.5_f64,
        0.0..0.2_f64,
        prop::option::of(contact()),
    )
        .prop_map(|(capsule, velocity, assumed_speed, age, contact)| PersonBody {
            assumed_speed,
            capsule,
            velocity,
            age,
            uncertainty: 0.0,
            contact,
        });
    prop::collection::vec(body, 1..6)
}

fn contact() -> impl Strategy<Value = Contact> {
    (50.0..300.0_f64, 1e4..1e5_f64, 0.5..75.0_f64, 0.01..0.5_f64).prop_map(
        |(force, stiffness, mass, fastest)| Contact {
            limit: ContactLimit { force, stiffness, mass },
            fastest,
            velocity: None,
        },
    )
}

/// Generates the inverse of an inertia A Aᵀ plus a small multiple of the identity.
fn inverse_inertia() -> impl Strategy<Value = DMatrix<f64>> {
    prop::collection::vec(-1.0..1.0_f64, JOINTS * JOINTS).prop_map(|entries| {
        let root = DMatrix::from_vec(JOINTS, JOINTS, entries);
        &root * root.transpose() + DMatrix::identity(JOINTS, JOINTS) * 0.1
    })
}

fn motion<'a>(
    jacobian: &'a Matrix6xX<f64>,
    origin: Vector3<f64>,
    velocity: &'a [f64],
    braking: &'a [f64],
) -> JointMotion<'a> {
    JointMotion {
        jacobian,
        origin,
        velocity,
        braking: Some(braking),
        change: None,
        inverse_inertia: None,
    }
}

fn state() -> AugmentedState {
    AugmentedState { joints: JOINTS, task: 6, slack: 6 }
}

fn along(row: &[f64], velocity: &[f64]) -> f64 {
    row.iter().zip(velocity).map(|(a, b)| a * b).sum()
}

proptest! {
    #[test]
    fn distances_are_those_of_parry(a in capsule(1.0), b in capsule(1.0)) {
        let near = proximity(&a, &b);
        // parry's query of capsules iterates to five digits. Its query of segments is exact.
        let (capsules, segments) = parry_distances(&a, &b);
        prop_assert!((near.distance.max(0.0) - capsules).abs() < 1e-4);
        prop_assert!((near.distance + a.radius() + b.radius() - segments).abs() < 1e-9);
        let back = proximity(&b, &a);
        prop_assert!((near.distance - back.distance).abs() < 1e-12);
        prop_assert!((near.normal.norm() - 1.0).abs() < 1e-12);
    }

    /// Holds for parallel, touching, crossing and pointlike segments too.
    #[test]
    fn no_points_of_the_segments_are_nearer(
        a in prop::array::uniform3(-2..3_i32), u in prop::array::uniform3(-2..3_i32),
        b in prop::array::uniform3(-2..3_i32), w in prop::array::uniform3(-2..3_i32),
    ) {
        let v = |a: [i32; 3]| Vector3::from(a.map(f64::from));
        let (a, u, b, w) = (v(a), v(u), v(b), v(w));
        let first = Capsule::new(a, a + u, 0.1).unwrap();
        let second = Capsule::new(b, b + w, 0.2).unwrap();
        let near = proximity(&first, &second);
        let axes = near.distance + 0.3;
        prop_assert!(first.nearest_on_segment(&near.on_first) == near.on_first
            || (first.nearest_on_segment(&near.on_first) - near.on_first).norm() < 1e-12);
        prop_assert!(((near.on_first - near.on_second).norm() - axes).abs() < 1e-12);
        prop_assert!((near.normal.norm() - 1.0).abs() < 1e-12);
        for i in 0..=20 {
            let point = a + u * (f64::from(i) / 20.0);
            let least = (second.nearest_on_segment(&point) - point).norm();
            prop_assert!(axes <= least + 1e-9, "{axes} {least}");
        }
    }

    #[test]
    fn gradients_are_the_derivative_of_the_distance(
        a in capsule(1.0), b in capsule(1.0), twist in twist(), origin in vector(1.0),
    ) {
        let near = proximity(&a, &b);
        prop_assume!((near.on_first - near.on_second).norm() > 1e-2);
        let step = 1e-6;
        let first = |time| proximity(&carried(&a, &twist, &origin, time), &b).distance;
        let second = |time| proximity(&a, &carried(&b, &twist, &origin, time)).distance;
        let rate = near.gradient_first(&origin).dot(&twist);
        prop_assert!((rate - (first(step) - first(-step)) / (2.0 * step)).abs() < 1e-4);
        let rate = near.gradient_second(&origin).dot(&twist);
        prop_assert!((rate - (second(step) - second(-step)) / (2.0 * step)).abs() < 1e-4);
    }

    #[test]
    fn the_approach_limit_inverts_the_protective_distance(
        settings in settings(), human in 0.0..2.0_f64, distance in -0.5..4.0_f64,
    ) {
        let limit = settings.approach_limit(distance, human);
        let standing = settings.protective_distance(human, 0.0);
        prop_assert!(limit >= 0.0);
        prop_assert_eq!(limit > 0.0, distance > standing);
        if limit > 0.0 {
            prop_assert!((settings.protective_distance(human, limit) - distance).abs() < 1e-9);
        }
        prop_assert!(settings.approach_limit(distance + 0.1, human) >= limit);
        prop_assert!(settings.approach_limit(distance, human + 0.1) <= limit);
    }

    /// The person keeps approaching. The robot keeps its speed for the reaction time and then
    /// brakes. When it stands, the margin remains.
    #[test]
    fn the_protective_distance_is_what_the_motion_takes(
        settings in settings(), human in 0.0..2.0_f64, robot in 0.0..2.0_f64,
    ) {
        let required = settings.protective_distance(human, robot);
        let (mut gap, mut speed, mut time, step) = (required, robot, 0.0, 1e-4);
        while speed > 0.0 || time < settings.reaction_time {
            let next = if time < settings.reaction_time {
                speed
            } else {
                (speed - settings.deceleration * step).max(0.0)
            };
            gap -= (human + 0.5 * (speed + next)) * step;
            speed = next;
            time += step;
        }
        let margin = settings.intrusion + settings.human_uncertainty + settings.robot_uncertainty;
        prop_assert!((gap - margin).abs() < 1e-3, "{gap} {margin}");
    }

    /// Each row is the rate of approach of the nearest point of the robot's capsule or of one of
    /// its ends. It is compared with finite differences of the distance. If a part may be touched,
    /// is too near and surely moves, the distance to its current place counts.
    #[test]
    fn rows_are_the_rate_of_approach(
        jacobian in jacobian(), q in joints(), origin in vector(0.5),
        robot in robot(), person in person(), settings in settings(),
        inverse in prop::option::of(inverse_inertia()),
    ) {
        let rest = [0.0; JOINTS];
        let inverse_inertia = inverse.as_ref();
        let motion = JointMotion { inverse_inertia, ..motion(&jacobian, origin, &q, &rest) };
        let room = 3 * robot.len() * person.len() + 2;
        let mut separation = ApproachRows::new(state(), settings, room).unwrap();
        let mut rows = separation.rows();
        let nearest = separation.write(&motion, &robot, &person, &mut rows).unwrap();
        let moved_by = |body: &RobotBody, q: &[f64], time: f64| {
            let twist = (0..body.joints).map(|j| {
                Vector6::from_iterator(jacobian.column(j).iter().copied()) * q[j]
            });
            carried(&body.capsule, &twist.sum::<Vector6<f64>>(), &origin, time)
        };
        let step = 1e-6;
        let mut expected = Vec::new();
        let mut degenerate = false;
        for (body, part) in robot.iter().flat_map(|body| person.iter().map(move |part| (body, part))) {
            let nearest = proximity(&body.capsule, &part.capsule).on_first;
            let ends = [*body.capsule.start(), *body.capsule.end()];
            let both = ends.into_iter().filter(|end| (end - nearest).norm() > 1e-6);
            let both = both.take(if ends[0] == ends[1] { 1 } else { 2 });
            let points = std::iter::once((nearest, true)).chain(both.map(|end| (end, false)));
            for (point, is_nearest) in points {
                let ball = Capsule::sphere(point, body.capsule.radius()).unwrap();
                let seen = proximity(&ball, &part.capsule);
                degenerate |= (seen.on_first - seen.on_second).norm() < 1e-2;
                let by_now = part.contact.and(part.velocity).filter(|velocity| {
                    let human = velocity.mean.dot(&seen.normal) + velocity.uncertainty;
                    let moves = velocity.mean.norm() > velocity.uncertainty;
                    moves && seen.distance < settings.protective_distance(human, 0.0)
                });
                let moved = by_now.map_or(Vector3::zeros(), |velocity| velocity.mean * part.age);
                let other = carried(&part.capsule, &Vector6::new(moved.x, moved.y, moved.z, 0.0, 0.0, 0.0), &origin, 1.0);
                let again = proximity(&body.capsule, &other).on_first;
                let point = if is_nearest { again } else { point };
                let ball = Capsule::sphere(point, body.capsule.radius()).unwrap();
                let body = RobotBody { capsule: ball, ..*body };
                let rate = |q: &[f64]| {
                    let at = |time| proximity(&moved_by(&body, q, time), &other).distance;
                    (at(-step) - at(step)) / (2.0 * step)
                };
                let near = proximity(&ball, &other);
                degenerate |= (near.on_first - near.on_second).norm() < 1e-2;
                let measured = part.velocity.map(|v| v.mean.dot(&near.normal));
                let worst = part.velocity.zip(measured).map(|(v, speed)| speed + v.uncertainty);
                let human = worst.map_or(part.assumed_speed, |speed| speed.max(0.0));
                let distance = near.distance.min(seen.distance);
                let mut limit = settings.approach_limit(distance, human);
                if let Some(Contact { limit: contact, fastest, velocity }) = part.contact {
                    prop_assert!(velocity.is_none());
                    // Computes joint by joint how the robot gives way to a push along the normal.
                    let unit = |j: usize| std::array::from_fn::<_, JOINTS, _>(|i| f64::from(u8::from(i == j)));
                    let row = DVector::from_fn(JOINTS, |j, _| rate(&unit(j)));
                    let lightness = inverse.as_ref().map_or(0.0, |m| row.dot(&(m * &row)));
                    let reduced = 1.0 / (1.0 / contact.mass + lightness);
                    let allowed = contact.force / (contact.stiffness * reduced).sqrt();
                    let (measured, worst) = (measured.unwrap_or(human), worst.unwrap_or(human));
                    // A part that recedes counts by the speed at which it surely recedes.
                    let comes = if measured > 0.0 { measured } else { worst.min(0.0) };
                    limit = limit.max((allowed - worst).min(fastest - comes));
                }
                expected.push((limit, rate(&q)));
            }
        }
        prop_assume!(!degenerate);
        let mut found: Vec<(f64, f64)> =
            rows.iter().take(expected.len()).map(|(row, _, upper)| (upper, along(row, &q))).collect();
        let order = |a: &(f64, f64), b: &(f64, f64)| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1));
        expected.sort_by(order);
        found.sort_by(order);
        for (expected, found) in expected.iter().zip(&found) {
            prop_assert!((expected.0 - found.0).abs() < 1e-5);
        }
        let sum = |rates: &[(f64, f64)]| rates.iter().map(|rate| rate.1).sum::<f64>();
        prop_assert!((sum(&expected) - sum(&found)).abs() < 1e-3);
        for (row, lower, upper) in rows.iter().skip(expected.len()) {
            prop_assert!(row.iter().all(|&a| a == 0.0));
            prop_assert!(lower == f64::NEG_INFINITY && upper == f64::INFINITY);
        }
        // Parts that may be touched are never reported as nearest.
        prop_assert_eq!(nearest.is_none(), person.iter().all(|part| part.contact.is_some()));
        if let Some(nearest) = nearest {
            let part = &person[nearest.other];
            let near = proximity(&robot[nearest.robot].capsule, &part.capsule);
            prop_assert_eq!(nearest.distance, near.distance);
            prop_assert!(part.contact.is_none());
        }
    }

    #[test]
    fn own_bodies_move_against_each_other(
        jacobian in jacobian(), q in joints(), origin in vector(0.5), robot in robot(),
    ) {
        prop_assume!(robot.len() >= 2);
        let rest = [0.0; JOINTS];
        let motion = motion(&jacobian, origin, &q, &rest);
        let settings = SeparationSettings::between_own_bodies(1e-3, 1.0, 0.02);
        let mut own = ApproachRows::new(state(), settings, 1).unwrap();
        let mut rows = own.rows();
        let near = proximity(&robot[0].capsule, &robot[1].capsule);
        prop_assume!((near.on_first - near.on_second).norm() > 1e-2);
        let nearest = own.measure_own(&motion, &robot, &[(0, 1)]).unwrap().unwrap();
        own.write_rows(&motion, &mut rows).unwrap();
        let moved = |body: &RobotBody, time: f64| {
            let twist = (0..body.joints).map(|j| {
                Vector6::from_iterator(jacobian.column(j).iter().copied()) * q[j]
            });
            carried(&body.capsule, &twist.sum::<Vector6<f64>>(), &origin, time)
        };
        let step = 1e-6;
        let at = |time| proximity(&moved(&robot[0], time), &moved(&robot[1], time)).distance;
        let approach = (at(-step) - at(step)) / (2.0 * step);
        prop_assert!((nearest.approach - approach).abs() < 1e-4);
        prop_assert!((along(rows.row(0).unwrap(), &q) - approach).abs() < 1e-4);
        prop_assert!(rows.upper()[0] >= 0.0);
    }

    #[test]
    fn rest_retreat_and_braking_are_always_admitted(
        jacobian in jacobian(), braking in joints(), q in joints(), robot in robot(),
        person in person(), settings in settings(), capacity in 0..6_usize,
    ) {
        let origin = Vector3::zeros();
        let motion = motion(&jacobian, origin, &q, &braking);
        let mut separation = ApproachRows::new(state(), settings, capacity).unwrap();
        let mut rows = separation.rows();
        separation.write(&motion, &robot, &person, &mut rows).unwrap();
        for (row, lower, upper) in rows.iter() {
            prop_assert!(lower == f64::NEG_INFINITY && upper >= 0.0);
            prop_assert!(along(row, &braking) <= upper);
            if along(row, &q) <= 0.0 {
                prop_assert!(along(row, &q) <= upper);
            }
        }
        let cap = 0.25;
        let mut rows = SpeedCap::rows(state());
        SpeedCap::write(&motion, &Vector3::zeros(), cap, &mut rows).unwrap();
        for (row, lower, upper) in rows.iter() {
            // Rest and braking lie in the interior of what is admitted.
            let within = lower + 0.9e-6..=upper - 0.9e-6;
            prop_assert!(within.contains(&0.0) && within.contains(&along(row, &braking)));
        }
    }

    #[test]
    fn the_pairs_that_may_approach_least_are_kept(
        jacobian in jacobian(), robot in robot(), person in person(), capacity in 1..5_usize,
    ) {
        let rest = [0.0; JOINTS];
        let origin = Vector3::zeros();
        let motion = motion(&jacobian, origin, &rest, &rest);
        let settings = SeparationSettings::default();
        let bounds = |capacity: usize| {
            let mut separation = ApproachRows::new(state(), settings, capacity).unwrap();
            let mut rows = separation.rows();
            let nearest = separation.write(&motion, &robot, &person, &mut rows).unwrap();
            let mut upper = rows.upper().to_vec();
            upper.sort_by(f64::total_cmp);
            (upper, nearest)
        };
        let (few, nearest) = bounds(capacity);
        let (all, expected) = bounds(3 * robot.len() * person.len());
        for (few, all) in few.iter().zip(&all) {
            prop_assert_eq!(few, all);
        }
        let room = |pair: Option<Nearest>| pair.map_or(f64::INFINITY, |pair| pair.room());
        prop_assert!(room(nearest) >= room(expected));
        if room(expected) < 0.0 {
            prop_assert_eq!(nearest, expected);
        }
    }

    #[test]
    fn a_capped_tool_keeps_the_speed(
        jacobian in jacobian(), q in joints(), cap in 0.01..1.0_f64,
    ) {
        let rest = [0.0; JOINTS];
        let origin = Vector3::zeros();
        let motion = motion(&jacobian, origin, &rest, &rest);
        let mut rows = SpeedCap::rows(state());
        SpeedCap::write(&motion, &Vector3::zeros(), cap, &mut rows).unwrap();
        let linear: Matrix3x6<f64> = Matrix3x6::from_fn(|i, j| if i == j { 1.0 } else { 0.0 });
        let speed = (linear * &jacobian * nalgebra::Vector4::from(q)).norm();
        // Fastest motion along q that the rows admit.
        let most = rows
            .iter()
            .map(|(row, _, upper)| upper / along(row, &q).abs())
            .fold(f64::INFINITY, f64::min);
        prop_assert!(most * speed <= cap * (1.0 + 1e-12));
        prop_assert!(most * speed >= 0.8 * cap);
        SpeedCap::write(&motion, &Vector3::zeros(), f64::INFINITY, &mut rows).unwrap();
        prop_assert!(rows.upper().iter().all(|&upper| upper == f64::INFINITY));
    }
}

/// Compares with the defaults by hand: v_h = 1.6 m/s, T_r = 0.15 s, a = 2 m/s², margins of 0.16 m.
#[test]
fn the_terms_of_the_protective_distance_by_hand() {
    let settings = SeparationSettings::default();
    // 1.6 · (0.15 + 0.5) + 1 · 0.15 + 1/4 + 0.16
    assert!((settings.protective_distance(1.6, 1.0) - 1.6).abs() < 1e-12);
    assert!((settings.protective_distance(0.0, 0.0) - 0.16).abs() < 1e-12);
    assert!((settings.approach_limit(1.6, 1.6) - 1.0).abs() < 1e-12);
    assert_eq!(settings.approach_limit(0.3, 1.6), 0.0);
}
