//! Comparison of the continuous scores with the integer one.
#![allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]

use std::f64::consts::PI;

use crate::support::{MAP, Random};
use ergo_map::{
    ActionLevel, Conditions, ContinuousReba, Coupling, Error, LegSupport, Mode, Posture, Worksheet,
    ergonomics_score, ergonomics_score_gradient,
};
use proptest::prelude::*;

const POSTURES: usize = 4000;

/// Rounds so that the lower class holds on a threshold.
fn rounded(value: f64) -> i64 {
    (value - 0.5).ceil() as i64
}

/// Returns three kinds of random postures: uniform over the ranges of motion, from easy to extreme,
/// and those of the posture predictor within reach.
fn kinds() -> [(&'static str, Vec<Posture>); 3] {
    let mut random = Random(2000);
    let nodes: Vec<Posture> = MAP.nodes().map(|node| node.angles.posture()).collect();
    [
        ("uniform", (0..POSTURES).map(|_| random.posture()).collect()),
        ("easy to extreme", (0..POSTURES).map(|_| random.graded_posture()).collect()),
        ("reaching", (0..POSTURES).map(|i| nodes[i * 7919 % nodes.len()]).collect()),
    ]
}

#[test]
fn faithful_rounds_to_the_integer_score() {
    let conditions = Conditions::default();
    for (kind, postures) in kinds() {
        let (mut same, mut same_level, mut error) = (0, 0, 0.0);
        for posture in &postures {
            let discrete = Worksheet::from_posture(posture, conditions).score().unwrap();
            let faithful =
                ContinuousReba::of_posture(posture, &conditions, Mode::FAITHFUL).unwrap().reba;
            let whole = rounded(faithful);
            same += usize::from(whole == i64::from(discrete.reba));
            same_level += usize::from(ActionLevel::of(whole as u8) == discrete.action_level);
            error += (faithful - f64::from(discrete.reba)).abs();
        }
        let share = |n: usize| n as f64 / POSTURES as f64;
        let mean_error = error / POSTURES as f64;
        println!(
            "{kind}: same score {:.4}, same action level {:.4}, mean error {mean_error:.4}",
            share(same),
            share(same_level)
        );
        assert!(share(same) >= 0.99, "{kind}: {}", share(same));
        assert!(share(same_level) >= 0.995, "{kind}: {}", share(same_level));
    }
}

#[test]
fn the_scores_range_from_zero_to_their_maximum() {
    let easy =
        Posture { neck_flexion: 10_f64.to_radians(), elbow_flexion: 1.4, ..Posture::default() };
    let best = ergonomics_score(&easy, &Conditions::default(), Mode::Graded);
    assert!(best.abs() < 1e-12, "{best}");
    let worst =
        Posture::from_array([1.9, 1.0, 1.0, 1.5, 1.0, 1.5, 2.4, 3.1, 1.5, 1.5, 0.0, 1.4, 1.0, 1.5]);
    let conditions = Conditions {
        support: LegSupport::Unilateral,
        shoulder_raised: true,
        ..Conditions::default()
    };
    let worst = ergonomics_score(&worst, &conditions, Mode::Graded);
    assert!((worst - 4.25).abs() < 0.2 && worst <= 4.25, "{worst}");
}

/// Away from the neutral angle each graded curve rises strictly, up to the end of the range of
/// motion.
#[test]
fn graded_curves_have_no_plateau() {
    type Part = (fn(&mut Worksheet) -> &mut f64, fn(&ContinuousReba) -> f64, [f64; 3]);
    let parts: [Part; 6] = [
        (|s| &mut s.trunk_flexion, |g| g.trunk, [-30.0, 0.0, 100.0]),
        (|s| &mut s.neck_flexion, |g| g.neck, [-45.0, 10.0, 45.0]),
        (|s| &mut s.knee_flexion, |g| g.legs, [0.0, 0.0, 130.0]),
        (|s| &mut s.upper_arm_flexion, |g| g.upper_arm, [-60.0, 0.0, 180.0]),
        (|s| &mut s.elbow_flexion, |g| g.lower_arm, [0.0, 80.0, 145.0]),
        (|s| &mut s.wrist_flexion, |g| g.wrist, [-75.0, 0.0, 75.0]),
    ];
    for (angle, sub_score, [min, neutral, max]) in parts {
        let at = |degrees: f64| {
            let mut sheet = Worksheet::default();
            *angle(&mut sheet) = degrees.to_radians();
            sub_score(&ContinuousReba::of_worksheet(&sheet, Mode::Graded).unwrap())
        };
        assert!((at(neutral) - 1.0).abs() < 1e-12);
        for end in [min, max] {
            let steps = (end - neutral).abs() as u32;
            let way = |i: u32| at(neutral + (end - neutral).signum() * f64::from(i));
            for i in 0..steps {
                assert!(way(i + 1) > way(i) + 0.002, "{} at step {i} to {end}", way(i));
            }
        }
    }
}

fn angle() -> impl Strategy<Value = f64> {
    -1.2..3.2_f64
}

fn sheet() -> impl Strategy<Value = Worksheet> {
    let angles = proptest::array::uniform6(angle());
    let boxes = proptest::array::uniform6(any::<bool>());
    let support = prop_oneof![
        Just(LegSupport::Bilateral),
        Just(LegSupport::Unilateral),
        Just(LegSupport::Sitting)
    ];
    (angles, boxes, support, 0..4_u8).prop_map(|(a, b, support, coupling)| Worksheet {
        trunk_flexion: a[0],
        neck_flexion: a[1],
        knee_flexion: a[2].abs(),
        upper_arm_flexion: a[3],
        elbow_flexion: a[4].abs(),
        wrist_flexion: a[5],
        trunk_twisted_or_bent: b[0],
        neck_twisted_or_bent: b[1],
        arm_abducted_or_rotated: b[2],
        wrist_deviated_or_twisted: b[3],
        conditions: Conditions {
            support,
            shoulder_raised: b[4],
            arm_supported: b[5],
            coupling: Coupling::from_score(coupling).unwrap(),
            ..Conditions::default()
        },
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4000))]

    #[test]
    fn rounded_graded_sub_scores_are_the_sub_scores(sheet in sheet()) {
        let graded = ContinuousReba::of_worksheet(&sheet, Mode::Graded).unwrap();
        let discrete = sheet.score().unwrap().sub_scores;
        let pairs = [
            ("neck", graded.neck, discrete.neck),
            ("trunk", graded.trunk, discrete.trunk),
            ("legs", graded.legs, discrete.legs),
            ("upper arm", graded.upper_arm, discrete.upper_arm),
            ("lower arm", graded.lower_arm, discrete.lower_arm),
            ("wrist", graded.wrist, discrete.wrist),
        ];
        for (name, graded, discrete) in pairs {
            prop_assert_eq!(rounded(graded), i64::from(discrete), "{} {}", name, graded);
        }
    }

    #[test]
    fn away_from_thresholds_faithful_is_the_integer_score(sheet in sheet()) {
        // Thresholds are at least 5° apart, so that 1e-6 rad of softening leaves whole classes.
        let narrow = Mode::Faithful { half_width: 1e-6 };
        let faithful = ContinuousReba::of_worksheet(&sheet, narrow).unwrap();
        prop_assert!((faithful.reba - f64::from(sheet.score().unwrap().reba)).abs() < 1e-9);
    }

    #[test]
    fn the_gradient_is_the_derivative(
        angles in proptest::array::uniform14(-1.5..2.5_f64),
        faithful: bool,
        raised: bool,
    ) {
        let mode = if faithful { Mode::FAITHFUL } else { Mode::Graded };
        let conditions = Conditions { shoulder_raised: raised, ..Conditions::default() };
        let score = |q: [f64; 14]| ergonomics_score(&Posture::from_array(q), &conditions, mode);
        let (value, gradient) =
            ergonomics_score_gradient(&Posture::from_array(angles), &conditions, mode);
        prop_assert!((value - score(angles)).abs() < 1e-12);
        let step = 1e-7;
        for (i, slope) in gradient.to_array().into_iter().enumerate() {
            let (mut low, mut high) = (angles, angles);
            low[i] -= step;
            high[i] += step;
            let (left, right) = ((value - score(low)) / step, (score(high) - value) / step);
            // The two sides differ at a knot, and the gradient is between them.
            let between = (left.min(right) - 1e-4)..=(left.max(right) + 1e-4);
            prop_assert!(between.contains(&slope), "{i}: {slope} against {left}, {right}");
        }
    }

    #[test]
    fn small_motions_change_the_score_little(
        angles in proptest::array::uniform14(-1.5..2.5_f64),
        motion in proptest::array::uniform14(-1e-4..1e-4_f64),
    ) {
        let conditions = Conditions::default();
        let moved: [f64; 14] = core::array::from_fn(|i| angles[i] + motion[i]);
        let [a, b] = [angles, moved].map(|q| {
            ergonomics_score(&Posture::from_array(q), &conditions, Mode::Graded)
        });
        let way: f64 = motion.iter().map(|angle| angle.abs()).sum();
        prop_assert!((a - b).abs() <= STEEPEST * way + 1e-12, "{} over {way}", a - b);
    }
}

