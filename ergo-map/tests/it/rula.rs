//! Comparison of RULA with an independent implementation (tests/golden/make.py) and with its own
//! rules.

use std::collections::HashSet;

use crate::support::{number, rows, ticked, whole};
use ergo_map::{Error, LoadPattern, Posture, Rula, RulaSubScores, RulaWorksheet};
use proptest::prelude::*;

const EASY: RulaSubScores = RulaSubScores {
    upper_arm: 1,
    lower_arm: 1,
    wrist: 1,
    wrist_twist: 1,
    neck: 1,
    trunk: 1,
    legs: 1,
};

#[test]
fn every_cell_of_tables_a_and_b_matches() {
    let mut count = 0;
    for row in rows(include_str!("../golden/rula_arm.csv")) {
        let parts = RulaSubScores {
            upper_arm: whole(&row, "upper_arm"),
            lower_arm: whole(&row, "lower_arm"),
            wrist: whole(&row, "wrist"),
            wrist_twist: whole(&row, "wrist_twist"),
            ..EASY
        };
        assert_eq!(Rula::new(parts, 0, 0).table_a, whole(&row, "a"), "{row:?}");
        count += 1;
    }
    for row in rows(include_str!("../golden/rula_body.csv")) {
        let parts = RulaSubScores {
            neck: whole(&row, "neck"),
            trunk: whole(&row, "trunk"),
            legs: whole(&row, "legs"),
            ..EASY
        };
        assert_eq!(Rula::new(parts, 0, 0).table_b, whole(&row, "b"), "{row:?}");
        count += 1;
    }
    assert_eq!(count, 144 + 72);
}

#[test]
fn every_cell_of_table_c_matches() {
    let mut cells = HashSet::new();
    for row in rows(include_str!("../golden/rula_grand.csv")) {
        let part = |name| whole(&row, name);
        let parts = RulaSubScores {
            upper_arm: part("upper_arm"),
            lower_arm: part("lower_arm"),
            wrist: part("wrist"),
            wrist_twist: part("wrist_twist"),
            neck: part("neck"),
            trunk: part("trunk"),
            legs: part("legs"),
        };
        let rula = Rula::new(parts, 0, part("extra"));
        assert_eq!(rula.rula, part("rula"), "{row:?}");
        cells.insert((rula.score_a.min(8), rula.score_b.min(7)));
    }
    assert_eq!(cells.len(), 56);
}

#[test]
fn random_sheets_match_the_golden_scores() {
    for row in rows(include_str!("../golden/rula_sheets.csv")) {
        let degrees = |name| number(&row, name).to_radians();
        let sheet = RulaWorksheet {
            upper_arm_flexion: degrees("upper_arm_flex_deg"),
            shoulder_raised: ticked(&row, "shoulder_raised"),
            arm_abducted: ticked(&row, "arm_abducted"),
            arm_supported: ticked(&row, "arm_supported"),
            elbow_flexion: degrees("lower_arm_flex_deg"),
            arm_across_or_out: ticked(&row, "arm_across_or_out"),
            wrist_flexion: degrees("wrist_flex_deg"),
            wrist_deviated: ticked(&row, "wrist_deviated"),
            wrist_twisted: ticked(&row, "wrist_twisted"),
            neck_flexion: degrees("neck_flex_deg"),
            neck_twisted: ticked(&row, "neck_twisted"),
            neck_bent: ticked(&row, "neck_bent"),
            trunk_flexion: degrees("trunk_flex_deg"),
            trunk_twisted: ticked(&row, "trunk_twisted"),
            trunk_bent: ticked(&row, "trunk_bent"),
            legs_unsupported: ticked(&row, "legs_unsupported"),
            muscle_use: ticked(&row, "muscle_use"),
            load: number(&row, "load_kg"),
            load_pattern: match row["load_pattern"] {
                "shock" => LoadPattern::Shock,
                "static_or_repeated" => LoadPattern::StaticOrRepeated,
                _ => LoadPattern::Intermittent,
            },
        };
        let rula = sheet.score().unwrap();
        let s = rula.sub_scores;
        let ours = [
            ("s_upper_arm", s.upper_arm),
            ("s_lower_arm", s.lower_arm),
            ("s_wrist", s.wrist),
            ("s_wrist_twist", s.wrist_twist),
            ("s_neck", s.neck),
            ("s_trunk", s.trunk),
            ("s_legs", s.legs),
            ("table_a", rula.table_a),
            ("score_a", rula.score_a),
            ("table_b", rula.table_b),
            ("score_b", rula.score_b),
            ("rula", rula.rula),
            ("action_level", rula.action_level.number()),
        ];
        for (name, value) in ours {
            assert_eq!(value, whole(&row, name), "{name} of {row:?}");
        }
    }
}

#[test]
fn easy_postures_are_acceptable_and_nan_is_named() {
    let easy = Posture { elbow_flexion: 1.4, ..Posture::default() };
    assert_eq!(RulaWorksheet::from_posture(&easy).score().unwrap().rula, 1);
    let sheet = RulaWorksheet { wrist_flexion: f64::NAN, ..RulaWorksheet::default() };
    assert!(matches!(sheet.score(), Err(Error::Value { what: "wrist_flexion", .. })));
    let sheet = RulaWorksheet { load: -2.0, ..RulaWorksheet::default() };
    assert!(matches!(sheet.score(), Err(Error::Value { what: "load", .. })));
}

proptest! {
    #[test]
    fn a_worse_part_never_lowers_the_score(
        parts in (1..=6_u8, 1..=3_u8, 1..=4_u8, 1..=2_u8, 1..=6_u8, 1..=6_u8, 1..=2_u8),
        part in 0..7_usize,
        extra in 0..=4_u8,
    ) {
        let (a, b, c, d, e, f, g) = parts;
        let score = |p: [u8; 7]| {
            let [upper_arm, lower_arm, wrist, wrist_twist, neck, trunk, legs] = p;
            let parts =
                RulaSubScores { upper_arm, lower_arm, wrist, wrist_twist, neck, trunk, legs };
            Rula::new(parts, 0, extra)
        };
        let easier = [a, b, c, d, e, f, g];
        let mut worse = easier;
        worse[part] += 1;
        let (before, after) = (score(easier), score(worse));
        prop_assert!(after.rula >= before.rula && after.action_level >= before.action_level);
        prop_assert!((1..=7).contains(&after.rula));
    }
}
