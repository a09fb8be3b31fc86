//! Tables of REBA and RULA sheets.

use std::collections::HashMap;
use std::ops::ControlFlow;

use ergo_map::{ContinuousReba, Mode, RulaWorksheet, Worksheet};
use ergo_report::Error;
use ergo_report::sheets::{Cell, Column, Sheet, SheetTable, Unknown};
use proptest::prelude::*;

const ANGLES: &str = "trunk_flex_deg,neck_flex_deg,knee_flex_deg,upper_arm_flex_deg,\
                      lower_arm_flex_deg,wrist_flex_deg";

fn scored<S: Sheet>(table: &str) -> Result<String, Error> {
    let mut output = Vec::new();
    score::<S>(table.as_bytes(), &mut output)?;
    Ok(String::from_utf8(output).unwrap())
}

fn score<S: Sheet>(table: &[u8], output: &mut Vec<u8>) -> Result<(), Error> {
    let mut table = SheetTable::<S, _>::new(table, Unknown::PassThrough)?;
    assert!(table.score(output, |_| ControlFlow::Continue(()))?.is_continue());
    Ok(())
}

/// Returns the cells of each row by the names of their columns.
fn rows(table: &str) -> Vec<HashMap<&str, &str>> {
    let mut lines = table.lines();
    let names: Vec<&str> = lines.next().unwrap().split(',').collect();
    lines.map(|line| names.iter().copied().zip(line.split(',')).collect()).collect()
}

/// Returns a row's cells as numbers.
fn numbers(row: &HashMap<&str, &str>, names: &[&str]) -> Vec<f64> {
    names.iter().map(|name| row[name].parse().unwrap()).collect()
}

const PARTS: [&str; 6] = ["s_neck", "s_trunk", "s_legs", "s_upper_arm", "s_lower_arm", "s_wrist"];

#[test]
fn the_worked_cases_give_their_scores() {
    let table = format!(
        "{ANGLES},load_kg,coupling,unilateral,wrist_dev_or_twist,shock
30,10,0,0,30,0,0,0,0,0,0
10,30,0,0,30,30,0,0,1,1,0
10,30,0,0,30,30,0,0,1,0,0
70,10,45,100,80,30,12,unacceptable,1,0,1
0,0,0,0,80,0,0,good,0,0,0
"
    );
    let output = scored::<Worksheet>(&table).unwrap();
    let rows = rows(&output);
    assert_eq!(rows.len(), 5);
    let parts: Vec<_> = rows.iter().map(|row| numbers(row, &PARTS)).collect();
    assert_eq!(parts[1], [2.0, 2.0, 2.0, 1.0, 2.0, 3.0]);
    assert_eq!(parts[2], [2.0, 2.0, 2.0, 1.0, 2.0, 2.0]);
    assert_eq!(parts[3], [1.0, 4.0, 3.0, 4.0, 1.0, 2.0]);
    let totals = |row| numbers(row, &["score_a", "score_b", "score_c"]);
    assert_eq!(totals(&rows[1]), [4.0, 3.0, 4.0]);
    assert_eq!(totals(&rows[2]), [4.0, 2.0, 4.0]);
    assert_eq!(totals(&rows[3]), [9.0, 8.0, 11.0]);
    assert_eq!((rows[3]["table_a"], rows[3]["table_b"]), ("6", "5"));
    assert_eq!((rows[3]["reba"], rows[3]["action_level"]), ("11", "4"));
    assert_eq!((rows[4]["reba"], rows[4]["action_level"]), ("1", "0"));
}

/// Effect of ticking a box, or of another cell, on an average sheet: column, cell, changed scores.
type Change = (&'static str, &'static str, &'static [(&'static str, f64)]);

fn assert_changes<S: Sheet>(changes: &[Change]) {
    let plain = format!("{ANGLES}\n30,10,0,30,80,10\n");
    let plain = scored::<S>(&plain).unwrap();
    let plain = rows(&plain);
    for (column, cell, scores) in changes {
        let ticked = format!("{ANGLES},{column}\n30,10,0,30,80,10,{cell}\n");
        let ticked = scored::<S>(&ticked).unwrap();
        let ticked = rows(&ticked);
        for (score, change) in *scores {
            let (after, before) = (numbers(&ticked[0], &[score]), numbers(&plain[0], &[score]));
            assert_eq!(after[0] - before[0], *change, "{column} {score}");
        }
        // Only the part's own sub-score changes.
        for part in S::SCORES.iter().filter(|score| score.starts_with("s_")) {
            let named = scores.iter().any(|(score, _)| score == part);
            assert_eq!(ticked[0][part] == plain[0][part], !named, "{column} {part}");
        }
    }
}

