//! Person, joints and skeleton.

use ergo_map::{
    Error, JointAngles, JointRanges, Landmarks, Person, PersonFrame, Segments, Side, Skeleton,
};
use nalgebra::{Rotation3, Vector3};
use proptest::prelude::*;

/// Generates joint angles within the ranges of motion.
fn angles() -> impl Strategy<Value = JointAngles> {
    let ranges = JointRanges::default();
    let (min, max) = (ranges.min.to_array(), ranges.max.to_array());
    proptest::array::uniform15(0.0..1.0_f64).prop_map(move |t| {
        JointAngles::from_array(core::array::from_fn(|i| min[i] + t[i] * (max[i] - min[i])))
    })
}

fn points(l: &Landmarks) -> [Vector3<f64>; 11] {
    [
        l.ankle,
        l.knee,
        l.hip,
        l.lumbar,
        l.neck,
        l.eyes,
        l.shoulder,
        l.other_shoulder,
        l.elbow,
        l.wrist,
        l.hand,
    ]
}

#[test]
fn upright_landmarks_match_the_tables() {
    let person = Person::average();
    let upright = Skeleton::new(&person, Side::Right).landmarks(&JointAngles::default()).unwrap();
    for (point, fraction) in [
        (upright.ankle, 0.039),
        (upright.knee, 0.285),
        (upright.hip, 0.530),
        (upright.shoulder, 0.818),
        (upright.eyes, 0.936),
        (upright.elbow, 0.632),
        (upright.hand, 0.433),
    ] {
        assert!((point.z - fraction * 1.75).abs() < 1e-12, "{point:?} {fraction}");
    }
    assert!((person.elbow_height() - upright.elbow.z).abs() < 1e-12);
    assert!(upright.shoulder.y < 0.0 && upright.other_shoulder.y > 0.0);
    // Palm to the body, fingers down: the back of the right hand points right.
    let hand = upright.hand_orientation;
    assert!((hand * Vector3::x() + Vector3::z()).norm() < 1e-12);
    assert!((hand * Vector3::z() + Vector3::y()).norm() < 1e-12);
    // The centre of mass of a standing person is at 55 to 58 % of stature (Winter).
    let height = upright.centre_of_mass.z / 1.75;
    assert!((0.54..0.59).contains(&height), "{height}");
}

#[test]
fn joints_turn_the_way_their_names_say() {
    let skeleton = Skeleton::new(&Person::average(), Side::Right);
    let at = |angles: JointAngles| skeleton.landmarks(&angles).unwrap();
    let zero = JointAngles::default();
    let upright = at(zero);
    assert!(at(JointAngles { ankle: 0.2, ..zero }).knee.x > 0.01);
    assert!(at(JointAngles { knee: 0.5, ..zero }).hip.x < -0.05);
    assert!(at(JointAngles { hip: 0.5, ..zero }).neck.x > 0.1);
    assert!(at(JointAngles { lumbar_flexion: 0.5, ..zero }).neck.x > 0.1);
    assert!(at(JointAngles { lumbar_side: 0.3, ..zero }).neck.y > 0.1);
    assert!(at(JointAngles { lumbar_rotation: 0.3, ..zero }).shoulder.x > 0.03);
    assert!(at(JointAngles { neck_flexion: 0.5, ..zero }).eyes.z < upright.eyes.z);
    assert!(at(JointAngles { neck_rotation: 0.5, ..zero }).eyes.y > 0.02);
    assert!(at(JointAngles { shoulder_flexion: 0.5, ..zero }).elbow.x > 0.1);
    assert!(at(JointAngles { shoulder_abduction: 0.5, ..zero }).elbow.y < upright.elbow.y - 0.1);
    assert!(at(JointAngles { elbow: 1.0, ..zero }).hand.x > 0.1);
    let bent = JointAngles { elbow: 1.5, ..zero };
    let inward = JointAngles { shoulder_rotation: 0.5, ..bent };
    assert!(at(inward).hand.y > at(bent).hand.y + 0.1);
    assert!(at(JointAngles { wrist_flexion: 0.5, ..zero }).hand.y > upright.hand.y);
    assert!(at(JointAngles { wrist_deviation: 0.3, ..zero }).hand.x < -0.01);
    // If the elbow is bent and the forearm pronated, the flat hand points forward, palm down.
    let flat = JointAngles {
        elbow: core::f64::consts::FRAC_PI_2,
        forearm_pronation: core::f64::consts::FRAC_PI_2,
        ..zero
    };
    assert!(at(flat).hand_orientation.angle_to(&Rotation3::identity()) < 1e-9);
}

