//! People inside the protective distance, and the assignment of rows to points.

use ahqp_core::{AugmentedState, VelocityInterval, integrate_pose};
use hrsw_safety::{
    ApproachRows, Capsule, JointMotion, MeasuredVelocity, PersonBody, RobotBody,
    SeparationSettings, proximity,
};
use nalgebra::{Isometry3, Matrix6xX, Vector3, Vector6};
use proptest::prelude::*;

use crate::support::{capsule, vector};

/// Number of joints of a robot that flies. Its velocities are the twist.
const JOINTS: usize = 6;
const STATE: AugmentedState = AugmentedState { joints: JOINTS, task: 6, slack: 6 };

fn moved(capsule: &Capsule, by: &Vector3<f64>) -> Capsule {
    Capsule::new(capsule.start() + by, capsule.end() + by, capsule.radius()).unwrap()
}

/// Returns the capsule after `time` of the twist, which is linear at the world's origin.
fn carried(capsule: &Capsule, twist: &[f64], time: f64) -> Capsule {
    let twist = Vector6::from_column_slice(twist);
    capsule.placed(&integrate_pose(&Isometry3::identity(), &twist, time))
}

fn flying<'a>(jacobian: &'a Matrix6xX<f64>, velocity: &'a [f64]) -> JointMotion<'a> {
    JointMotion {
        jacobian,
        origin: Vector3::zeros(),
        velocity,
        braking: None,
        change: None,
        inverse_inertia: None,
    }
}

/// Returns the speed at which the robot's capsule approaches one that is held still \[m/s\].
fn approach(robot: &Capsule, twist: &[f64], person: &Capsule) -> f64 {
    let step = 1e-6;
    let at = |time| proximity(&carried(robot, twist, time), person).distance;
    (at(-step) - at(step)) / (2.0 * step)
}

