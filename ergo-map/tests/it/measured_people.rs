//! Postures of people as detectors measure them: upright, walking, squatting and seated.

use ergo_map::{
    Conditions, JointPositions, LegSupport, MeasuredPosture, NeutralEstimate, NeutralPosture,
    PostureFilter, Reba, Side, Worksheet,
};
use nalgebra::{Matrix3, Vector3};

const COVARIANCES: [Matrix3<f64>; JointPositions::LEN] =
    [Matrix3::new(6e-4, 0.0, 0.0, 0.0, 6e-4, 0.0, 0.0, 0.0, 6e-4); JointPositions::LEN];

#[expect(clippy::unnecessary_wraps, reason = "joints are seen or not")]
fn at(x: f64, y: f64, z: f64) -> Option<Vector3<f64>> {
    Some(Vector3::new(x, y, z))
}

fn score(measured: &MeasuredPosture) -> Reba {
    let conditions = Conditions { support: measured.support, ..Conditions::default() };
    Worksheet::from_posture(&measured.posture, conditions).score().unwrap()
}

/// Returns an upright person with ears and shoulders of a real detector. `ears` are ahead of the
/// shoulders and above them.
fn upright(ears: [f64; 2]) -> JointPositions {
    let [ahead, above] = ears;
    JointPositions {
        neck: at(-0.04, 0.0, 1.43),
        pelvis: at(0.0, 0.0, 0.93),
        nose: at(ahead + 0.07, 0.0, 1.42 + above),
        ears: [at(ahead - 0.04, 0.075, 1.43 + above), at(ahead - 0.04, -0.075, 1.43 + above)],
        shoulders: [at(-0.04, 0.18, 1.43), at(-0.04, -0.18, 1.43)],
        elbows: [at(-0.04, 0.21, 1.11), at(-0.04, -0.21, 1.11)],
        wrists: [at(-0.02, 0.21, 0.86), at(-0.02, -0.21, 0.86)],
        hips: [at(0.0, 0.09, 0.93), at(0.0, -0.09, 0.93)],
        knees: [at(0.0, 0.09, 0.51), at(0.0, -0.09, 0.51)],
        ankles: [at(-0.01, 0.09, 0.08), at(-0.01, -0.09, 0.08)],
    }
}

/// Returns that person leaning from the hips by 25°, with hanging arms.
fn leaning(ears: [f64; 2]) -> JointPositions {
    let straight = upright(ears);
    let (sin, cos) = 25_f64.to_radians().sin_cos();
    let mut joints = straight.to_array();
    let hips = Vector3::new(0.0, 0.0, 0.93);
    for point in joints[..7].iter_mut().flatten().filter(|point| point.z > 0.94) {
        let from = *point - hips;
        *point =
            hips + Vector3::new(cos * from.x + sin * from.z, from.y, cos * from.z - sin * from.x);
    }
    let mut leaning = JointPositions::from_array(joints);
    for side in 0..2 {
        let moved = leaning.shoulders[side].unwrap() - straight.shoulders[side].unwrap();
        leaning.elbows[side] = straight.elbows[side].map(|elbow| elbow + moved);
        leaning.wrists[side] = straight.wrists[side].map(|wrist| wrist + moved);
    }
    leaning
}

/// Returns the score after two seconds.
fn filtered(joints: &JointPositions, side: Side, neutral: NeutralPosture) -> Reba {
    let mut filter = PostureFilter::new(side).with_neutral(neutral);
    let mut found = None;
    for frame in 0..40 {
        found = filter.update(0.05 * f64::from(frame), joints, &COVARIANCES);
    }
    score(&found.unwrap())
}

/// Distances of the ears ahead and above [m]: as on film, of two men with the head far ahead, and
/// above the shoulders.
const EARS: [[f64; 2]; 4] = [[0.06, 0.13], [0.10, 0.13], [0.115, 0.12], [0.0, 0.13]];

#[test]
fn standing_is_upright_and_leaning_is_seen() {
    for ears in EARS {
        for side in [Side::Left, Side::Right] {
            let average = NeutralPosture::default();
            for reba in [
                score(&upright(ears).posture(side).unwrap()),
                filtered(&upright(ears), side, average),
            ] {
                assert_eq!(reba.reba, 1, "{ears:?}: {reba:?}");
            }
            for reba in [
                score(&leaning(ears).posture(side).unwrap()),
                filtered(&leaning(ears), side, average),
            ] {
                assert_eq!(reba.reba, 2, "{ears:?}: {reba:?}");
                assert_eq!(reba.sub_scores.neck, 1, "{ears:?}");
            }
        }
    }
}

#[test]
fn only_large_extension_of_the_trunk_counts() {
    for (degrees, trunk) in [(0.0_f64, 1), (9.0, 1), (14.0, 2), (30.0, 3)] {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let (x, z) = (-0.5 * sin, 0.93 + 0.5 * cos);
        let joints = JointPositions {
            neck: at(x, 0.0, z),
            pelvis: at(0.0, 0.0, 0.93),
            shoulders: [at(x, 0.18, z), at(x, -0.18, z)],
            ..JointPositions::default()
        };
        let found = score(&joints.posture(Side::Right).unwrap()).sub_scores.trunk;
        assert_eq!(found, trunk, "{degrees}");
    }
}

