//! The program `ergo_map`.

use std::fmt::Write;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use ergo_map::{ErgonomicsMap, FitOptions, JointAngles};
use ergo_report::maps::ACCEPTABLE;
use serde_json::Value;

use crate::support::{coarse_map, coarse_map_file};

fn ergo_map(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_ergo_map")).args(arguments).output().unwrap()
}

fn made(folder: &Path, arguments: &[&str]) -> String {
    let output = ergo_map(&[arguments, &["--output", folder.to_str().unwrap()]].concat());
    assert!(output.status.success(), "{arguments:?}: {output:?}");
    String::from_utf8(output.stdout).unwrap()
}

fn read(folder: &Path, name: &str) -> String {
    fs::read_to_string(folder.join(name)).unwrap()
}

fn report(folder: &Path) -> Value {
    serde_json::from_str(&read(folder, "report.json")).unwrap()
}

fn near(value: &Value, expected: f64) -> bool {
    (value.as_f64().unwrap() - expected).abs() <= 1e-12 * expected.abs().max(1.0)
}

/// Asserts that this is a complete picture with these texts. The tests of `ergo-report` check the drawing.
fn assert_is_picture(svg: &str, texts: &[&str]) {
    assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>"));
    for text in texts {
        assert!(svg.contains(text), "no {text:?}");
    }
}

#[test]
fn map_report_and_pictures_are_written() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let shown = made(folder, &["--stature=1.75", "--spacing=0.1", "--hand-at", "0.5,-0.2,0.8"]);

    let map = ErgonomicsMap::load(folder.join("person.ergomap")).unwrap();
    // Bytes are compared, since unreachable nodes hold NaN.
    assert!(map.to_bytes() == coarse_map().to_bytes());
    let (quadratic, fit) = map.fit(&FitOptions::default()).unwrap();
    let regret = fit.regret.unwrap();
    let json = report(folder);
    for (value, expected) in [
        (&json["stature_m"], 1.75),
        (&json["map"]["nodes"], map.len() as f64),
        (&json["quadratic"]["hessian_per_m2"][0][2], quadratic.hessian()[(0, 2)]),
        (&json["quadratic"]["gradient_per_m"][1], quadratic.gradient()[1]),
        (&json["quadratic"]["constant"], quadratic.constant()),
        (&json["quadratic"]["eigenvalues_per_m2"][0], fit.eigenvalues[0]),
        (&json["fit"]["samples"], fit.samples as f64),
        (&json["fit"]["domain_max_m"][2], fit.domain.max().z),
        (&json["fit"]["r_squared"], fit.r_squared),
        (&json["fit"]["weighted_r_squared"], fit.weighted_r_squared),
        (&json["fit"]["rmse"], fit.rmse),
        (&json["fit"]["max_error"], fit.max_error),
        (&json["fit"]["spearman"], fit.spearman),
        (&json["fit"]["optimum_m"][0], fit.optimum.x),
        (&json["regret"]["at_optimum"], regret.at_optimum),
        (&json["regret"]["boxes_p95"], regret.boxes_p95),
        (&json["regret"]["boxes_max"], regret.boxes_max),
        (&json["optimum"]["e_s"], map.sample(&fit.optimum).unwrap().score),
        (&json["acceptable"]["e_s_up_to"], ACCEPTABLE),
    ] {
        assert!(near(value, expected), "{value} {expected}");
    }
    assert_eq!(json["quadratic"]["bound_active"], Value::Bool(fit.bound_active));
    let text = read(folder, "report.txt");
    assert!(shown.starts_with(&text));
    for figure in [fit.r_squared, fit.weighted_r_squared, fit.rmse, fit.max_error, fit.spearman] {
        assert!(text.contains(&format!("{figure:.4}")), "{figure}: {text}");
    }

    let parts = ["neck", "upper arm", "table A", "table B", "REBA", "RULA", "centre of mass"];
    assert_is_picture(&read(folder, "manikin.svg"), &parts);
    assert_is_picture(&read(folder, "manikin-at.svg"), &["Right hand at (0.50, -0.20, 0.80) m"]);
    let axes = ["x, forward (m)", "y, left (m)", "z, up (m)", "score e_s", "acceptable"];
    let picture = read(folder, "slices.svg");
    assert_is_picture(&picture, &axes);
    assert!(picture.len() < 1_000_000, "{} bytes", picture.len());
}

