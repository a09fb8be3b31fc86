//! The names on the book's pages of guarantees exist, and its numbers are those of the code.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, missing_docs)]

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use hrsw_safety::Supervisor;
use moca_model::ControllerSettings;
use moca_model::whole_body::control_loop::LoopSettings;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

fn page(name: &str) -> String {
    fs::read_to_string(root().join("docs/src").join(name)).unwrap()
}

/// Source files of the workspace, with its scripts.
fn sources() -> Vec<PathBuf> {
    let mut folders: Vec<_> =
        ["ahqp-core", "ergo-map", "hrsw", "vision-models", "moca-model", "examples", ".ci"]
            .map(|name| root().join(name))
            .into();
    let mut files = Vec::new();
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).unwrap().map(Result::unwrap) {
            let path = entry.path();
            let name = entry.file_name().into_string().unwrap();
            let extension = path.extension().unwrap_or_default().to_string_lossy().into_owned();
            if path.is_dir() && name != "target" && name != "node_modules" {
                folders.push(path);
            } else if ["rs", "py", "cpp", "c", "h", "toml"].contains(&&*extension)
                && name != "guarantees.rs"
            {
                files.push(path);
            }
        }
    }
    files
}

/// The texts between backticks.
fn quoted(text: &str) -> BTreeSet<&str> {
    text.lines().flat_map(|line| line.split('`').skip(1).step_by(2)).collect()
}

fn words(text: &str) -> impl Iterator<Item = &str> {
    text.split(|c: char| !(c.is_alphanumeric() || c == '_')).filter(|word| !word.is_empty())
}

/// The name of the function that a line of Rust, Python or C++ defines, if it defines one.
fn functions(line: &str) -> Option<&str> {
    let line = line.trim_start();
    let ["fn" | "def" | "void" | "int" | "bool", name] =
        words(line).filter(|word| *word != "pub" && *word != "static").take(2).collect::<Vec<_>>()
            [..]
    else {
        return None;
    };
    Some(name)
}

#[test]
fn every_name_on_the_pages_exists() {
    let text = page("guarantees.md") + &page("guarantee-tests.md");
    let sources: Vec<_> =
        sources().into_iter().filter_map(|file| fs::read_to_string(file).ok()).collect();
    let defined: BTreeSet<_> =
        sources.iter().flat_map(|text| text.lines()).filter_map(functions).collect();
    let known: BTreeSet<_> = sources.iter().flat_map(|text| words(text)).collect();
    let mut tests = 0;
    // Environment settings are not names.
    for name in quoted(&text).into_iter().filter(|name| !name.contains('=')) {
        if defined.contains(name) {
            tests += 1;
        } else if name.contains('/') && !name.contains(' ') {
            let places = [root(), root().join("ahqp-core"), root().join("vision-models")];
            assert!(places.iter().any(|place| place.join(name).exists()), "`{name}` is no file");
        } else {
            let unknown = words(name)
                .filter(|word| word.parse::<f64>().is_err())
                .find(|word| !known.contains(word));
            assert_eq!(unknown, None, "in `{name}`");
        }
    }
    assert!(tests > 200, "the pages name {tests} tests");
}

/// Numbers as the book writes them.
#[test]
fn thresholds_are_those_of_the_defaults() {
    let settings = ControllerSettings::default();
    let safety = settings.safety;
    let supervisor = safety.supervisor;
    let separation = safety.separation;
    let limits = LoopSettings::default();
    let unknown =
        separation.human_uncertainty + separation.intrusion + separation.robot_uncertainty;
    let (guarantees, model) = (page("guarantees.md"), page("moca-model.md"));
    for (text, number) in [
        ("no plausible frame for {} s, a fault of the loop", supervisor.reduced_age),
        ("no plausible frame for {} s, a fault, a contact force", supervisor.stop_age),
        ("the robot slows down after {} s and stops", supervisor.reduced_age),
        ("and stops after {} s without one", supervisor.stop_age),
        ("noticed only at {} N at the tool", supervisor.contact_force),
        ("a clamping is noticed at {} N at the tool", supervisor.contact_force),
        ("at most {} m/s as measured", safety.contact_speed),
        ("nearer than {} m plus the uncertainty of its speed times its age", unknown),
        ("where none is measured at {} m/s", separation.human_speed),
        ("After {} s the loop halts the robot", limits.blind_within),
    ] {
        let text = text.replace("{}", &number.to_string());
        assert!(guarantees.replace('\n', " ").replace("  ", " ").contains(&text), "{text}");
    }
    for (text, number) in [
        ("no plausible frame for {} s; a fault | at once | half", supervisor.reduced_age),
        ("no plausible frame for {} s; a fault | at once | stands", supervisor.stop_age),
        ("leaves at {} of its speeds", Supervisor::RETREAT_SCALE),
        ("there have been {} m more room", Supervisor::HYSTERESIS),
        ("the cause has been gone for {} s |", Supervisor::DWELL),
        ("nearer than {} m plus the uncertainty of its speed times its age", unknown),
    ] {
        let text = text.replace("{}", &number.to_string());
        assert!(model.contains(&text), "{text}");
    }
}