#[test]
fn every_box_changes_what_it_should() {
    assert_changes::<Worksheet>(&[
        ("trunk_twist_or_side", "1", &[("s_trunk", 1.0)]),
        ("neck_twist_or_side", "1", &[("s_neck", 1.0)]),
        ("unilateral", "1", &[("s_legs", 1.0)]),
        ("sitting", "1", &[]),
        ("arm_abducted_or_rotated", "1", &[("s_upper_arm", 1.0)]),
        ("shoulder_raised", "1", &[("s_upper_arm", 1.0)]),
        ("arm_supported", "1", &[("s_upper_arm", -1.0)]),
        ("wrist_dev_or_twist", "1", &[("s_wrist", 1.0)]),
        ("shock", "1", &[("table_a", 0.0), ("score_a", 1.0)]),
        ("load_kg", "7", &[("table_a", 0.0), ("score_a", 1.0)]),
        ("coupling", "poor", &[("table_b", 0.0), ("score_b", 2.0)]),
        ("static", "1", &[("score_c", 0.0), ("reba", 1.0), ("e_s", 0.0)]),
        ("repeated", "1", &[("score_c", 0.0), ("reba", 1.0), ("e_s", 0.0)]),
        ("rapid_or_unstable", "1", &[("score_c", 0.0), ("reba", 1.0), ("e_s", 0.0)]),
    ]);
    assert_changes::<RulaWorksheet>(&[
        ("trunk_twist", "1", &[("s_trunk", 1.0)]),
        ("trunk_side", "1", &[("s_trunk", 1.0)]),
        ("neck_twist", "1", &[("s_neck", 1.0)]),
        ("neck_side", "1", &[("s_neck", 1.0)]),
        ("arm_abducted", "1", &[("s_upper_arm", 1.0)]),
        ("shoulder_raised", "1", &[("s_upper_arm", 1.0)]),
        ("arm_supported", "1", &[("s_upper_arm", -1.0)]),
        ("arm_across_or_out", "1", &[("s_lower_arm", 1.0)]),
        ("wrist_dev", "1", &[("s_wrist", 1.0)]),
        ("wrist_twist", "1", &[("s_wrist_twist", 1.0)]),
        ("legs_unsupported", "1", &[("s_legs", 1.0)]),
        ("static", "1", &[("score_a", 1.0), ("score_b", 1.0)]),
        ("repeated", "1", &[("score_a", 1.0), ("score_b", 1.0)]),
        ("shock", "1", &[("score_a", 3.0), ("score_b", 3.0)]),
        ("load_kg", "7", &[("score_a", 1.0), ("score_b", 1.0)]),
        ("rapid_or_unstable", "1", &[("rula", 0.0)]),
    ]);
}

#[test]
fn activity_and_continuous_scores_match_the_crate() {
    let table = format!(
        "{ANGLES},static,repeated,rapid_or_unstable,shoulder_raised,arm_supported,trunk_twist_or_side
25,12,0,33,70,4,1,1,1,1,0,1
25,12,0,33,70,4,0,0,0,0,1,0
"
    );
    let output = scored::<Worksheet>(&table).unwrap();
    let rows = rows(&output);
    assert_eq!(numbers(&rows[0], &["score_c", "reba"]), [3.0, 6.0]);
    assert_eq!(numbers(&rows[0], &["s_upper_arm", "s_trunk"]), [3.0, 4.0]);
    assert_eq!(numbers(&rows[1], &["s_upper_arm", "s_trunk"]), [1.0, 3.0]);
    let mut sheet = Worksheet {
        trunk_flexion: 25_f64.to_radians(),
        trunk_twisted_or_bent: true,
        neck_flexion: 12_f64.to_radians(),
        upper_arm_flexion: 33_f64.to_radians(),
        elbow_flexion: 70_f64.to_radians(),
        wrist_flexion: 4_f64.to_radians(),
        ..Worksheet::default()
    };
    sheet.conditions.shoulder_raised = true;
    sheet.conditions.held_static = true;
    sheet.conditions.repeated = true;
    sheet.conditions.rapid_or_unstable = true;
    let of = |mode| ContinuousReba::of_worksheet(&sheet, mode).unwrap();
    let continuous = of(Mode::Graded).contributions().mean();
    assert_eq!(numbers(&rows[0], &["reba_faithful", "e_s"]), [of(Mode::FAITHFUL).reba, continuous]);
}