#[test]
fn saved_map_is_shown_as_when_made() {
    let (first, second) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let lengths = ["--segments", "upper_arm=0.36,forearm=0.26"];
    let person = ["--preset=short", "--hand=left", "--spacing=0.1"];
    made(first.path(), &[&person[..], &lengths].concat());
    let file = first.path().join("person.ergomap");
    made(second.path(), &["--load", file.to_str().unwrap()]);
    for name in ["report.txt", "report.json", "slices.svg", "manikin.svg"] {
        assert_eq!(read(first.path(), name), read(second.path(), name), "{name}");
    }
    assert!(!second.path().join("person.ergomap").exists());
    assert_eq!(report(second.path())["hand"], "left");
    // The measured arm counts: the hand is where the map says.
    let drawn = read(second.path(), "manikin.svg");
    assert!(drawn.contains("Left hand at") && drawn.contains("from the left"));
}

/// Recorded postures: those of a person's map.
fn recording(map: &ErgonomicsMap) -> String {
    let names = JointAngles::NAMES.map(|name| format!("{name}_deg")).join(",");
    let mut table = format!("hand_x_m,hand_y_m,hand_z_m,{names}\n");
    for node in map.nodes() {
        let [x, y, z]: [f64; 3] = node.position.into();
        write!(table, "{x},{y},{z}").unwrap();
        for angle in node.angles.to_array() {
            write!(table, ",{}", angle.to_degrees()).unwrap();
        }
        table.push('\n');
    }
    table
}

#[test]
fn recordings_make_a_map_and_judge_one() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let file = folder.join("recorded.csv");
    fs::write(&file, recording(coarse_map())).unwrap();
    let file = file.to_str().unwrap();
    let samples = ["--preset=average", "--spacing=0.1", "--samples", file, "--validate", file];
    let shown = made(folder, &samples);
    let map = ErgonomicsMap::load(folder.join("person.ergomap")).unwrap();
    assert!(map.len() > 100);
    let json = report(folder);
    assert!(json["validation"]["samples"].as_u64().unwrap() > 100);
    assert!(json["validation"]["spearman"].as_f64().unwrap() > 0.9);
    assert!(shown.contains("recordings: compared, outside"));
}

#[test]
fn wrong_options_are_named_and_leave_nothing_behind() {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("made");
    let output = output.to_str().unwrap();
    let text = folder.path().join("text.ergomap");
    fs::write(&text, "hello").unwrap();
    let text = text.to_str().unwrap();
    let cases: [(&[&str], &str); 16] = [
        (&[], "--stature"),
        (&["--stature=175"], "stature is 175 m: it must lie in [0.5, 2.7] m"),
        (&["--stature=1.7", "--preset=tall"], "cannot be used with"),
        (&["--preset=huge"], "short, average, tall"),
        (&["--preset=tall", "--hand=both"], "left, right"),
        (&["--preset=tall", "--spacing=2"], "spacing is 2 statures"),
        (
            &["--preset=tall", "--segments=upperarm=0.3"],
            "there is no segment \"upperarm\"; there are",
        ),
        (&["--preset=tall", "--segments=grip=abc"], "\"abc\" is no number"),
        (&["--preset=tall", "--segments=upper_arm=3"], "upper_arm is 3 m: it must lie in"),
        (&["--preset=tall", "--hand-at=1,2"], "give three numbers"),
        (&["--load", coarse_map_file(), "--hand-at=3,0,1"], "(3.000, 0.000, 1.000) m is outside"),
        (&["--load", coarse_map_file(), "--acceptable=0"], "acceptable = 0: give a score"),
        (&["--preset=tall", "--samples=/not/there.csv"], "cannot open /not/there.csv"),
        (&["--load=/not/there.ergomap"], "/not/there.ergomap"),
        (&["--load", text], "not a usable ergonomics map"),
        (&["--load=/dev/zero"], "does not start with the mark of a map file"),
    ];
    for (arguments, says) in cases {
        let result = ergo_map(&[arguments, &["--output", output]].concat());
        let errors = String::from_utf8_lossy(&result.stderr);
        assert!(!result.status.success() && errors.contains(says), "{arguments:?}: {errors}");
        assert!(!Path::new(output).exists(), "{arguments:?}");
    }
    assert!(!ergo_map(&["--preset=tall"]).status.success());
}
