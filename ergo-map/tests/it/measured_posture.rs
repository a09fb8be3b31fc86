//! Comparison of postures from joints with the skeleton's forward kinematics.

use ergo_map::{
    Conditions, JointAngles, JointPositions, NeutralPosture, Person, Posture, PostureFilter, Side,
    Skeleton, Worksheet,
};
use nalgebra::{Matrix3, Rotation3, Vector3};
use proptest::prelude::*;

/// Returns the joints of a skeleton, turned about the vertical. The trunk is rigid and the hips are
/// level.
fn joints(angles: &JointAngles, side: Side, turn: f64) -> JointPositions {
    let landmarks = Skeleton::new(&Person::average(), side).landmarks(angles).unwrap();
    let place = |point: Vector3<f64>| {
        Some(
            Rotation3::from_axis_angle(&Vector3::z_axis(), turn) * point
                + Vector3::new(1.0, 2.0, 0.0),
        )
    };
    let of_side = |working: Vector3<f64>, other: Option<Vector3<f64>>| match side {
        Side::Left => [place(working), other.and_then(place)],
        Side::Right => [other.and_then(place), place(working)],
    };
    let beside =
        |point: Vector3<f64>| [0.1, -0.1].map(|aside| place(point + Vector3::new(0.0, aside, 0.0)));
    let neck = (landmarks.shoulder + landmarks.other_shoulder) * 0.5;
    JointPositions {
        neck: place(neck),
        pelvis: place(landmarks.hip),
        shoulders: of_side(landmarks.shoulder, Some(landmarks.other_shoulder)),
        elbows: of_side(landmarks.elbow, None),
        wrists: of_side(landmarks.wrist, None),
        hips: beside(landmarks.hip),
        knees: beside(landmarks.knee),
        ankles: beside(landmarks.ankle),
        ..JointPositions::default()
    }
}

