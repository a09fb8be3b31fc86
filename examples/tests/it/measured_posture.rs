//! Scores of measured bodies over time.

use human_perception::percepts::{Assessor, PostureSettings};
use vision_models::{Body, Body25, Confidence, Keypoint};

use Body25::{
    LeftAnkle, LeftEar, LeftElbow, LeftHip, LeftKnee, LeftShoulder, LeftWrist, MidHip, Neck, Nose,
    RightAnkle, RightEar, RightElbow, RightHip, RightKnee, RightShoulder, RightWrist,
};

/// An upright person, as a real detector sees them \[m\].
const UPRIGHT: [(Body25, [f64; 3]); 17] = [
    (Nose, [0.13, 0.0, 1.55]),
    (Neck, [-0.04, 0.0, 1.43]),
    (RightShoulder, [-0.04, -0.18, 1.43]),
    (RightElbow, [-0.04, -0.21, 1.11]),
    (RightWrist, [-0.02, -0.21, 0.86]),
    (LeftShoulder, [-0.04, 0.18, 1.43]),
    (LeftElbow, [-0.04, 0.21, 1.11]),
    (LeftWrist, [-0.02, 0.21, 0.86]),
    (MidHip, [0.0, 0.0, 0.93]),
    (RightHip, [0.0, -0.09, 0.93]),
    (RightKnee, [0.0, -0.09, 0.51]),
    (RightAnkle, [-0.01, -0.09, 0.08]),
    (LeftHip, [0.0, 0.09, 0.93]),
    (LeftKnee, [0.0, 0.09, 0.51]),
    (LeftAnkle, [-0.01, 0.09, 0.08]),
    (RightEar, [0.02, -0.075, 1.56]),
    (LeftEar, [0.02, 0.075, 1.56]),
];

fn body(joints: &[(Body25, [f64; 3])]) -> Body {
    let mut body = Body::default();
    for (joint, position) in joints {
        let confidence = Confidence::new(0.9).unwrap();
        body.set(*joint, Some(Keypoint { position: (*position).into(), confidence }));
    }
    body
}

/// The right arm is raised forwards by an angle \[rad\].
fn raised(angle: f64) -> Body {
    let (sin, cos) = angle.sin_cos();
    let mut joints = UPRIGHT;
    joints[3].1 = [-0.04 + 0.32 * sin, -0.21, 1.43 - 0.32 * cos];
    joints[4].1 = [-0.04 + 0.57 * sin, -0.21, 1.43 - 0.57 * cos];
    body(&joints)
}

#[test]
fn arm_score_is_independent_of_full_turns() {
    for turns in [1, 2, 3] {
        for backward in [false, true] {
            let mut assessor = Assessor::default();
            let mut last = None;
            let mut worst = 0;
            for frame in 0..40 * turns + 60 {
                let turn = (f64::from(frame) - 20.0).clamp(0.0, 40.0 * f64::from(turns)) / 40.0;
                let angle = std::f64::consts::TAU * if backward { -turn } else { turn };
                last = assessor.update(0.05 * f64::from(frame), &raised(angle)).unwrap();
                worst = worst.max(last.unwrap().reba.sub_scores.upper_arm);
            }
            let last = last.unwrap();
            assert_eq!((worst, last.reba.reba), (4, 1), "{turns} turns: {last:?}");
            assert_eq!(last.reba.sub_scores.upper_arm, 1);
        }
    }
}

#[test]
fn what_is_known_of_a_person_counts() {
    let seated = |options: PostureSettings| {
        let mut joints = UPRIGHT;
        // The knees are bent over the feet.
        for (index, y) in [(10, -0.09), (13, 0.09)] {
            joints[index].1 = [0.29, y, 0.62];
            joints[index + 1].1 = [-0.05, y, 0.38];
        }
        let mut assessor = Assessor::new(options);
        let scores = (0..20).map(|frame| assessor.update(0.05 * f64::from(frame), &body(&joints)));
        scores.last().unwrap().unwrap().unwrap().reba.sub_scores
    };
    let options = PostureSettings::default();
    assert!(seated(options).legs > 1);
    assert_eq!(seated(PostureSettings { sitting: true, ..options }).legs, 1);

    let lifted = |arm_supported| {
        let mut assessor = Assessor::new(PostureSettings { arm_supported, ..options });
        let scores = (0..40).map(|frame| assessor.update(0.05 * f64::from(frame), &raised(1.2)));
        scores.last().unwrap().unwrap().unwrap().reba.sub_scores.upper_arm
    };
    assert_eq!((lifted(false), lifted(true)), (3, 2));
    for upright in [-1.0, f64::NAN, 1e9] {
        assert!(PostureSettings { upright, ..options }.checked().is_err());
    }
    assert!(PostureSettings { upright: 3.0, ..options }.checked().is_ok());
}

/// A head 55° in front of the shoulders counts as bent, unless the person has shown it as their neutral posture.
#[test]
fn some_seconds_of_standing_make_a_neutral_posture() {
    let head = |degrees: f64| {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let (x, z) = (-0.04 + 0.15 * sin, 1.43 + 0.15 * cos);
        let mut joints = UPRIGHT;
        joints[0].1 = [x + 0.1, 0.0, z];
        joints[15].1 = [x, -0.075, z];
        joints[16].1 = [x, 0.075, z];
        body(&joints)
    };
    let neck = |upright: f64, then: f64| {
        let mut assessor = Assessor::new(PostureSettings { upright, ..PostureSettings::default() });
        let mut found = 0;
        for frame in 0..160 {
            let degrees = if frame < 60 { 55.0 } else { then };
            let scores = assessor.update(0.05 * f64::from(frame), &head(degrees)).unwrap();
            found = scores.unwrap().reba.sub_scores.neck;
        }
        found
    };
    assert_eq!((neck(0.0, 55.0), neck(2.0, 55.0)), (2, 1));
    assert_eq!(neck(2.0, 85.0), 2);
}