#[test]
fn rula_accepts_its_own_and_rebas_columns() {
    let header =
        "trunk_flex_deg,neck_flex_deg,upper_arm_flex_deg,lower_arm_flex_deg,wrist_flex_deg";
    let own = format!(
        "{header},load_kg,static,trunk_twist,trunk_side,neck_side,arm_across_or_out,wrist_twist,legs_unsupported
30,15,50,80,10,5,1,1,1,1,1,1,1
0,5,0,80,0,0,0,0,0,0,0,0,0
"
    );
    let output = scored::<RulaWorksheet>(&own).unwrap();
    let own = rows(&output);
    let parts =
        ["s_upper_arm", "s_lower_arm", "s_wrist", "s_wrist_twist", "s_neck", "s_trunk", "s_legs"];
    assert_eq!(numbers(&own[0], &parts), [3.0, 2.0, 2.0, 2.0, 3.0, 5.0, 2.0]);
    // Tables A and B each add muscle use 1 and a static load of 5 kg 2.
    let totals = ["table_a", "score_a", "table_b", "score_b", "rula", "action_level"];
    assert_eq!(numbers(&own[0], &totals), [4.0, 7.0, 7.0, 10.0, 7.0, 4.0]);
    assert_eq!(numbers(&own[1], &totals), [1.0, 1.0, 1.0, 1.0, 1.0, 1.0]);

    let shared = format!(
        "{ANGLES},coupling,unilateral,trunk_twist_or_side,neck_twist_or_side,arm_abducted_or_rotated,\
         wrist_dev_or_twist,rapid_or_unstable,repeated,shock,load_kg
0,5,0,0,80,0,poor,1,1,1,1,1,1,1,0,2
"
    );
    let output = scored::<RulaWorksheet>(&shared).unwrap();
    let shared = rows(&output);
    assert_eq!(numbers(&shared[0], &parts), [2.0, 1.0, 2.0, 1.0, 2.0, 2.0, 2.0]);
    // Muscle use adds 1, and a repeated load of 2 kg adds 2.
    assert_eq!(numbers(&shared[0], &["table_a", "score_a"]), [3.0, 6.0]);
}

#[test]
fn the_dialect_of_a_spreadsheet_is_irrelevant() {
    let plain = format!("{ANGLES},coupling,shock\n10,20,30,40,50,-5.5,1,0\n");
    let expected = scored::<Worksheet>(&plain).unwrap();
    let last = |text: &str| {
        text.lines().last().unwrap().rsplit(',').take(15).map(str::to_owned).collect::<Vec<_>>()
    };
    for other in [
        plain.replace('\n', "\r\n"),
        format!("\u{feff}{plain}"),
        plain.trim_end().to_owned(),
        plain.replace('\n', "\n\n"),
        plain.replace("10,20", " 10 ,\"20.0\""),
        plain.replace(",1,0\n", ",Fair,\n"),
        plain.replace(",1,0\n", ",1.0,0.0\n"),
    ] {
        assert_eq!(last(&scored::<Worksheet>(&other).unwrap()), last(&expected), "{other:?}");
    }
    let header = scored::<Worksheet>(ANGLES).unwrap();
    assert!(header.starts_with(ANGLES) && header.lines().count() == 1);
}

