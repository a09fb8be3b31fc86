//! The program `ergo_map` and the pictures that it draws.

use std::fmt::Write;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use ergo_map::{ErgonomicsMap, FitOptions, JointAngles, MapOptions, Person, Region, Side};
use examples::ergonomics::{ACCEPTABLE, Assessment, ErgonomicsError, MapStudy, manikin, slices};
use nalgebra::Vector3;
use proptest::prelude::*;
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

/// A picture's width and height.
fn size(svg: &str) -> (f64, f64) {
    let number = |name: &str| {
        let (_, rest) = svg.split_once(&format!(" {name}=\"")).unwrap();
        rest.split('"').next().unwrap().parse().unwrap()
    };
    (number("width"), number("height"))
}

/// Every pair of coordinates of lines and areas.
fn points(svg: &str) -> Vec<(f64, f64)> {
    let lists = svg.split(" points=\"").skip(1).map(|rest| rest.split('"').next().unwrap());
    let pairs = lists.flat_map(str::split_whitespace).map(|pair| pair.split_once(',').unwrap());
    pairs.map(|(x, y)| (x.parse().unwrap(), y.parse().unwrap())).collect()
}

fn assert_is_picture(svg: &str, texts: &[&str]) {
    assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>"));
    assert!(!svg.contains("NaN") && !svg.contains("inf"));
    let (width, height) = size(svg);
    let points = points(svg);
    assert!(points.len() > 200);
    for (x, y) in points {
        assert!((0.0..=width).contains(&x) && (0.0..=height).contains(&y), "{x}, {y}");
    }
    for text in texts {
        assert!(svg.contains(text), "no {text:?}");
    }
}

#[test]
fn a_map_its_report_and_its_pictures_are_written() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let shown = made(folder, &["--stature=1.75", "--spacing=0.1", "--hand-at", "0.5,-0.2,0.8"]);

    let map = ErgonomicsMap::load(folder.join("person.ergomap")).unwrap();
    // As bytes: unreachable nodes hold NaN.
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
fn a_saved_map_is_shown_as_when_it_was_made() {
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

/// Recorded postures: those that the map of a person holds.
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

#[test]
fn studies_refuse_what_makes_no_sense() {
    let map = coarse_map();
    for threshold in [0.0, -1.0, 5.0, f64::NAN, f64::INFINITY] {
        let study = MapStudy::new(map.clone(), Person::average(), threshold);
        assert!(matches!(study, Err(ErgonomicsError::Acceptable(_))));
    }
    let outside = Assessment::new(map, &Person::average(), &Vector3::new(9.0, 0.0, 1.0));
    assert!(matches!(outside, Err(ErgonomicsError::OutsideMap { .. })));
}

#[test]
fn what_the_book_says_of_the_work_zone_holds() {
    for side in [Side::Left, Side::Right] {
        let person = Person::average();
        let zone = Region::work_zone(person.stature(), side);
        let options = MapOptions { side, region: Some(zone), ..MapOptions::default() };
        let map = ErgonomicsMap::build(&person, &options, None).unwrap();
        for index in 0..1000_u32 {
            let share = [index / 100, index / 10 % 10, index % 10].map(|k| f64::from(k) / 9.0);
            let hand = zone.min() + zone.size().component_mul(&Vector3::from(share));
            if let Ok(assessment) = Assessment::new(&map, &person, &hand) {
                assert!((assessment.landmarks.hand - hand).norm() < 0.02, "{hand}");
            }
        }
        let study = MapStudy::new(map, person, ACCEPTABLE).unwrap();
        assert!(study.acceptable.highest_reba.is_some_and(|reba| reba <= 3));
    }
}

#[test]
fn the_acceptable_region_grows_with_its_threshold() {
    let map = coarse_map();
    let shares = [0.05, 0.5, 1.0, 4.25].map(|threshold| {
        MapStudy::new(map.clone(), Person::average(), threshold).unwrap().acceptable.share
    });
    assert!(shares.is_sorted() && shares[0] < shares[2] && shares[3] == 1.0, "{shares:?}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(6))]

    /// Pictures of any person hold everything within their frame, wherever the hand is.
    #[test]
    fn everyone_can_be_drawn(stature in 1.2..2.2_f64, left in any::<bool>(), at in any::<prop::sample::Index>()) {
        let side = if left { Side::Left } else { Side::Right };
        let person = Person::new(stature).unwrap();
        let options = MapOptions { spacing: 0.16, side, ..MapOptions::default() };
        let map = ErgonomicsMap::build(&person, &options, None).unwrap();
        let nodes: Vec<_> = map.nodes().filter(|node| map.contains(&node.position)).collect();
        let hand = nodes[at.index(nodes.len())].position;
        let drawn = manikin(&Assessment::new(&map, &person, &hand).unwrap(), &person, side).unwrap();
        assert_is_picture(&drawn, &[if left { "from the left" } else { "from the right" }]);
        if let Ok(study) = MapStudy::new(map, person, ACCEPTABLE) {
            assert_is_picture(&slices(&study).unwrap(), &["sagittal slice"]);
        }
    }
}