proptest! {
    /// Rows bound the nearest point and both ends of a capsule, even if it turns about its nearest
    /// point.
    #[test]
    fn both_ends_of_a_capsule_keep_their_distance(
        robot in capsule(0.8), person in capsule(1.5), twist in prop::array::uniform6(-1.5..1.5_f64),
        turns in any::<bool>(),
    ) {
        let settings = SeparationSettings::default();
        let near = proximity(&robot, &person);
        prop_assume!((near.on_first - near.on_second).norm() > 1e-2);
        let jacobian = Matrix6xX::identity(JOINTS);
        // A turn about the nearest point does not change the distance.
        let mut twist = twist;
        if turns {
            let angular = Vector3::new(twist[3], twist[4], twist[5]);
            let linear = near.on_first.cross(&angular);
            twist[..3].copy_from_slice(linear.as_slice());
        }
        let motion = flying(&jacobian, &twist);
        let body = RobotBody { capsule: robot, joints: JOINTS };
        let velocity = Some(MeasuredVelocity::exact(Vector3::zeros()));
        let part = PersonBody { assumed_speed: 1.6, capsule: person, velocity, age: 0.0, uncertainty: 0.0, contact: None };
        let mut separation = ApproachRows::new(STATE, settings, 3).unwrap();
        let mut rows = separation.rows();
        separation.write(&motion, &[body], &[part], &mut rows).unwrap();
        // The robot is as fast as the rows allow.
        let slowed = rows.iter().map(|(row, _, upper)| {
            let speed: f64 = row.iter().zip(&twist).map(|(a, b)| a * b).sum();
            if speed > upper { upper / speed } else { 1.0 }
        });
        let slowed = slowed.fold(1.0, f64::min);
        let twist = twist.map(|v| v * slowed);
        for point in [near.on_first, *robot.start(), *robot.end()] {
            let ball = Capsule::sphere(point, robot.radius()).unwrap();
            let near = proximity(&ball, &person);
            prop_assume!((near.on_first - near.on_second).norm() > 1e-2);
            let speed = approach(&ball, &twist, &person);
            prop_assert!(speed <= settings.approach_limit(near.distance, 0.0) + 1e-4);
        }
    }

    /// Velocities move towards braking until each pair is as slow as its limit, or as with braking.
    #[test]
    fn braking_share_is_no_larger_than_needed(
        robot in capsule(0.8), people in prop::array::uniform2(capsule(1.5)),
        twist in prop::array::uniform6(-1.5..1.5_f64), braking in prop::array::uniform6(-0.2..0.2_f64),
    ) {
        let jacobian = Matrix6xX::identity(JOINTS);
        let motion = flying(&jacobian, &twist);
        let body = RobotBody { capsule: robot, joints: JOINTS };
        let velocity = Some(MeasuredVelocity::exact(Vector3::zeros()));
        let people = people.map(|capsule| PersonBody {
            assumed_speed: 1.6, capsule, velocity, age: 0.0, uncertainty: 0.0, contact: None,
        });
        let mut separation = ApproachRows::new(STATE, SeparationSettings::default(), 6).unwrap();
        let mut rows = separation.rows();
        separation.write(&motion, &[body], &people, &mut rows).unwrap();
        let share = separation.braking_share(&motion, &rows, &twist, &braking);
        prop_assert!((0.0..=1.0).contains(&share));
        let most_too_fast = |share: f64| {
            let along = |row: &[f64], velocity: [f64; JOINTS]| -> f64 {
                row.iter().zip(&velocity).map(|(a, b)| a * b).sum()
            };
            let drawn = std::array::from_fn(|i| twist[i] + share * (braking[i] - twist[i]));
            rows.iter()
                .map(|(row, _, upper)| along(row, drawn) - upper.max(along(row, braking)))
                .fold(f64::NEG_INFINITY, f64::max)
        };
        prop_assert!(most_too_fast(share) <= 1e-6);
        // A person who is too near demands all of the way.
        let is_too_near = people.iter().any(|part| {
            let distance = proximity(&robot, &part.capsule).distance;
            distance < SeparationSettings::default().protective_distance(0.0, 0.0)
        });
        if share > 1e-3 && !is_too_near {
            prop_assert!(most_too_fast(share - 1e-3) > 0.0);
        }
    }

    /// A robot inside the protective distance approaches no possible position of the person. The
    /// person has moved since they were seen, their speed is uncertain, and so was their position.
    #[test]
    fn the_robot_leaves_wherever_the_person_is(
        robot in capsule(0.5), person in capsule(0.5), away in 0.2..0.5_f64,
        leaving in prop::array::uniform6(-0.3..0.3_f64), speed in 0.05..0.8_f64,
        walking in prop::option::of((vector(0.8), 0.0..0.3_f64)), age in 0.0..0.15_f64,
        beside in vector(1.0), uncertainty in prop_oneof![Just(0.0), 0.0..0.2_f64],
    ) {
        let settings = SeparationSettings::default();
        let near = proximity(&robot, &person);
        prop_assume!((near.on_first - near.on_second).norm() > 1e-3);
        // The person stands this far from the robot, apart from the uncertainty of their place.
        let person = moved(&person, &(near.normal * (near.distance - away - uncertainty)));
        let shape = Capsule::new(*person.start(), *person.end(), person.radius() + uncertainty).unwrap();
        let velocity = walking.map(|(mean, uncertainty)| MeasuredVelocity { mean, uncertainty });
        let part = PersonBody { assumed_speed: 1.6, capsule: shape, velocity, age, uncertainty, contact: None };
        let human = velocity.map_or(part.assumed_speed, |v| v.mean.dot(&near.normal).max(0.0));
        prop_assume!(away < settings.protective_distance(human, 0.0));

        let jacobian = Matrix6xX::identity(JOINTS);
        let mut twist = leaving;
        for (v, n) in twist.iter_mut().zip(near.normal.iter()) {
            *v += speed * n;
        }
        let motion = flying(&jacobian, &twist);
        let body = RobotBody { capsule: robot, joints: JOINTS };
        let mut separation = ApproachRows::new(STATE, settings, 3).unwrap();
        let mut rows = separation.rows();
        separation.write(&motion, &[body], &[part], &mut rows).unwrap();
        prop_assume!(separation.braking_share(&motion, &rows, &twist, &[0.0; JOINTS]) == 0.0);

        let (mean, spread) = match velocity {
            Some(v) => (v.mean * age, v.uncertainty * age),
            None => (Vector3::zeros(), part.assumed_speed * age),
        };
        let beside = beside.cap_magnitude(1.0) * (settings.human_uncertainty + spread + uncertainty);
        let person = moved(&person, &(mean + beside));
        prop_assume!(proximity(&robot, &person).distance > -0.5 * robot.radius());
        prop_assert!(approach(&robot, &twist, &person) <= 1e-5);
    }
}