/// The tables are as Excel writes them with decimal commas: semicolons, TRUE in its languages, rows
/// of empty cells, and the line that declares the separator.
#[test]
fn excel_tables_are_scored_like_plain_ones() {
    let plain = format!("{ANGLES},coupling,shock\n10.5,20,30,40,50,-5.5,1,1\n");
    let plain = scored::<Worksheet>(&plain).unwrap();
    let excel = format!("{ANGLES},coupling,shock").replace(',', ";");
    let rows = "10,5;20;30;40;50,0;-5,5;fair;";
    for truth in ["TRUE", "true", "WAHR", "VRAI", "1"] {
        for end in ["", "\r\n", "\r\n;;;;;;;\r\n;;; ;;;;\r\n"] {
            let table = format!("\u{feff}{excel}\r\n{rows}{truth}{end}");
            let found = scored::<Worksheet>(&table).unwrap();
            let scores = |text: &str| -> Vec<String> {
                text.lines().last().unwrap().rsplit(';').take(15).map(str::to_owned).collect()
            };
            let expected = plain.replace('.', "#").replace(',', ";").replace('#', ",");
            assert_eq!(scores(&found), scores(&expected), "{table:?}");
            assert_eq!(found.lines().count(), 2);
            let declared = table.replace('\u{feff}', "\u{feff}sep=;\r\n");
            let declared = scored::<Worksheet>(&declared).unwrap();
            assert_eq!(declared.strip_prefix("sep=;\n"), Some(found.as_str()));
        }
    }
    let tabs = format!("{ANGLES}\n10.5,20,30,40,50,-5.5\n").replace(',', "\t");
    let found = scored::<Worksheet>(&tabs).unwrap();
    let [tabs, commas] = [found, plain].map(|text| text.replace('\t', ","));
    assert!(
        tabs.lines().nth(1).unwrap().starts_with("10.5,20,30,40,50,-5.5,1,2,1,2,2,1,"),
        "{tabs}"
    );
    assert!(commas.lines().nth(1).unwrap().contains(",-5.5,1,1,1,2,1,2,2,1,"), "{commas}");
    // A comma separates cells if there are no semicolons.
    let comma = format!("{ANGLES}\n10,5,20,30,40,50,-5\n");
    assert!(matches!(scored::<Worksheet>(&comma), Err(Error::Table { line: Some(2), .. })));
}

#[test]
fn every_condition_of_a_sheet_has_a_column() {
    let reba = |columns: &str, cells: &str| {
        let table = format!("{ANGLES}{columns}\n{cells}\n");
        numbers(&rows(&scored::<Worksheet>(&table).unwrap())[0], &["s_legs", "s_upper_arm", "reba"])
    };
    // The person sits at a bench with a right knee angle.
    assert_eq!(reba("", "10,15,90,30,80,10"), [3.0, 2.0, 3.0]);
    assert_eq!(reba(",sitting", "10,15,90,30,80,10,1"), [1.0, 2.0, 1.0]);
    assert_eq!(reba(",sitting,unilateral", "10,15,90,30,80,10,1,1")[0], 1.0);
    assert_eq!(reba(",unilateral,sitting", "10,15,90,30,80,10,1,1")[0], 1.0);
    assert_eq!(reba(",sitting", "10,15,90,30,80,10,0")[0], 3.0);
    assert_eq!(reba(",arm_supported", "10,15,0,60,80,20,1")[1], 2.0);
}