/// If a person's own neutral posture is known, a bend of the neck by 30° is seen, and 10° is not.
#[test]
fn an_own_neutral_posture_shows_a_bent_neck() {
    for ears in EARS {
        let mut estimate = NeutralEstimate::default();
        for _ in 0..40 {
            estimate.push(&upright(ears));
        }
        let own = estimate.neutral();
        let turned = |degrees: f64| {
            let (sin, cos) = degrees.to_radians().sin_cos();
            upright([ears[0] * cos + ears[1] * sin, ears[1] * cos - ears[0] * sin])
        };
        for (degrees, neck) in [(0.0, 1), (10.0, 1), (30.0, 2), (-8.0, 1), (-20.0, 2)] {
            let found = turned(degrees).posture_from(Side::Right, &own).unwrap();
            assert_eq!(score(&found).sub_scores.neck, neck, "{ears:?} by {degrees}: {found:?}");
        }
        let nose = JointPositions { ears: [None, None], ..upright(ears) };
        let found = nose.posture_from(Side::Right, &own).unwrap().posture;
        assert!(found.neck_flexion.abs() < 1e-9, "{found:?}");
    }
    assert_eq!(NeutralEstimate::default().neutral(), NeutralPosture::default());
}

#[test]
fn one_ear_alone_bends_and_turns_no_head() {
    let both = upright(EARS[0]);
    for hidden in 0..2 {
        let mut ears = both.ears;
        ears[hidden] = None;
        let measured = JointPositions { ears, ..both }.posture(Side::Right).unwrap();
        let unseen: Vec<_> = measured.unseen().collect();
        assert!(unseen.contains(&"neck_side") && unseen.contains(&"neck_twist"), "{unseen:?}");
        assert!(!unseen.contains(&"neck_flexion"));
        assert_eq!(score(&measured).sub_scores.neck, 1);
    }
}

/// Returns legs of thigh and shank, turned about the left axis from hanging straight.
fn on_legs(thigh: f64, knee: f64) -> JointPositions {
    let (a, b) = (thigh.to_radians(), (thigh - knee).to_radians());
    let knees = Vector3::new(0.42 * a.sin(), 0.0, -0.42 * a.cos());
    let ankles = knees + Vector3::new(0.42 * b.sin(), 0.0, -0.42 * b.cos());
    let standing = upright(EARS[0]);
    let pair = |below: Vector3<f64>| standing.hips.map(|hip| hip.map(|hip| hip + below));
    JointPositions { knees: pair(knees), ankles: pair(ankles), ..standing }
}

#[test]
fn balance_distinguishes_a_seat_from_bent_knees() {
    for (thigh, knee, support, legs) in [
        (0.0, 0.0, LegSupport::Bilateral, 1),
        (25.0, 45.0, LegSupport::Bilateral, 2),
        // The hips of a person who squats are over the heels, or nearly.
        (70.0, 110.0, LegSupport::Bilateral, 3),
        (90.0, 130.0, LegSupport::Bilateral, 3),
        (90.0, 90.0, LegSupport::Sitting, 1),
        (85.0, 70.0, LegSupport::Sitting, 1),
        // The feet are drawn back below a chair.
        (90.0, 100.0, LegSupport::Sitting, 1),
    ] {
        let joints = on_legs(thigh, knee);
        let measured = joints.posture(Side::Right).unwrap();
        assert_eq!(measured.support, support, "{thigh} {knee}");
        assert_eq!(score(&measured).sub_scores.legs, legs, "{thigh} {knee}");
        assert_eq!(filtered(&joints, Side::Right, NeutralPosture::default()).sub_scores.legs, legs);
    }
}

fn moved(joints: &JointPositions, by: Vector3<f64>) -> JointPositions {
    JointPositions::from_array(joints.to_array().map(|joint| joint.map(|joint| joint + by)))
}

#[test]
fn bent_knees_count_only_in_standing() {
    for speed in [0.3, 0.6, 1.2] {
        let mut filter = PostureFilter::new(Side::Right);
        let mut legs = Vec::new();
        for frame in 0..200 {
            let time = 0.05 * f64::from(frame);
            // The person walks for five seconds, and stands on bent knees for five.
            let swing = if time < 5.0 { 25.0 - 25.0 * (6.0 * time).cos() } else { 45.0 };
            let way = Vector3::new(speed * time.min(5.0), 0.0, 0.0);
            let joints = moved(&on_legs(0.5 * swing, swing), way);
            let measured = filter.update(time, &joints, &COVARIANCES).unwrap();
            legs.push((time, measured.support, score(&measured).sub_scores.legs));
        }
        let walking = legs.iter().filter(|(time, ..)| (1.5..5.0).contains(time));
        for (time, support, legs) in walking {
            assert_eq!((*support, *legs), (LegSupport::Walking, 1), "{speed} at {time}");
        }
        let standing = legs.iter().filter(|(time, ..)| *time > 8.0);
        for (time, support, legs) in standing {
            assert_eq!((*support, *legs), (LegSupport::Bilateral, 2), "{speed} at {time}");
        }
    }
}

/// The man on film walks upright and looks ahead of his feet, with his knees bent by up to 60°.
#[test]
fn a_man_on_film_walks_upright() {
    let table = include_str!("../data/balance_beam.csv");
    let frames = table.lines().filter(|line| !line.starts_with('#')).skip(1).map(|line| {
        let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
        let joint = |index: usize| Some(Vector3::from_column_slice(&cells[1 + 3 * index..][..3]));
        (cells[0], JointPositions::from_array(core::array::from_fn(joint)))
    });
    for side in [Side::Left, Side::Right] {
        let mut filter = PostureFilter::new(side);
        for (time, joints) in frames.clone() {
            let measured = filter.update(time, &joints, &COVARIANCES).unwrap();
            // Walking is only detected after some time.
            if time < 0.5 {
                continue;
            }
            let parts = score(&measured).sub_scores;
            assert_eq!((parts.legs, measured.support), (1, LegSupport::Walking), "{time}");
            assert!(parts.neck == 1 && parts.trunk <= 3, "{time}: {parts:?} {measured:?}");
        }
    }
}
