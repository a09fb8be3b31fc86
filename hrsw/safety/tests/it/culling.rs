//! Only pairs that need no row get none, tick after tick.

use ahqp_core::{AugmentedState, Rows};
use hrsw_safety::{
    ApproachRows, Capsule, Contact, ContactLimit, JointMotion, MeasuredVelocity, Nearest,
    PersonBody, RobotBody, SeparationSettings, proximity,
};
use nalgebra::{DMatrix, Matrix6xX, Vector3, Vector6};
use proptest::prelude::*;

const JOINTS: usize = 4;

fn vector(size: f64) -> impl Strategy<Value = Vector3<f64>> {
    prop::array::uniform3(-size..size).prop_map(Vector3::from)
}

fn capsules(count: usize, size: f64) -> impl Strategy<Value = Vec<Capsule>> {
    let capsule = (vector(size), vector(0.3), 0.02..0.15_f64)
        .prop_map(|(start, along, radius)| Capsule::new(start, start + along, radius).unwrap());
    prop::collection::vec(capsule, count)
}

fn moved(capsule: &Capsule, by: &Vector3<f64>) -> Capsule {
    Capsule::new(capsule.start() + by, capsule.end() + by, capsule.radius()).unwrap()
}

/// Returns the rows that bound something, each with the speed that it allows.
fn bounding(rows: &Rows) -> Vec<(Vec<f64>, f64)> {
    let bounding = rows.iter().filter(|(_, _, upper)| *upper < f64::INFINITY);
    bounding.map(|(row, _, upper)| (row[..JOINTS].to_vec(), upper)).collect()
}

