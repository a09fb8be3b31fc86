//! Angles at singularities of the coordinates: arms sideways, overhead and round, and a trunk
//! turned about its axis.

use ergo_map::{
    Conditions, JointPositions, Posture, PostureFilter, RebaSubScores, RulaWorksheet, Side,
    Worksheet,
};
use nalgebra::{Matrix3, Rotation3, Unit, Vector3};

use crate::support::Random;

#[expect(clippy::unnecessary_wraps, reason = "joints are seen or not")]
fn at(x: f64, y: f64, z: f64) -> Option<Vector3<f64>> {
    Some(Vector3::new(x, y, z))
}

fn upright() -> JointPositions {
    JointPositions {
        neck: at(0.0, 0.0, 1.5),
        pelvis: at(0.0, 0.0, 1.0),
        shoulders: [at(0.0, 0.2, 1.5), at(0.0, -0.2, 1.5)],
        hips: [at(0.0, 0.1, 1.0), at(0.0, -0.1, 1.0)],
        ..JointPositions::default()
    }
}

fn posture(joints: &JointPositions) -> Posture {
    joints.posture(Side::Right).unwrap().posture
}

fn parts(posture: &Posture) -> RebaSubScores {
    Worksheet::from_posture(posture, Conditions::default()).score().unwrap().sub_scores
}

#[test]
fn an_arm_straight_up_counts_as_raised() {
    for lean in [-0.05, 0.0, 0.0005, 0.05] {
        let leaning = JointPositions {
            neck: at(lean, 0.0, 1.5),
            shoulders: [at(lean, 0.2, 1.5), at(lean, -0.2, 1.5)],
            elbows: [None, at(lean, -0.2, 1.8)],
            wrists: [None, at(lean, -0.2, 2.05)],
            ..upright()
        };
        let posture = posture(&leaning);
        assert_eq!(parts(&posture).upper_arm, 4, "{lean}: {posture:?}");
        assert_eq!(RulaWorksheet::from_posture(&posture).score().unwrap().sub_scores.upper_arm, 4);
        assert!((posture.upper_arm_elevation().to_degrees() - 180.0).abs() < 6.0);
        assert!((posture.upper_arm_flexion.to_degrees() - 180.0).abs() < 6.0, "{posture:?}");
    }
}

#[test]
fn a_sideways_arm_scores_consistently_within_a_centimetre() {
    let mut found = Vec::new();
    for (x, z) in [(0.0, 1.49), (0.0, 1.51), (0.02, 1.49), (-0.02, 1.49), (-0.01, 1.5)] {
        let joints = JointPositions { elbows: [None, at(x, -0.5, z)], ..upright() };
        let posture = posture(&joints);
        assert!((posture.upper_arm_elevation().to_degrees() - 90.0).abs() < 2.0);
        let plane = posture.upper_arm_plane_of_elevation().to_degrees();
        assert!(plane.abs() < 4.0, "to the side: {plane}");
        found.push(parts(&posture).upper_arm);
    }
    // The arm is abducted, and at the threshold of 90 degrees.
    assert!(found.iter().all(|score| [4, 5].contains(score)), "{found:?}");
}

#[test]
fn an_arm_behind_the_trunk_is_extended() {
    for (degrees, score) in
        [(-15.0_f64, 1), (-30.0, 2), (-60.0, 2), (30.0, 2), (60.0, 3), (100.0, 4)]
    {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let elbow = at(0.3 * sin, -0.2, 1.5 - 0.3 * cos);
        let posture = posture(&JointPositions { elbows: [None, elbow], ..upright() });
        assert!((posture.upper_arm_flexion.to_degrees() - degrees).abs() < 1e-9);
        assert_eq!(parts(&posture).upper_arm, score, "{degrees}");
        let plane = posture.upper_arm_plane_of_elevation();
        assert!((plane.abs() - 0.5 * core::f64::consts::PI).abs() < 1e-9 && plane * degrees > 0.0);
    }
}