#[test]
fn faults_are_named_with_line_and_column() {
    let rows =
        |rows: &str| format!("{ANGLES},load_kg,coupling,shock\n0,0,0,0,80,0,0,0,0\n{rows}\n");
    let cases = [
        (String::new(), "the table is empty"),
        ("\n\n".into(), "the table is empty"),
        (rows("x,0,0,0,0,0,0,0,0"), "line 3, column 1 (trunk_flex_deg): \"x\" is not possible"),
        (rows("0,NaN,0,0,0,0,0,0,0"), "line 3, column 2 (neck_flex_deg): \"NaN\""),
        (rows("0,0,inf,0,0,0,0,0,0"), "line 3, column 3 (knee_flex_deg): \"inf\""),
        (rows("0,0,0,,0,0,0,0,0"), "line 3, column 4 (upper_arm_flex_deg): \"\""),
        (rows("0,0,0,0,181,0,0,0,0"), "give an angle from -180 to 180 degrees"),
        (
            rows("0,0,0,0,0,0,-1,0,0"),
            "line 3, column 7 (load_kg): \"-1\" is not possible; give a load",
        ),
        (rows("0,0,0,0,0,0,1e9,0,0"), "from 0 to 1000 kg"),
        (rows("0,0,0,0,0,0,0,4,0"), "give one of 0 (good), 1 (fair), 2 (poor), 3 (unacceptable)"),
        (rows("0,0,0,0,0,0,0,great,0"), "line 3, column 8 (coupling): \"great\""),
        (rows("0,0,0,0,0,0,0,1.5,0"), "(coupling): \"1.5\""),
        (rows("0,0,0,0,0,0,0,-1,0"), "(coupling): \"-1\""),
        (
            rows("0,0,0,0,0,0,0,0,2"),
            "line 3, column 9 (shock): \"2\" is not possible; give 1 for yes",
        ),
        (rows("0,0,0,0,0,0,0,0,yes"), "(shock): \"yes\""),
        (rows("0,0,0,0,0,0,0,0"), "line 3: 8 cells where the header names 9"),
        (rows("0,5,0,0,0,0,0,0,0,0"), "line 3: 10 cells where the header names 9"),
        (rows("\n\n0,0,0,0,0,0,x,0,0"), "line 5, column 7"),
        (rows("x,0,0,0,0,0,0,0,0").replace('\n', "\r\n"), "line 3, column 1"),
        (format!("{ANGLES},knee_flex_deg\n"), "line 1, column 7: knee_flex_deg appears twice"),
        (
            format!("{ANGLES},schock\n"),
            "line 1, column 7: there is no column \"schock\"; do you mean shock?",
        ),
        (format!("{ANGLES},reba\n"), "\"reba\" is the name of a score"),
        (
            "trunk_flex_deg,shock\n0,0\n".into(),
            "line 1: missing columns: neck_flex_deg, knee_flex_deg",
        ),
        (format!("{ANGLES};shock\n"), "separate the cells by commas, by semicolons or by tabs"),
        (
            format!("{ANGLES},trunk_side\n"),
            "line 1, column 7: trunk_side is a column of RULA; here it is trunk_twist_or_side",
        ),
        (
            format!("{ANGLES},Arm across or out\n"),
            "column 7: arm_across_or_out is a column of RULA; this sheet does not ask for it",
        ),
        ("sep=;\n".into(), "the table is empty"),
        (
            format!("sep=;\n{}\n0;0;0;x;0;0\n", ANGLES.replace(',', ";")),
            "line 3, column 4 (upper_arm_flex_deg): \"x\"",
        ),
    ];
    for (table, says) in cases {
        let message = scored::<Worksheet>(&table).expect_err(&table).to_string();
        assert!(message.contains(says), "{table:?}: {message}");
    }
    let message = score::<Worksheet>(b"trunk_flex_deg\n\xff\xfe", &mut Vec::new());
    assert!(matches!(message, Err(Error::Table { line: Some(1), .. })));
    let mut latin = format!("{ANGLES}\n0,0,0,0,0,").into_bytes();
    latin.extend(b"\xe9\n");
    let message = score::<Worksheet>(&latin, &mut Vec::new()).unwrap_err().to_string();
    assert!(message.contains("line 2: not UTF-8"), "{message}");
}

#[test]
fn rows_before_a_fault_are_written() {
    let table = format!("{ANGLES}\n0,0,0,0,80,0\n1,2,3,4,5,x\n");
    let mut output = Vec::new();
    assert!(score::<Worksheet>(table.as_bytes(), &mut output).is_err());
    assert_eq!(String::from_utf8(output).unwrap().lines().count(), 2);
}

#[test]
fn the_callback_may_stop_the_scoring() {
    let table = format!("{ANGLES}\n0,0,0,0,80,0\n1,2,3,4,5,x\n");
    let mut table =
        SheetTable::<Worksheet, _>::new(table.as_bytes(), Unknown::PassThrough).unwrap();
    let mut output = Vec::new();
    assert!(table.score(&mut output, |_| ControlFlow::Break(())).unwrap().is_break());
    assert_eq!(String::from_utf8(output).unwrap().lines().count(), 2);
}