fn along(row: &[f64], velocity: &[f64]) -> f64 {
    row.iter().zip(velocity).map(|(a, b)| a * b).sum()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// A person moves and the robot's velocity changes over many ticks. The rows that are kept
    /// bound every next velocity as all rows together do.
    #[test]
    fn rows_left_out_could_not_be_reached(
        robot in capsules(5, 1.5), person in capsules(4, 1.5),
        jacobian in prop::collection::vec(-1.0..1.0_f64, 6 * JOINTS),
        steps in prop::collection::vec(
            (vector(0.01), vector(0.005), prop::array::uniform4(-0.6..0.6_f64)), 1..30),
        change in prop::array::uniform4(0.0..0.1_f64),
        walking in vector(0.5), uncertainty in 0.0..0.3_f64, watched in 0.0..0.5_f64,
    ) {
        let state = AugmentedState { joints: JOINTS, task: 6, slack: 6 };
        let settings = SeparationSettings::default();
        let jacobian = Matrix6xX::from_vec(jacobian);
        let rows = || ApproachRows::new(state, settings, 60).unwrap();
        let mut culled = rows().watching(watched);
        let mut block = culled.rows();
        let (mut robot, mut person) = (robot, person);
        for (robot_step, person_step, velocity) in steps {
            for capsule in &mut robot {
                *capsule = moved(capsule, &robot_step);
            }
            for capsule in &mut person {
                *capsule = moved(capsule, &person_step);
            }
            let bodies: Vec<_> =
                robot.iter().map(|&capsule| RobotBody { capsule, joints: JOINTS }).collect();
            let velocity_of_person = Some(MeasuredVelocity { mean: walking, uncertainty });
            let parts: Vec<_> = person
                .iter()
                .map(|&capsule| PersonBody { assumed_speed: 1.6, capsule, velocity: velocity_of_person, age: 0.0, uncertainty: 0.0, contact: None })
                .collect();
            let all = JointMotion {
                jacobian: &jacobian,
                origin: Vector3::zeros(),
                velocity: &velocity,
                braking: None,
                change: None,
                inverse_inertia: None,
            };
            let motion = JointMotion { change: Some(&change), ..all };
            let nearest = culled.write(&motion, &bodies, &parts, &mut block).unwrap();
            let kept = bounding(&block);

            let mut whole = rows();
            let mut every = whole.rows();
            let truly: Option<Nearest> = whole.write(&all, &bodies, &parts, &mut every).unwrap();
            for (row, upper) in bounding(&every) {
                let fastest = along(&row, &velocity)
                    + row.iter().zip(&change).map(|(a, b)| a.abs() * b).sum::<f64>();
                if fastest > upper + 1e-9 {
                    prop_assert!(kept.contains(&(row, upper)));
                }
            }
            let pairs = robot.iter().flat_map(|a| person.iter().map(move |b| proximity(a, b).distance));
            let least = pairs.fold(f64::INFINITY, f64::min);
            prop_assert!((culled.least_distance() - least).abs() < 1e-9);
            if truly.is_some_and(|pair| pair.room() < watched) {
                prop_assert_eq!(nearest, truly);
            }
        }
    }

    /// Some parts may be touched. Two things are left out: contacts that allow every reachable
    /// speed, and the robot's mass where it is not needed. The next velocity is bounded as without
    /// leaving them out.
    #[test]
    fn contacts_left_out_could_not_be_reached(
        robot in capsules(4, 0.8), person in capsules(4, 0.8),
        jacobian in prop::collection::vec(-1.0..1.0_f64, 6 * JOINTS),
        steps in prop::collection::vec(
            (vector(0.01), vector(0.005), prop::array::uniform4(-0.6..0.6_f64)), 1..20),
        change in prop::array::uniform4(0.0..0.1_f64), walking in vector(0.3), uncertainty in 0.0..0.3_f64,
        contacts in prop::collection::vec(prop::option::of((20.0..300.0_f64, 0.0..1.0_f64, any::<bool>())), 4),
        lightness in 0.01..1.0_f64, watched in 0.0..0.5_f64,
    ) {
        let state = AugmentedState { joints: JOINTS, task: 6, slack: 6 };
        let jacobian = Matrix6xX::from_vec(jacobian);
        let inverse = DMatrix::identity(JOINTS, JOINTS) * lightness;
        let rows = || ApproachRows::new(state, SeparationSettings::default(), 60).unwrap();
        let (mut culled, mut unweighed) = (rows().watching(watched), rows().watching(watched));
        let (mut block, mut without) = (culled.rows(), unweighed.rows());
        let (mut robot, mut person) = (robot, person);
        let measured = MeasuredVelocity { mean: walking, uncertainty };
        for (robot_step, person_step, velocity) in steps {
            for capsule in &mut robot {
                *capsule = moved(capsule, &robot_step);
            }
            for capsule in &mut person {
                *capsule = moved(capsule, &person_step);
            }
            let bodies: Vec<_> =
                robot.iter().map(|&capsule| RobotBody { capsule, joints: JOINTS }).collect();
            let part = |(&capsule, contact): (&Capsule, &Option<(f64, f64, bool)>)| PersonBody { assumed_speed: 1.6,
                capsule,
                velocity: contact.is_none_or(|(_, _, of_arm)| !of_arm).then_some(measured),
                age: 0.0,
                uncertainty: 0.0,
                contact: contact.map(|(force, fastest, _)| Contact {
                    limit: ContactLimit { force, stiffness: 3e4, mass: 3.0 },
                    fastest,
                    velocity: Some(measured),
                }),
            };
            let parts: Vec<_> = person.iter().zip(&contacts).map(part).collect();
            let all = JointMotion {
                jacobian: &jacobian,
                origin: Vector3::zeros(),
                velocity: &velocity,
                braking: None,
                change: None,
                inverse_inertia: Some(&inverse),
            };
            let motion = JointMotion { change: Some(&change), ..all };
            let nearest = culled.write(&motion, &bodies, &parts, &mut block).unwrap();
            let kept = bounding(&block);
            let mut whole = rows();
            let mut every = whole.rows();
            let truly = whole.write(&all, &bodies, &parts, &mut every).unwrap();
            for (row, upper) in bounding(&every) {
                let fastest = along(&row, &velocity)
                    + row.iter().zip(&change).map(|(a, b)| a.abs() * b).sum::<f64>();
                if fastest > upper + 1e-9 {
                    prop_assert!(kept.contains(&(row, upper)));
                }
            }
            if truly.is_some_and(|pair| pair.room() < watched) {
                prop_assert_eq!(nearest, truly);
            }
            let motion = JointMotion { inverse_inertia: None, ..motion };
            prop_assert_eq!(unweighed.write(&motion, &bodies, &parts, &mut without).unwrap(), nearest);
            prop_assert_eq!(unweighed.needs_inertia(), culled.needs_inertia());
            if !culled.needs_inertia() {
                // The row of a point depends on the ticks before.
                let without = bounding(&without);
                prop_assert_eq!(without.len(), kept.len());
                prop_assert!(without.iter().all(|row| kept.contains(row)));
            }
        }
    }

    /// Some joints move several of the robot's own bodies together.
    #[test]
    fn own_pairs_left_out_could_not_be_reached(
        robot in capsules(5, 0.6), joints in prop::collection::vec(0..=JOINTS, 5),
        jacobian in prop::collection::vec(-1.0..1.0_f64, 6 * JOINTS),
        steps in prop::collection::vec((vector(0.01), prop::array::uniform4(-0.6..0.6_f64)), 1..30),
        change in prop::array::uniform4(0.0..0.1_f64), origin in vector(0.5),
    ) {
        let state = AugmentedState { joints: JOINTS, task: 6, slack: 6 };
        let settings = SeparationSettings::between_own_bodies(1e-3, 2.0, 0.03);
        let jacobian = Matrix6xX::from_vec(jacobian);
        let rows = || ApproachRows::new(state, settings, 20).unwrap();
        let mut culled = rows();
        let mut block = culled.rows();
        let pairs: Vec<_> = (0..5).flat_map(|i| (0..i).map(move |j| (i, j))).collect();
        let mut robot = robot;
        for (step, velocity) in steps {
            for (index, capsule) in robot.iter_mut().enumerate() {
                *capsule = moved(capsule, &(step * f64::from(u8::try_from(index).unwrap())));
            }
            let body = |(&capsule, &joints)| RobotBody { capsule, joints };
            let bodies: Vec<_> = robot.iter().zip(&joints).map(body).collect();
            let all = JointMotion {
                jacobian: &jacobian,
                origin,
                velocity: &velocity,
                braking: None,
                change: None,
                inverse_inertia: None,
            };
            let motion = JointMotion { change: Some(&change), ..all };
            culled.measure_own(&motion, &bodies, &pairs).unwrap();
            culled.write_rows(&motion, &mut block).unwrap();
            let kept = bounding(&block);
            let mut whole = rows();
            let mut every = whole.rows();
            whole.measure_own(&all, &bodies, &pairs).unwrap();
            whole.write_rows(&all, &mut every).unwrap();
            for (row, upper) in bounding(&every) {
                let fastest = along(&row, &velocity)
                    + row.iter().zip(&change).map(|(a, b)| a.abs() * b).sum::<f64>();
                if fastest > upper + 1e-9 {
                    prop_assert!(kept.contains(&(row, upper)));
                }
            }
        }
    }

    /// The base brakes more slowly than the arm. Stopping takes no less distance and time than for
    /// each part alone.
    #[test]
    fn stopping_takes_no_less_than_each_part(
        base in 0.0..1.5_f64, arm in 0.0..1.5_f64, human in 0.0..1.6_f64,
        of_base in 0.2..1.0_f64, of_arm in 1.0..5.0_f64,
    ) {
        let braking = hrsw_safety::BaseBraking { joints: 2, deceleration: of_base };
        let settings = SeparationSettings {
            deceleration: of_arm, base: Some(braking), ..SeparationSettings::default()
        };
        let SeparationSettings { reaction_time, intrusion, human_uncertainty, robot_uncertainty, .. } =
            settings;
        let speed = base + arm;
        let time = (base / of_base).max(arm / of_arm);
        let way = 0.5 * (base * base / of_base + arm * arm / of_arm);
        let least = human * (reaction_time + time) + speed * reaction_time + way
            + intrusion + human_uncertainty + robot_uncertainty;
        let required = settings.braking_by_parts(base, arm).protective_distance(human, speed);
        prop_assert!(required >= least - 1e-12);
    }
}

