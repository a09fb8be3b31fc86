//! The program that scores tables of REBA and RULA sheets.

use std::ops::ControlFlow;

use ergo_map::{RulaWorksheet, Worksheet};
use ergo_report::sheets::{Sheet, SheetTable, Unknown};

use crate::support::Runs;

const ANGLES: &str = "trunk_flex_deg,neck_flex_deg,knee_flex_deg,upper_arm_flex_deg,\
                      lower_arm_flex_deg,wrist_flex_deg";

/// The library's result for a table.
fn scored<S: Sheet>(table: &str) -> String {
    let mut table = SheetTable::<S, _>::new(table.as_bytes(), Unknown::PassThrough).unwrap();
    let mut output = Vec::new();
    let _ = table.score(&mut output, |_| ControlFlow::Continue(())).unwrap();
    String::from_utf8(output).unwrap()
}

/// A sheet in a table with columns for the laboratory's own identifier and remark.
const WITH_ID: &str = "id,trunk_flex_deg,neck_flex_deg,knee_flex_deg,upper_arm_flex_deg,\
                       lower_arm_flex_deg,wrist_flex_deg,Remark\n\
                       7, 30,0,0,0,80,0,\"lifts, then turns\"\n";

#[test]
fn unknown_columns_are_passed_through_unchanged() {
    let ran = Runs::new("reba").with(&["--input", "-"]).run_on(WITH_ID).done();
    let (header, row) = ran.output.split_once('\n').unwrap();
    assert!(header.starts_with("id,trunk_flex_deg,") && header.contains(",Remark,s_neck,"));
    assert!(row.starts_with("7, 30,0,0,0,80,0,\"lifts, then turns\",1,"), "{row}");
    assert_eq!(ran.errors, "standard input: passed through unchanged: id, Remark\n");
    let quiet = Runs::new("reba").with(&["--input", "-", "--quiet"]).run_on(WITH_ID).done();
    assert_eq!((quiet.output, quiet.errors.as_str()), (ran.output, ""));
    let strict = Runs::new("reba").with(&["--input", "-", "--strict"]).run_on(WITH_ID);
    strict
        .failed(1, "standard input: line 1, column 1: there is no column \"id\"; there are trunk");
}

/// This cell would take half a gigabyte to read and to show.
#[test]
fn huge_cell_is_refused_before_reading() {
    let reba = |table: &str| Runs::within("reba", 200).with(&["--input", "-"]).run_on(table);
    let huge = "9".repeat(200 << 20);
    let cell = format!("{ANGLES}\n0,0,0,0,0,{huge}\n");
    reba(&cell).failed(1, "standard input: line 2: a row of more than 1048576 bytes");
    let open = format!("{ANGLES}\n\"{}", "9,9\n".repeat(1 << 20));
    reba(&open).failed(1, "a row of more than 1048576 bytes; is a quotation mark open?");
    reba(&huge).failed(1, "line 1: a row of more than 1048576 bytes");
    // An accepted long cell is not shown in full.
    let long = format!("{ANGLES}\n0,0,0,0,0,{}\n", &huge[..500_000]);
    let ran = reba(&long).failed(1, "line 2, column 6 (wrist_flex_deg): \"999");
    assert!(ran.errors.len() < 300 && ran.errors.contains("(500000 bytes)"), "{ran:?}");
    let names = format!("{ANGLES}{}\n", ",n".repeat(400_000));
    reba(&names).failed(1, "line 1: 400006 columns; a table has at most 1000");
}

#[test]
fn the_program_reads_files_and_standard_input() {
    let table = format!("shock,{ANGLES}\n1,30,0,0,0,80,0\n");
    let folder = tempfile::tempdir().unwrap();
    let path = |name| folder.path().join(name).to_str().unwrap().to_owned();
    std::fs::write(path("in.csv"), format!("\u{feff}{table}")).unwrap();
    let (input, output) = (path("in.csv"), path("out.csv"));
    let reba = |arguments: &[&str]| Runs::new("reba").with(arguments);
    let expected = scored::<Worksheet>(&table);
    assert_eq!(reba(&["--input", &input]).run().done().output, expected);
    assert_eq!(reba(&["--input", "-"]).run_on(&table).done().output, expected);
    let rula = reba(&["--rula", "--input", "-"]).run_on(&table).done().output;
    assert_eq!(rula, scored::<RulaWorksheet>(&table));

    let ran = reba(&["--input", &input, "--output", &output, "--json"]).run().done();
    assert_eq!(ran.output.trim_end(), "{\"rows\":1,\"passed_through\":[],\"partial\":false}");
    assert_eq!(std::fs::read_to_string(&output).unwrap(), expected);
    // A refused table leaves the previous output as it was.
    let bad = format!("{ANGLES}\n1,2,3,4,5,much\n");
    reba(&["--input", "-", "--output", &output]).run_on(&bad).failed(1, "much");
    assert_eq!(std::fs::read_to_string(&output).unwrap(), expected);
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2);
}

#[test]
fn the_program_says_what_is_wrong() {
    let bad = format!("{ANGLES}\n1,2,3,4,5,much\n");
    for (arguments, input, code, says) in [
        (&["--input", "/not/there.csv"][..], "", 1, "/not/there.csv"),
        (&["--input", "-"], bad.as_str(), 1, "line 2, column 6 (wrist_flex_deg): \"much\""),
        (&["--input", "-"], "", 1, "standard input: the table is empty"),
        (&["--input", "/"], "", 1, "/: line 1: cannot read on"),
        (&[], "", 2, "--input"),
    ] {
        Runs::new("reba").with(arguments).run_on(input).failed(code, says);
    }
}