#[test]
fn names_that_are_nearly_right_are_refused_always() {
    for (name, known) in [
        ("trunk_flex_dg", "trunk_flex_deg"),
        ("Trunk Flex Deg", "trunk_flex_deg"),
        ("load_kgs", "load_kg"),
        ("coulping", "coupling"),
        ("repaeted", "repeated"),
        ("STATIC", "static"),
        ("shoulders_raise", "shoulder_raised"),
    ] {
        let table = format!("{ANGLES},{name}\n0,0,0,0,0,0,0\n");
        let says = format!("there is no column {name:?}; do you mean {known}?");
        let message = scored::<Worksheet>(&table).unwrap_err().to_string();
        assert!(message.contains(&says), "{message}");
    }
    for name in ["id", "time", "note", "weight", "subject", "x", ""] {
        let table = format!("{ANGLES},{name}\n0,0,0,0,0,0,0\n");
        assert!(scored::<Worksheet>(&table).is_ok(), "{name}");
    }
}

/// Generates cells that a column may contain.
fn cell(kind: Cell) -> BoxedStrategy<String> {
    match kind {
        Cell::Angle => (-180.0..180.0).prop_map(|x: f64| x.to_string()).boxed(),
        Cell::Load => (0.0..30.0).prop_map(|x: f64| x.to_string()).boxed(),
        Cell::Flag => (0..2_u8).prop_map(|x| x.to_string()).boxed(),
        Cell::Choice(words) => prop::sample::select(words).prop_map(str::to_owned).boxed(),
        Cell::Rating | Cell::Tally => (0..=5_u8).prop_map(|x| x.to_string()).boxed(),
        Cell::Name => "[a-z]{1,8}".boxed(),
    }
}

/// Generates a table of one row with every column, as names with cells. The second table has
/// another order, and leaves out the boxes that are not ticked.
fn table<S: Sheet>() -> impl Strategy<Value = [Vec<(String, String)>; 2]> {
    let named = |column: &Column<S>| (Just(column.name.to_owned()), cell(column.cell)).boxed();
    let columns: Vec<_> = S::COLUMNS.iter().map(named).collect();
    columns.prop_flat_map(|columns| {
        let needed =
            |name: &str, cell: &str| name.ends_with("_deg") || !matches!(cell, "0" | "good");
        let mut few = columns.clone();
        few.retain(|(name, cell)| needed(name, cell));
        Just(few).prop_shuffle().prop_map(move |few| [columns.clone(), few])
    })
}

fn text(columns: &[(String, String)]) -> String {
    let join = |of: fn(&(String, String)) -> &String| {
        columns.iter().map(of).cloned().collect::<Vec<_>>().join(",")
    };
    format!("{}\n{}\n", join(|column| &column.0), join(|column| &column.1))
}

/// Returns the scores of a table of one row, by name.
fn scores<S: Sheet>(columns: &[(String, String)]) -> Vec<String> {
    let output = scored::<S>(&text(columns)).unwrap();
    assert!(output.lines().nth(1).unwrap().starts_with(text(columns).lines().nth(1).unwrap()));
    let rows = rows(&output);
    S::SCORES.iter().map(|name| rows[0][name].to_owned()).collect()
}

proptest! {
    #[test]
    fn column_order_and_missing_boxes_are_irrelevant(
        [all, few] in table::<Worksheet>(), [rula_all, rula_few] in table::<RulaWorksheet>(),
    ) {
        prop_assert_eq!(scores::<Worksheet>(&all), scores::<Worksheet>(&few));
        prop_assert_eq!(scores::<RulaWorksheet>(&rula_all), scores::<RulaWorksheet>(&rula_few));
    }

    #[test]
    fn damaged_tables_are_scored_or_refused(
        at in 0..150_usize, cut in 0..8_usize, put in "[ 0-9a-z,.\"\\-\n\r]{0,6}",
    ) {
        let table = format!("{ANGLES},shock\n10,20,30,40,50,60,1\n\n-1,2.5,3,4,5,6,0\n");
        let (at, end) = (at.min(table.len()), (at + cut).min(table.len()));
        let table = format!("{}{put}{}", &table[..at], &table[end..]);
        match scored::<Worksheet>(&table) {
            // Line ends within quotes make fewer rows, never more.
            Ok(output) => prop_assert!(output.lines().count() <= table.split(['\n', '\r']).count()),
            Err(error) => {
                let message = error.to_string();
                let placed = message.starts_with("line ") || message.starts_with("the table is empty");
                prop_assert!(placed, "{message}");
            }
        }
    }
}
