//! Comparison of REBA with an independent implementation (tests/golden/make.py) and with its own
//! rules.

use crate::support::{number, rows, ticked, whole};
use ergo_map::{
    ActionLevel, Conditions, Coupling, Error, LegSupport, Posture, Reba, RebaSubScores, Worksheet,
};
use proptest::prelude::*;

#[test]
fn all_sub_scores_match_the_golden_tables() {
    let mut count = 0;
    for row in rows(include_str!("../golden/reba_combinations.csv")) {
        let sub_scores = RebaSubScores {
            neck: whole(&row, "neck"),
            trunk: whole(&row, "trunk"),
            legs: whole(&row, "legs"),
            upper_arm: whole(&row, "upper_arm"),
            lower_arm: whole(&row, "lower_arm"),
            wrist: whole(&row, "wrist"),
        };
        let reba = Reba::new(sub_scores, &Conditions::default());
        let ours = [reba.table_a, reba.table_b, reba.reba, reba.action_level.number()];
        assert_eq!(ours, ["a", "b", "reba", "action_level"].map(|n| whole(&row, n)), "{row:?}");
        count += 1;
    }
    assert_eq!(count, 2160);
}

#[test]
fn random_sheets_match_the_golden_scores() {
    for row in rows(include_str!("../golden/reba_sheets.csv")) {
        let degrees = |name| number(&row, name).to_radians();
        let sheet = Worksheet {
            trunk_flexion: degrees("trunk_flex_deg"),
            trunk_twisted_or_bent: ticked(&row, "trunk_twist_or_side"),
            neck_flexion: degrees("neck_flex_deg"),
            neck_twisted_or_bent: ticked(&row, "neck_twist_or_side"),
            knee_flexion: degrees("knee_flex_deg"),
            upper_arm_flexion: degrees("upper_arm_flex_deg"),
            arm_abducted_or_rotated: ticked(&row, "arm_abducted_or_rotated"),
            elbow_flexion: degrees("lower_arm_flex_deg"),
            wrist_flexion: degrees("wrist_flex_deg"),
            wrist_deviated_or_twisted: ticked(&row, "wrist_dev_or_twist"),
            conditions: Conditions {
                load: number(&row, "load_kg"),
                shock: ticked(&row, "shock"),
                coupling: Coupling::from_score(whole(&row, "coupling")).unwrap(),
                support: if ticked(&row, "unilateral") {
                    LegSupport::Unilateral
                } else {
                    LegSupport::Bilateral
                },
                shoulder_raised: ticked(&row, "shoulder_raised"),
                arm_supported: ticked(&row, "arm_supported"),
                held_static: ticked(&row, "static"),
                repeated: ticked(&row, "repeated"),
                rapid_or_unstable: ticked(&row, "rapid_or_unstable"),
            },
        };
        let reba = sheet.score().unwrap();
        let s = reba.sub_scores;
        let ours = [
            ("s_neck", s.neck),
            ("s_trunk", s.trunk),
            ("s_legs", s.legs),
            ("s_upper_arm", s.upper_arm),
            ("s_lower_arm", s.lower_arm),
            ("s_wrist", s.wrist),
            ("table_a", reba.table_a),
            ("score_a", reba.score_a),
            ("table_b", reba.table_b),
            ("score_b", reba.score_b),
            ("score_c", reba.score_c),
            ("reba", reba.reba),
            ("action_level", reba.action_level.number()),
        ];
        for (name, value) in ours {
            assert_eq!(value, whole(&row, name), "{name} of {row:?}");
        }
    }
}

#[test]
fn published_worked_cases() {
    let score = |[neck, trunk, legs, upper_arm, lower_arm, wrist]: [u8; 6], load, coupling| {
        let sub_scores = RebaSubScores { neck, trunk, legs, upper_arm, lower_arm, wrist };
        // A load score of 3: more than 10 kg, with shock.
        let conditions = Conditions {
            load: if load { 12.0 } else { 0.0 },
            shock: load,
            coupling: Coupling::from_score(coupling).unwrap(),
            ..Conditions::default()
        };
        let reba = Reba::new(sub_scores, &conditions);
        (reba.score_a, reba.score_b, reba.score_c)
    };
    assert_eq!(score([2, 2, 2, 1, 2, 3], false, 0), (4, 3, 4));
    assert_eq!(score([2, 2, 2, 1, 2, 2], false, 0), (4, 2, 4));
    assert_eq!(score([1, 4, 3, 4, 1, 2], true, 3), (9, 8, 11));
}