#[test]
fn bad_bodies_are_refused_with_name_and_unit() {
    for stature in [0.0, -1.7, 175.0, f64::NAN, f64::INFINITY] {
        let message = Person::new(stature).unwrap_err().to_string();
        assert!(message.contains("stature"), "{message}");
    }
    let person = Person::average();
    assert!(person.clone().with_mass(0.0).is_err());
    let long = Segments { upper_arm: Some(34.0), ..Segments::default() };
    let message = person.clone().with_segments(&long).unwrap_err().to_string();
    assert!(message.contains("upper_arm") && message.contains("34"), "{message}");
    let upside_down =
        Segments { hip_height: Some(0.7), knee_height: Some(0.75), ..Segments::default() };
    let error = person.clone().with_segments(&upside_down).unwrap_err();
    assert!(matches!(error, Error::Value { what: "knee_height", .. }), "{error}");
    let mut ranges = JointRanges::default();
    ranges.max.elbow = -0.1;
    assert!(matches!(person.with_ranges(ranges), Err(Error::Value { what: "elbow", .. })));
    let skeleton = Skeleton::new(&Person::average(), Side::Left);
    let nan = JointAngles { hip: f64::NAN, ..JointAngles::default() };
    assert!(matches!(skeleton.landmarks(&nan), Err(Error::Value { what: "hip", .. })));
    assert!(PersonFrame::new(Vector3::new(0.0, f64::NAN, 0.0), 0.0).is_err());
}

#[test]
fn measured_segments_replace_the_average() {
    let measured = Segments { upper_arm: Some(0.36), foot: Some(0.30), ..Segments::default() };
    let person = Person::average().with_segments(&measured).unwrap();
    let segments = person.segments();
    assert_eq!(segments.upper_arm, Some(0.36));
    assert_eq!(segments.foot, Some(0.30));
    assert!((segments.forearm.unwrap() - 0.146 * 1.75).abs() < 1e-12);
}

proptest! {
    #[test]
    fn segments_keep_their_lengths(angles in angles(), left: bool) {
        let person = Person::tall();
        let side = if left { Side::Left } else { Side::Right };
        let l = Skeleton::new(&person, side).landmarks(&angles).unwrap();
        let s = person.segments();
        let p = |x: Option<f64>| x.unwrap();
        for (length, wanted) in [
            ((l.knee - l.ankle).norm(), p(s.knee_height) - p(s.ankle_height)),
            ((l.hip - l.knee).norm(), p(s.hip_height) - p(s.knee_height)),
            ((l.elbow - l.shoulder).norm(), p(s.upper_arm)),
            ((l.wrist - l.elbow).norm(), p(s.forearm)),
            ((l.hand - l.wrist).norm(), p(s.grip)),
            ((l.other_shoulder - l.shoulder).norm(), 2.0 * p(s.shoulder_half_width)),
        ] {
            prop_assert!((length - wanted).abs() < 1e-12, "{length} {wanted}");
        }
    }

    #[test]
    fn a_left_arm_is_the_mirror_image(angles in angles()) {
        let right = Skeleton::new(&Person::average(), Side::Right).landmarks(&angles).unwrap();
        let left = Skeleton::new(&Person::average(), Side::Left)
            .landmarks(&angles.mirrored())
            .unwrap();
        for (a, b) in points(&right).iter().zip(points(&left)) {
            prop_assert!((Vector3::new(a.x, -a.y, a.z) - b).norm() < 1e-12);
        }
        prop_assert!((left.hand_orientation.matrix().determinant() - 1.0).abs() < 1e-9);
        prop_assert_eq!(angles.mirrored().mirrored(), angles);
    }

    #[test]
    fn the_trunk_inclination_sums_the_sagittal_joints(angles in angles()) {
        let straight = JointAngles { lumbar_side: 0.0, lumbar_rotation: 0.0, ..angles };
        let l = Skeleton::new(&Person::average(), Side::Right).landmarks(&straight).unwrap();
        let trunk = l.neck - l.lumbar;
        let flexion = straight.posture().trunk_flexion;
        prop_assert!((trunk.x.atan2(trunk.z) - flexion).sin().abs() < 1e-9);
    }

    #[test]
    fn world_and_person_are_inverse(
        p in proptest::array::uniform3(-5.0..5.0_f64),
        q in proptest::array::uniform3(-5.0..5.0_f64),
        heading in -10.0..10.0_f64,
    ) {
        let pose = PersonFrame::new(p.into(), heading).unwrap();
        let point = Vector3::from(q);
        prop_assert!((pose.to_person(&pose.to_world(&point)) - point).norm() < 1e-12);
    }
}