proptest! {
    #[test]
    fn angles_are_those_of_the_skeleton(
        hip in 0.0..1.2_f64, knee in 0.0..1.0_f64, flexion in -0.8..2.4_f64, abduction in -0.4..1.2_f64,
        rotation in -1.0..1.0_f64, elbow in 0.5..2.4_f64, turn in -3.0..3.0_f64, left: bool,
    ) {
        let side = if left { Side::Left } else { Side::Right };
        let angles = JointAngles {
            hip,
            knee,
            shoulder_flexion: flexion,
            shoulder_abduction: abduction,
            shoulder_rotation: rotation,
            elbow,
            ..JointAngles::default()
        };
        let expected = angles.posture();
        // The model's own neutral posture has a straight trunk and no dead band.
        let neutral = NeutralPosture { trunk: 0.0, trunk_band: 0.0, ..NeutralPosture::default() };
        let measured = joints(&angles, side, turn).posture_from(side, &neutral).unwrap();
        for (name, found, expected) in [
            ("trunk", measured.posture.trunk_flexion, expected.trunk_flexion),
            ("knee", measured.posture.knee_flexion, expected.knee_flexion),
            ("flexion", measured.posture.upper_arm_flexion, expected.upper_arm_flexion),
            ("abduction", measured.posture.upper_arm_abduction, expected.upper_arm_abduction),
            ("rotation", measured.posture.upper_arm_rotation, expected.upper_arm_rotation),
            ("elbow", measured.posture.elbow_flexion, expected.elbow_flexion),
            ("side", measured.posture.trunk_side, 0.0),
            ("twist", measured.posture.trunk_twist, 0.0),
        ] {
            prop_assert!((found - expected).abs() < 1e-6, "{name}: {found} for {expected}");
        }
    }

    /// Angles are finite for all positions.
    #[test]
    fn never_nan(values in prop::collection::vec(prop_oneof![-2.0..2.0_f64, Just(f64::NAN), Just(0.0), Just(f64::MAX)], 63)) {
        let point = |index: usize| {
            let values = &values[3 * index..];
            Some(Vector3::new(values[0], values[1], values[2]))
        };
        let pair = |index: usize| [point(index), point(index + 1)];
        let joints = JointPositions {
            neck: point(0),
            pelvis: point(1),
            nose: point(2),
            ears: pair(3),
            shoulders: pair(5),
            elbows: pair(7),
            wrists: pair(9),
            hips: pair(11),
            knees: pair(13),
            ankles: pair(15),
        };
        let covariance = Matrix3::from_diagonal_element(values[0]);
        for side in [Side::Left, Side::Right] {
            let mut filter = PostureFilter::new(side);
            for time in [0.0, values[1], 1.0, values[2], 2.0] {
                let filtered = filter.update(time, &joints, &[covariance; JointPositions::LEN]);
                for measured in joints.posture(side).into_iter().chain(filtered) {
                    prop_assert!(measured.posture.validate().is_ok());
                }
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(16))]

    /// A posture that lasts is found, however far it is from the habitual one.
    #[test]
    fn a_lasting_posture_is_found(
        hip in 0.0..1.2_f64, flexion in -0.6..2.0_f64, abduction in -0.3..1.0_f64, elbow in 0.6..2.2_f64,
    ) {
        let angles = JointAngles {
            hip, shoulder_flexion: flexion, shoulder_abduction: abduction, elbow, ..JointAngles::default()
        };
        let seen = joints(&angles, Side::Left, 0.3);
        let covariances = [Matrix3::identity() * 0.01_f64.powi(2); JointPositions::LEN];
        let mut filter = PostureFilter::new(Side::Left);
        let mut found = None;
        for frame in 0..60 {
            found = filter.update(0.05 * f64::from(frame), &seen, &covariances);
        }
        let (found, expected) = (found.unwrap().posture, angles.posture());
        for (name, found, expected) in [
            ("trunk", found.trunk_flexion, expected.trunk_flexion),
            ("flexion", found.upper_arm_flexion, expected.upper_arm_flexion),
            ("abduction", found.upper_arm_abduction, expected.upper_arm_abduction),
            ("elbow", found.elbow_flexion, expected.elbow_flexion),
        ] {
            prop_assert!((found - expected).abs() < 0.1, "{name}: {found} for {expected}");
        }
    }
}

#[test]
fn unseen_angles_are_named() {
    let mut seen = joints(&JointAngles::default(), Side::Right, 0.0);
    let names = |joints: &JointPositions| -> Vec<_> {
        joints.posture(Side::Right).unwrap().unseen().collect()
    };
    let never = ["wrist_flexion", "wrist_deviation", "wrist_twist"];
    let of_neck = ["neck_flexion", "neck_side", "neck_twist"];
    // A straight arm does not show its rotation.
    let straight = [&of_neck[..], &["upper_arm_rotation"], &never].concat();
    assert_eq!(names(&seen), straight);
    seen.elbows = [None, None];
    assert!(names(&seen).contains(&"elbow_flexion"));
    seen.knees = [None, None];
    assert!(names(&seen).contains(&"knee_flexion"));
    // The midpoint of the shoulders replaces the neck.
    seen.neck = None;
    assert!(seen.posture(Side::Right).is_some());
    seen.shoulders[0] = None;
    assert!(seen.posture(Side::Right).is_none());
}

/// Joints are off by 3 cm. Single frames of an upright person seem twisted and bent, but the
/// filtered posture is not.
#[test]
fn noise_does_not_bend_an_upright_posture() {
    let upright = joints(&JointAngles::default(), Side::Right, 0.5);
    let covariances = [Matrix3::identity() * 0.03_f64.powi(2); JointPositions::LEN];
    let (mut filter, mut state) = (PostureFilter::new(Side::Right), 1_u64);
    // The sum of four uniform numbers is approximately normal, with deviation 0.58.
    let mut draw = || {
        (0..4).fold(-2.0, |sum, _| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            sum + (state >> 11) as f64 / (1_u64 << 53) as f64
        })
    };
    let ticked = |posture: &Posture| {
        Worksheet::from_posture(posture, Conditions::default()).trunk_twisted_or_bent
    };
    let (mut alone, mut followed) = (0, 0);
    for frame in 0..200 {
        let mut noisy = upright.to_array();
        for joint in noisy.iter_mut().flatten() {
            *joint += Vector3::from_fn(|_, _| 0.03 / 0.58 * draw());
        }
        let noisy = JointPositions::from_array(noisy);
        alone += u32::from(ticked(&noisy.posture(Side::Right).unwrap().posture));
        let found = filter.update(0.05 * f64::from(frame), &noisy, &covariances).unwrap();
        followed += u32::from(ticked(&found.posture));
    }
    assert!(alone > 60 && followed < 10, "{alone} and {followed} of 200");
}

#[test]
fn an_unseen_angle_is_kept_for_a_second() {
    let seen = joints(&JointAngles { elbow: 1.2, ..JointAngles::default() }, Side::Right, 0.0);
    let hidden = JointPositions { wrists: [None, None], ..seen };
    let covariances = [Matrix3::identity() * 1e-4; JointPositions::LEN];
    let mut filter = PostureFilter::new(Side::Right);
    assert!(filter.update(0.0, &JointPositions::default(), &covariances).is_none());
    for frame in 0..20 {
        filter.update(0.05 * f64::from(frame), &seen, &covariances);
    }
    let mut at = |time| {
        let measured = filter.update(time, &hidden, &covariances).unwrap();
        (measured.posture.elbow_flexion, measured.unseen().any(|name| name == "elbow_flexion"))
    };
    let (elbow, unseen) = at(1.5);
    assert!((elbow - 1.2).abs() < 0.2 && !unseen, "{elbow}");
    assert_eq!(at(2.1), (0.0, true));
}