proptest! {
    /// Some joints may not brake as in the least stop. The robot recedes with others, and then approaches no possible
    /// position of the person faster than in that stop.
    #[test]
    fn receding_stops_approach_no_faster(
        robot in capsule(0.5), person in capsule(0.5), away in 0.08..0.16_f64,
        least in prop::array::uniform6(-0.3..0.3_f64), excess in prop::array::uniform6(-0.02..0.02_f64),
        room in prop::array::uniform6(0.0..0.05_f64), spread in 0.0..0.3_f64, beside in vector(1.0),
    ) {
        let settings = SeparationSettings::default();
        let near = proximity(&robot, &person);
        prop_assume!((near.on_first - near.on_second).norm() > 1e-3);
        let person = moved(&person, &(near.normal * (near.distance - away)));
        let age = 0.1;
        let velocity = MeasuredVelocity { mean: Vector3::zeros(), uncertainty: spread };
        let part = PersonBody {
            assumed_speed: 1.6, capsule: person, velocity: Some(velocity), age, uncertainty: 0.0, contact: None,
        };
        let mut stop: [f64; JOINTS] = std::array::from_fn(|i| least[i] + excess[i]);
        let (before, jacobian) = (stop, Matrix6xX::identity(JOINTS));
        let intervals: [_; JOINTS] = std::array::from_fn(|i| VelocityInterval {
            lower: stop[i] - room[i], upper: stop[i] + room[i],
        });
        let motion = flying(&jacobian, &before);
        let mut separation = ApproachRows::new(STATE, settings, 3).unwrap();
        let mut rows = separation.rows();
        separation.write(&motion, &[RobotBody { capsule: robot, joints: JOINTS }], &[part], &mut rows).unwrap();
        separation.recede(&motion, &rows, (&least, &intervals), &mut stop);
        for (interval, velocity) in intervals.iter().zip(stop) {
            prop_assert!((interval.lower - 1e-12..=interval.upper + 1e-12).contains(&velocity));
        }
        let error = settings.human_uncertainty + spread * age;
        let person = moved(&person, &(beside.cap_magnitude(1.0) * error));
        prop_assume!(proximity(&robot, &person).distance > -0.5 * robot.radius());
        let receded = approach(&robot, &stop, &person) <= approach(&robot, &least, &person) + 1e-5;
        prop_assert!(receded || stop == before, "{stop:?} {before:?}");
    }
}

/// A turn may not be braked at all. The translation makes up for what it does at the nearest point, and no more.
#[test]
fn translation_makes_up_for_a_turn() {
    let robot = Capsule::sphere(Vector3::new(0.5, 0.0, 0.0), 0.05).unwrap();
    let person = PersonBody {
        assumed_speed: 1.6,
        capsule: Capsule::sphere(Vector3::new(0.5, 0.25, 0.0), 0.1).unwrap(),
        velocity: Some(MeasuredVelocity::exact(Vector3::zeros())),
        age: 0.0,
        uncertainty: 0.0,
        contact: None,
    };
    let least = [0.0; JOINTS];
    let mut stop = [0.0, 0.0, 0.0, 0.0, 0.0, 0.02];
    let intervals: [_; JOINTS] = std::array::from_fn(|joint| match joint {
        0..3 => VelocityInterval { lower: -0.1, upper: 0.1 },
        _ => VelocityInterval { lower: stop[joint], upper: stop[joint] },
    });
    let (before, jacobian) = (stop, Matrix6xX::identity(JOINTS));
    let motion = flying(&jacobian, &before);
    let mut separation = ApproachRows::new(STATE, SeparationSettings::default(), 3).unwrap();
    let mut rows = separation.rows();
    let body = RobotBody { capsule: robot, joints: JOINTS };
    separation.write(&motion, &[body], &[person], &mut rows).unwrap();
    separation.recede(&motion, &rows, (&least, &intervals), &mut stop);
    assert!(approach(&robot, &before, &person.capsule) > 0.009);
    assert!(approach(&robot, &stop, &person.capsule).abs() < 1e-5, "{stop:?}");
}