/// Returns joints with the trunk bent forward and turned about its own axis, together with the
/// head.
fn stooped(flexion: f64, twist: f64) -> JointPositions {
    let bend = Rotation3::from_axis_angle(&Vector3::y_axis(), flexion);
    let turn = bend * Rotation3::from_axis_angle(&Vector3::z_axis(), twist);
    let pelvis = Vector3::new(0.0, 0.0, 1.0);
    let of = |x: f64, y: f64, z: f64| Some(pelvis + turn * Vector3::new(x, y, z));
    JointPositions {
        neck: of(0.0, 0.0, 0.5),
        pelvis: Some(pelvis),
        shoulders: [of(0.0, 0.2, 0.5), of(0.0, -0.2, 0.5)],
        hips: [at(0.0, 0.1, 1.0), at(0.0, -0.1, 1.0)],
        ears: [of(0.07, 0.07, 0.63), of(0.07, -0.07, 0.63)],
        nose: of(0.18, 0.0, 0.62),
        ..JointPositions::default()
    }
}

#[test]
fn a_turned_trunk_is_twisted_when_bent_too() {
    for flexion in [0.0_f64, 30.0, 75.0, 90.0, 100.0] {
        for twist in [-60.0_f64, -45.0, 0.0, 45.0, 60.0] {
            let posture = posture(&stooped(flexion.to_radians(), twist.to_radians()));
            let found = [posture.trunk_flexion, posture.trunk_twist].map(f64::to_degrees);
            assert!((found[1] - twist).abs() < 1e-6, "{flexion} {twist}: {found:?}");
            assert!(posture.neck_twist.abs() < 1e-9 && posture.neck_side.abs() < 1e-9);
            if twist == 0.0 || flexion == 90.0 {
                assert!((found[0] - flexion).abs() < 1e-6, "{flexion} {twist}: {found:?}");
            }
        }
    }
    let score = parts(&posture(&stooped(90_f64.to_radians(), 45_f64.to_radians())));
    assert_eq!((score.trunk, score.neck), (5, 1));
}

fn direction(random: &mut Random) -> Vector3<f64> {
    loop {
        let point = Vector3::from_fn(|_, _| random.uniform(-1.0, 1.0));
        if (0.01..1.0).contains(&point.norm()) {
            return point.normalize();
        }
    }
}

/// Returns joints of a random posture: trunk, head and legs within their ranges, arms anywhere.
fn random_joints(random: &mut Random) -> JointPositions {
    let turn = |axis: Unit<Vector3<f64>>, min: f64, max: f64, random: &mut Random| {
        Rotation3::from_axis_angle(&axis, random.uniform(min, max).to_radians())
    };
    let (x, y, z) = (Vector3::x_axis(), Vector3::y_axis(), Vector3::z_axis());
    let pelvis = Vector3::new(0.0, 0.0, 1.0);
    let trunk =
        turn(y, -30.0, 110.0, random) * turn(x, -35.0, 35.0, random) * turn(z, -60.0, 60.0, random);
    let neck = pelvis + trunk * Vector3::new(0.0, 0.0, 0.5);
    let head = trunk * turn(y, -60.0, 60.0, random) * turn(x, -45.0, 45.0, random);
    let face = head * turn(z, -80.0, 80.0, random);
    let ears = neck + head * Vector3::new(0.07, 0.0, 0.12);
    let mut joints = JointPositions {
        neck: Some(neck),
        pelvis: Some(pelvis),
        nose: Some(ears + face * Vector3::new(0.11, 0.0, 0.0)),
        ears: [1.0, -1.0].map(|side| Some(ears + face * Vector3::new(0.0, 0.075 * side, 0.0))),
        ..JointPositions::default()
    };
    for (index, side) in [1.0, -1.0].into_iter().enumerate() {
        let shoulder = neck + trunk * Vector3::new(0.0, 0.18 * side, 0.0);
        let elbow = shoulder + direction(random) * 0.3;
        let hip = pelvis + Vector3::new(0.0, 0.1 * side, 0.0);
        let thigh = turn(y, -120.0, 30.0, random) * turn(x, -20.0, 20.0, random);
        let knee = hip + thigh * Vector3::new(0.0, 0.0, -0.42);
        let shank = thigh * turn(y, 0.0, 140.0, random);
        joints.shoulders[index] = Some(shoulder);
        joints.elbows[index] = Some(elbow);
        joints.wrists[index] = Some(elbow + direction(random) * 0.26);
        joints.hips[index] = Some(hip);
        joints.knees[index] = Some(knee);
        joints.ankles[index] = Some(knee + shank * Vector3::new(0.0, 0.0, -0.4));
    }
    joints
}