#[test]
fn the_neutral_posture_scores_one() {
    let neutral = Worksheet { elbow_flexion: 1.4, ..Worksheet::default() };
    let reba = neutral.score().unwrap();
    assert_eq!((reba.reba, reba.action_level), (1, ActionLevel::None));
    assert_eq!(Worksheet::default().score().unwrap().reba, 1);
}

#[test]
fn sitting_and_arm_support_lower_their_sub_scores() {
    let mut sheet = Worksheet { knee_flexion: 1.6, ..Worksheet::default() };
    assert_eq!(sheet.score().unwrap().sub_scores.legs, 3);
    sheet.conditions.support = LegSupport::Sitting;
    assert_eq!(sheet.score().unwrap().sub_scores.legs, 1);
    sheet.conditions.arm_supported = true;
    assert_eq!(sheet.score().unwrap().sub_scores.upper_arm, 1);
}

#[test]
fn a_posture_ticks_the_boxes() {
    let turned = Posture {
        trunk_twist: -0.3,
        neck_side: 0.5,
        upper_arm_abduction: 0.8,
        wrist_deviation: -0.3,
        ..Posture::default()
    };
    let sheet = Worksheet::from_posture(&turned, Conditions::default());
    assert!(sheet.trunk_twisted_or_bent && sheet.neck_twisted_or_bent);
    assert!(sheet.arm_abducted_or_rotated && sheet.wrist_deviated_or_twisted);
    let straight = Worksheet::from_posture(&Posture::default(), Conditions::default());
    assert_eq!(straight, Worksheet::default());
}

#[test]
fn bad_numbers_are_named() {
    let sheet = Worksheet { neck_flexion: f64::NAN, ..Worksheet::default() };
    assert!(matches!(sheet.score(), Err(Error::Value { what: "neck_flexion", .. })));
    let mut sheet = Worksheet::default();
    sheet.conditions.load = -1.0;
    let message = sheet.score().unwrap_err().to_string();
    assert!(message.contains("load") && message.contains("-1") && message.contains("kg"));
}

fn sub_scores() -> impl Strategy<Value = [u8; 6]> {
    (1..=3_u8, 1..=5_u8, 1..=4_u8, 1..=6_u8, 1..=2_u8, 1..=3_u8)
        .prop_map(|(a, b, c, d, e, f)| [a, b, c, d, e, f])
}

fn reba_of([neck, trunk, legs, upper_arm, lower_arm, wrist]: [u8; 6]) -> Reba {
    let parts = RebaSubScores { neck, trunk, legs, upper_arm, lower_arm, wrist };
    Reba::new(parts, &Conditions::default())
}

proptest! {
    #[test]
    fn a_worse_part_never_lowers_the_score(parts in sub_scores(), part in 0..6_usize) {
        let mut worse = parts;
        worse[part] += 1; // beyond the table, where it counts as its last row
        let (before, after) = (reba_of(parts), reba_of(worse));
        prop_assert!(after.table_a >= before.table_a);
        prop_assert!(after.table_b >= before.table_b);
        prop_assert!(after.reba >= before.reba);
        prop_assert!(after.action_level >= before.action_level);
    }

    #[test]
    fn conditions_only_add(parts in sub_scores(), load in 0.0..30.0, shock: bool, held: bool) {
        let [neck, trunk, legs, upper_arm, lower_arm, wrist] = parts;
        let parts = RebaSubScores { neck, trunk, legs, upper_arm, lower_arm, wrist };
        let conditions = Conditions { load, shock, held_static: held, ..Conditions::default() };
        let (easy, hard) =
            (Reba::new(parts, &Conditions::default()), Reba::new(parts, &conditions));
        prop_assert!(hard.reba >= easy.reba && hard.reba <= 15);
    }
}