/// Largest slope of the score with respect to one angle \[1/rad\]. The upper arm's curve rises by
/// 0.4 in 8°. Table B rises by at most 3 a class. The arms are one of the four parts of the mean.
const STEEPEST: f64 = 0.4 / (8.0 * PI / 180.0) * 3.0 / 4.0;

#[test]
fn the_steepest_slope_is_near_its_bound() {
    // The knee's curve rises by 0.7 from 30° to 36°.
    let score = |degrees: f64| {
        let posture = Posture { knee_flexion: degrees.to_radians(), ..Posture::default() };
        ergonomics_score(&posture, &Conditions::default(), Mode::Graded)
    };
    let slope = (score(35.0) - score(31.0)) / 4.0_f64.to_radians();
    assert!((slope - 0.7 / 6.0_f64.to_radians() / 4.0).abs() < 1e-9, "{slope}");
    assert!(slope > 0.7 * STEEPEST && slope < STEEPEST, "{slope} of {STEEPEST}");
}

#[test]
fn bad_numbers_are_named() {
    let posture = Posture { elbow_flexion: f64::INFINITY, ..Posture::default() };
    let conditions = Conditions::default();
    let error = ContinuousReba::of_posture(&posture, &conditions, Mode::Graded).unwrap_err();
    assert!(matches!(error, Error::Value { what: "elbow_flexion", .. }));
    let mode = Mode::Faithful { half_width: 0.0 };
    let error = ContinuousReba::of_posture(&Posture::default(), &conditions, mode).unwrap_err();
    assert!(matches!(error, Error::Value { what: "half_width", .. }));
}