/// A person walks to the robot's side. The robot leaves the place where they were seen, and
/// approaches their actual place.
#[test]
fn leaving_an_old_position_is_not_enough() {
    let settings = SeparationSettings::default();
    let robot = RobotBody { capsule: Capsule::sphere(Vector3::zeros(), 0.05).unwrap(), joints: 6 };
    let walking = MeasuredVelocity { mean: Vector3::new(0.0, 1.5, 0.0), uncertainty: 0.0 };
    let jacobian = Matrix6xX::identity(JOINTS);
    let mut separation = ApproachRows::new(STATE, settings, 3).unwrap();
    let mut rows = separation.rows();
    let mut keeps = |away: f64, twist: [f64; JOINTS], age: f64| {
        let capsule = Capsule::sphere(Vector3::new(-0.15 - away, 0.0, 0.0), 0.1).unwrap();
        let person = PersonBody {
            assumed_speed: 1.6,
            capsule,
            velocity: Some(walking),
            age,
            uncertainty: 0.0,
            contact: None,
        };
        let motion = flying(&jacobian, &twist);
        separation.write(&motion, &[robot], &[person], &mut rows).unwrap();
        separation.braking_share(&motion, &rows, &twist, &[0.0; JOINTS]) == 0.0
    };
    let aside = [0.1, 0.15, 0.0, 0.0, 0.0, 0.0];
    assert!(keeps(0.25, aside, 0.1), "farther than the protective distance of 0.16 m");
    assert!(keeps(0.15, aside, 0.0), "away wherever they are within 0.05 m");
    assert!(!keeps(0.15, aside, 0.1), "by now they are 0.15 m farther to the side");
    assert!(keeps(0.15, [0.1, -0.1, 0.0, 0.0, 0.0, 0.0], 0.1));
}

/// A solver starts with the last active rows. They belong to the same points in the next tick.
#[test]
fn a_point_keeps_its_row() {
    let robot = RobotBody { capsule: Capsule::sphere(Vector3::zeros(), 0.1).unwrap(), joints: 6 };
    let jacobian = Matrix6xX::identity(JOINTS);
    let mut separation = ApproachRows::new(STATE, SeparationSettings::default(), 3).unwrap();
    let mut rows = separation.rows();
    let mut directions = |people: &[Vector3<f64>]| {
        let parts: Vec<_> = people
            .iter()
            .map(|at| PersonBody {
                assumed_speed: 1.6,
                capsule: Capsule::sphere(*at, 0.1).unwrap(),
                velocity: Some(MeasuredVelocity::exact(Vector3::zeros())),
                age: 0.0,
                uncertainty: 0.0,
                contact: None,
            })
            .collect();
        separation.write(&flying(&jacobian, &[0.0; JOINTS]), &[robot], &parts, &mut rows).unwrap();
        let directions = rows.iter().map(|(row, ..)| [row[0], row[1]]);
        directions.collect::<Vec<_>>()
    };
    let (x, y) = ([1.0, 0.0], [0.0, 1.0]);
    let both = [Vector3::x() * 0.8, Vector3::y() * 0.9];
    assert_eq!(directions(&both), [x, y, [0.0; 2]], "the nearest first");
    let both = [Vector3::x() * 1.0, Vector3::y() * 0.9];
    assert_eq!(directions(&both), [x, y, [0.0; 2]], "the other is nearer now");
    let three = [both[0], both[1], -Vector3::x() * 0.5];
    assert_eq!(directions(&three), [x, y, [-1.0, 0.0]]);
    assert_eq!(directions(&both[..1]), [x, [0.0; 2], [0.0; 2]]);
}