/// A body turns about a distant axis. Its points move, and the axis does not.
#[test]
fn a_turning_joint_keeps_what_it_can_reach() {
    let state = AugmentedState { joints: 1, task: 6, slack: 6 };
    let mut separation = ApproachRows::new(state, SeparationSettings::default(), 2).unwrap();
    let mut rows = separation.rows();
    let jacobian = Matrix6xX::from_columns(&[Vector6::new(0.0, 0.0, 0.0, 0.0, 0.0, 1.0)]);
    let capsule = Capsule::sphere(Vector3::new(2.0, 0.0, 0.0), 0.1).unwrap();
    let head = Capsule::sphere(Vector3::new(2.0, 0.5, 0.0), 0.1).unwrap();
    let velocity = Some(MeasuredVelocity::exact(Vector3::zeros()));
    let person = [PersonBody {
        assumed_speed: 1.6,
        capsule: head,
        velocity,
        age: 0.0,
        uncertainty: 0.0,
        contact: None,
    }];
    let motion = JointMotion {
        jacobian: &jacobian,
        origin: Vector3::zeros(),
        velocity: &[0.0],
        braking: None,
        // At two metres this is 0.6 m/s within a tick, more than is allowed.
        change: Some(&[0.3]),
        inverse_inertia: None,
    };
    let bodies = [RobotBody { capsule, joints: 1 }];
    separation.write(&motion, &bodies, &person, &mut rows).unwrap();
    let limit = SeparationSettings::default().approach_limit(0.3, 0.0);
    assert!(limit < 0.6);
    assert!((rows.upper()[0] - limit).abs() < 1e-12);
    assert!((rows.iter().next().unwrap().0[0] - 2.0).abs() < 1e-12);
}
