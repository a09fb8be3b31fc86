//! Postures from joints, against the skeleton's forward kinematics.

use ergo_map::{JointAngles, JointPositions, Person, Side, Skeleton};
use nalgebra::{Rotation3, Vector3};
use proptest::prelude::*;

/// The joints of a skeleton, turned about the vertical; the trunk is rigid and the hips are level.
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
        let measured = joints(&angles, side, turn).posture(side).unwrap();
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

    /// Whatever positions are given, angles are finite.
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
        for side in [Side::Left, Side::Right] {
            if let Some(measured) = joints.posture(side) {
                prop_assert!(measured.posture.validate().is_ok());
            }
        }
    }
}

#[test]
fn what_is_not_seen_is_said() {
    let mut seen = joints(&JointAngles::default(), Side::Right, 0.0);
    let names = |joints: &JointPositions| -> Vec<_> {
        joints.posture(Side::Right).unwrap().unseen().collect()
    };
    let never = ["wrist_flexion", "wrist_deviation", "wrist_twist"];
    let of_neck = ["neck_flexion", "neck_side", "neck_twist"];
    // A straight arm does not tell how it is turned.
    let straight = [&of_neck[..], &["upper_arm_rotation"], &never].concat();
    assert_eq!(names(&seen), straight);
    seen.elbows = [None, None];
    assert!(names(&seen).contains(&"elbow_flexion"));
    seen.knees = [None, None];
    assert!(names(&seen).contains(&"knee_flexion"));
    seen.neck = None;
    assert!(seen.posture(Side::Right).is_none());
}