/// Every joint is displaced by a centimetre. No sub-score differs by more than one.
#[test]
fn a_centimetre_changes_sub_scores_by_one_only() {
    let mut random = Random(1);
    let mut changed = [0_u32; 5];
    for number in 0..100_000 {
        let joints = random_joints(&mut random);
        let mut moved = joints.to_array();
        for joint in moved.iter_mut().flatten() {
            *joint += direction(&mut random) * 0.01;
        }
        let moved = JointPositions::from_array(moved);
        let [one, other] = [&joints, &moved].map(|joints| {
            let RebaSubScores { neck, trunk, legs, upper_arm, lower_arm, .. } =
                parts(&posture(joints));
            [neck, trunk, legs, upper_arm, lower_arm]
        });
        for (count, (one, other)) in changed.iter_mut().zip(one.into_iter().zip(other)) {
            assert!(one.abs_diff(other) <= 1, "{number}: {one} {other} of {joints:?} {moved:?}");
            *count += u32::from(one != other);
        }
    }
    // The postures do cross thresholds.
    assert!(changed.iter().all(|count| *count > 500), "{changed:?}");
}

/// Returns an upright person whose right arm has turned by an angle about an axis.
fn swung(axis: &Unit<Vector3<f64>>, angle: f64) -> JointPositions {
    let along = Rotation3::from_axis_angle(axis, angle) * Vector3::new(0.0, 0.0, -1.0);
    let shoulder = Vector3::new(0.0, -0.2, 1.5);
    JointPositions {
        elbows: [None, Some(shoulder + along * 0.3)],
        wrists: [None, Some(shoulder + along * 0.56)],
        ..upright()
    }
}

/// The arm makes a full turn in 2 s: forward over the head, backward, and sideways. No posture is
/// refused, and the arm hangs again at the end.
#[test]
fn a_full_turn_of_the_arm_closes() {
    let covariances = [Matrix3::identity() * 0.02_f64.powi(2); JointPositions::LEN];
    for axis in [-Vector3::y(), Vector3::y(), -Vector3::x(), Vector3::new(-1.0, -1.0, 0.0)] {
        let axis = Unit::new_normalize(axis);
        let mut filter = PostureFilter::new(Side::Right);
        let mut time = 0.0;
        let mut play = |angle: f64| {
            time += 0.05;
            let measured = filter.update(time, &swung(&axis, angle), &covariances).unwrap();
            assert!(measured.posture.validate().is_ok(), "{axis:?} at {angle}: {measured:?}");
            (measured.posture, parts(&measured.posture).upper_arm)
        };
        for _ in 0..20 {
            play(0.0);
        }
        let mut highest = 0.0_f64;
        for step in 0..200 {
            let (posture, _) = play(core::f64::consts::TAU * f64::from(step) / 40.0);
            highest = highest.max(posture.upper_arm_elevation());
        }
        let mut last = play(0.0);
        for _ in 0..20 {
            last = play(0.0);
        }
        let (hanging, score) = last;
        assert!(highest > 2.5, "{axis:?}: the arm was up: {highest}");
        assert!(hanging.upper_arm_elevation() < 0.1 && score == 1, "{axis:?}: {hanging:?}");
        assert!(hanging.upper_arm_flexion.abs() < 0.1, "{axis:?}: {hanging:?}");
    }
}
