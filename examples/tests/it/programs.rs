//! Common behaviour of all programs: closed and full outputs, interrupts, wrong places for results, and messages.

use std::fs;
use std::io::Write;
use std::path::Path;

use crate::support::{Ran, Runs, SmallDisk, coarse_map_file, signal, small_frames};

/// A set of problems and a table of sheets, for programs that read one.
struct Inputs {
    folder: tempfile::TempDir,
}

const SET: &str = "hqpset x 1\nproblem 0 p 1 1\nlevel G 0 1\n1 4 4\n";
const SHEETS: &str = "trunk_flex_deg,neck_flex_deg,knee_flex_deg,upper_arm_flex_deg,\
                      lower_arm_flex_deg,wrist_flex_deg\n0,0,0,0,80,0\n";
const ANSWERS: &str = "subject,temporal_demand,mental_demand,effort,physical_demand,performance,\
                       frustration\nS,1,2,3,4,5,6\n";

impl Inputs {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("set.hqp"), SET).unwrap();
        fs::write(folder.path().join("sheets.csv"), SHEETS).unwrap();
        fs::write(folder.path().join("answers.csv"), ANSWERS).unwrap();
        Self { folder }
    }

    fn path(&self, name: &str) -> String {
        self.folder.path().join(name).to_str().unwrap().to_owned()
    }

    /// Each program with options that let it print something soon.
    fn programs(&self) -> Vec<Runs> {
        let path = |name| self.path(name);
        vec![
            Runs::new("record").with(&["--duration=1", "--output", &path("r.jsonl")]),
            Runs::follow().with(&["--recording", &self.recording(), "--no-report"]),
            Runs::new("soak").with(&["--ticks=200"]),
            Runs::new("hqp").with(&[path("set.hqp")]),
            Runs::new("reba").with(&["--input", &path("sheets.csv")]),
            Runs::new("ergo_map").with(&["--load", coarse_map_file(), "-o", &path("map")]),
            Runs::new("tlx").with(&["--input", &path("answers.csv")]),
            perceive(&path("p.jsonl")),
        ]
    }

    /// A recording of a second.
    fn recording(&self) -> String {
        let path = self.path("short.jsonl");
        Runs::new("record").with(&["--duration=1", "--output", &path]).run().done();
        path
    }
}

/// `perceive` with some small frames.
fn perceive(output: &str) -> Runs {
    let frames = small_frames();
    let skeletons = format!("{frames}/skeletons");
    Runs::new("perceive").with(&[frames, "--skeletons", &skeletons, "--output", output])
}

const PROGRAMS: [&str; 8] =
    ["record", "follow", "soak", "hqp", "reba", "ergo_map", "tlx", "perceive"];

#[test]
fn a_closed_output_ends_every_program_quietly() {
    for program in Inputs::new().programs() {
        let ran = program.run_closed();
        assert_eq!((ran.code(), ran.errors.contains("error")), (Some(141), false), "{ran:?}");
    }
    for name in PROGRAMS {
        let ran = Runs::new(name).with(&["--help"]).run_closed();
        assert_eq!((ran.code(), ran.errors.as_str()), (Some(141), ""), "{name}");
    }
}

#[test]
fn full_output_has_its_own_exit_status() {
    let says = "cannot write to standard output: No space left on device";
    for program in Inputs::new().programs() {
        program.run_full().failed(74, says);
    }
    for name in PROGRAMS {
        Runs::new(name).with(&["--help"]).run_full().failed(74, says);
    }
    // A full standard error does not matter either.
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("r.jsonl");
    let record = ["--duration=1", "--output", output.to_str().unwrap()];
    assert_eq!(Runs::new("record").with(&record).code_with_full_errors(), Some(0));
    assert_eq!(Runs::new("record").code_with_full_errors(), Some(2));
    assert_eq!(Runs::new("hqp").with(&["/nope"]).code_with_full_errors(), Some(1));
}

#[test]
fn closed_output_loses_no_files() {
    let inputs = Inputs::new();
    let report = inputs.path("report");
    let ran =
        Runs::follow().with(&["--recording", &inputs.recording(), "-o", &report]).run_closed();
    assert_eq!(ran.code(), Some(141));
    let whole = [
        "follow.html",
        "follow.svg",
        "scene-moving.svg",
        "scene.svg",
        "ticks-off.csv",
        "ticks-on.csv",
    ];
    assert_eq!(names(Path::new(&report)), whole);
}

#[test]
fn help_describes_each_program_and_its_status() {
    for (name, does) in [
        ("record", "Simulates a person"),
        ("follow", "Lets the simulated robot MOCA follow a recorded person"),
        ("soak", "Tries the controller on random people"),
        ("hqp", "Solves a set of hierarchical quadratic problems"),
        ("reba", "Scores filled-in REBA sheets"),
        ("tlx", "Scores NASA-TLX questionnaires"),
        ("perceive", "Makes a recording, as `follow` plays it, of a folder of camera frames"),
        ("merge", "Merges the files that a program wrote with --shard I/N"),
        ("calibrate", "Finds where a camera stands"),
        ("ergo_map", "Builds the ergonomics map of a person: how"),
    ] {
        let help = Runs::new(name).with(&["--help"]).run().done().output;
        assert!(help.starts_with(does), "{name}: {help}");
        for part in ["--json", "--quiet", "Exit status: 0 done"] {
            assert!(help.contains(part), "{name}: {part}");
        }
        Runs::new(name).with(&["--nonsense"]).run().failed(2, "--nonsense");
    }
}

/// No user can write in these places: below a file, in a folder that does not exist, where a folder is, and in a kernel
/// file system.
#[test]
fn unwritable_places_are_refused_before_the_work() {
    let inputs = Inputs::new();
    let (set, sheets) = (inputs.path("set.hqp"), inputs.path("sheets.csv"));
    let below = format!("{set}/out");
    let before = names(inputs.folder.path());
    for (place, says) in [
        (below.as_str(), "set.hqp"),
        ("/no/such/folder/out", "there is no folder /no/such/folder"),
        (inputs.folder.path().to_str().unwrap(), "it is a folder"),
        ("/proc/out", "cannot write /proc/out"),
    ] {
        // The work would be an hour of recording and many solves. The error comes before.
        let record = Runs::new("record").with(&["--duration=3600", "--output", place]);
        let hqp = Runs::new("hqp").with(&[&set, "--repeat=4000000000", "--output", place]);
        let reba = Runs::new("reba").with(&["--input", &sheets, "--output", place]);
        for program in [record, hqp, reba, perceive(place)] {
            program.run().failed(1, says);
        }
    }
    for (place, says) in [
        (set.as_str(), "it is a file; give a folder"),
        (&below, "it is a file; give a folder"),
        ("/proc/out", "cannot write /proc/out"),
    ] {
        let map = Runs::new("ergo_map").with(&["--preset=tall", "--spacing=0.011", "-o", place]);
        let follow = Runs::new("follow").with(&["--report", place]);
        for program in [map, follow] {
            program.run().failed(1, says);
        }
    }
    assert_eq!(names(inputs.folder.path()), before);
    assert_eq!(fs::read_to_string(set).unwrap(), SET);
}

#[test]
fn a_full_disk_leaves_no_half_file() {
    let Some(disk) = SmallDisk::new(64) else { return };
    let path = |name: &str| disk.path().join(name).to_str().unwrap().to_owned();
    fs::write(path("old.jsonl"), "as it was\n").unwrap();
    let full = "No space left on device";
    for (program, file) in [
        (perceive(&path("old.jsonl")), "old.jsonl"),
        (Runs::new("record").with(&["--output", &path("old.jsonl")]), "old.jsonl"),
        (Runs::follow().with(&["--output", disk.path().to_str().unwrap()]), "ticks-on.csv"),
        (
            Runs::new("ergo_map").with(&[
                "--preset=tall",
                "--spacing=0.1",
                "-o",
                disk.path().to_str().unwrap(),
            ]),
            "person.ergomap",
        ),
    ] {
        let ran = program.run().failed(1, full);
        assert!(ran.errors.contains(file), "{ran:?}");
    }
    assert_eq!(names(disk.path()), ["old.jsonl"]);
    assert_eq!(fs::read_to_string(path("old.jsonl")).unwrap(), "as it was\n");
}

#[test]
fn a_second_signal_ends_a_program_at_once() {
    let mut child = Runs::new("soak").with(&["--ticks=1000000000"]).start();
    wait_for_line(&mut child);
    signal(&child, "STOP");
    // Both signals arrive before the program can see the first.
    signal(&child, "INT");
    signal(&child, "TERM");
    signal(&child, "CONT");
    let ran = Ran::of(child);
    assert!(matches!(ran.code(), Some(130 | 143)), "{ran:?}");
    assert_eq!(ran.output, "");
}

#[test]
fn interrupted_soak_prints_its_counts_so_far() {
    for (name, code) in [("INT", 130), ("TERM", 143)] {
        let soak = Runs::new("soak").with(&["--ticks=1000000000", "--json"]);
        let ran = soak.interrupt_at("soak: ", name);
        assert_eq!(ran.code(), Some(code), "{ran:?}");
        let json = ran.json();
        assert_eq!(json["partial"], true);
        let ticks = json["ticks"].as_u64().unwrap();
        assert!(ticks > 0 && ticks < 1_000_000_000 && ticks.is_multiple_of(1000), "{ticks}");
        assert!(ran.output.starts_with("ticks "), "{ran:?}");
        assert!(ran.errors.contains(&format!("interrupted after {ticks} of 1000000000 ticks")));
    }
}

#[test]
fn interrupted_follow_keeps_partial_files() {
    let inputs = Inputs::new();
    let (recording, report) = (inputs.path("long.jsonl"), inputs.path("report"));
    Runs::new("record").with(&["--duration=200", "--output", &recording]).run().done();
    let follow = Runs::follow().with(&["--recording", &recording, "--json", "-o", &report]);
    let ran = follow.interrupt_at("Ergonomics on: ", "INT");
    assert_eq!(ran.code(), Some(130), "{ran:?}");
    let json = ran.json();
    assert_eq!(
        (&json["partial"], &json["score_mean_off"]),
        (&true.into(), &serde_json::Value::Null)
    );
    assert!(json["duration_s"].as_f64().is_some_and(|seconds| seconds > 1.0 && seconds < 200.0));
    let report = Path::new(&report);
    let partial = [
        "follow.partial.html",
        "follow.partial.svg",
        "scene-moving.partial.svg",
        "scene.partial.svg",
        "ticks-on.partial.csv",
    ];
    assert_eq!(names(report), partial);
    let ticks = fs::read_to_string(report.join("ticks-on.partial.csv")).unwrap();
    assert!(ticks.lines().count() > 1000 && ticks.ends_with('\n'));
}

#[test]
fn a_map_that_is_interrupted_leaves_nothing() {
    let inputs = Inputs::new();
    let map = inputs.path("map");
    let ergo_map = Runs::new("ergo_map").with(&["--preset=tall", "--spacing=0.011", "-o", &map]);
    let ran = ergo_map.interrupt_at("map of the person: ", "INT");
    assert_eq!(ran.code(), Some(130), "{ran:?}");
    assert!(ran.errors.contains("interrupted") && ran.output.is_empty());
    assert!(!Path::new(&map).exists());
}

#[test]
fn interrupted_set_prints_its_results_so_far() {
    let inputs = Inputs::new();
    let (set, output) = (inputs.path("set.hqp"), inputs.path("x.txt"));
    let hqp = Runs::new("hqp").with(&[&set, "--repeat=4000000000", "--json", "-o", &output]);
    let ran = hqp.interrupt_at("solving: ", "INT");
    assert_eq!(ran.code(), Some(130), "{ran:?}");
    assert_eq!((&ran.json()["partial"], &ran.json()["solved"]), (&true.into(), &1.into()));
    assert!(!Path::new(&output).exists());
    let kept = fs::read_to_string(inputs.path("x.partial.txt")).unwrap();
    assert_eq!(kept.split(' ').take(2).collect::<Vec<_>>(), ["0", "0"]);
}

/// A program does not wait for ever for the next line of standard input.
#[test]
fn interrupted_table_keeps_earlier_rows() {
    let inputs = Inputs::new();
    let output = inputs.path("out.csv");
    let reba = Runs::new("reba").with(&["--input", "-", "--json", "--output", &output]);
    let mut child = reba.start();
    let mut table = SHEETS.replacen("trunk", "id,trunk", 1).replace("\n0,", "\n1,0,");
    // The second row is incomplete.
    table.push_str("2,0,0");
    let mut stdin = child.stdin.take().unwrap();
    stdin.write_all(table.as_bytes()).unwrap();
    wait_for_line(&mut child);
    signal(&child, "INT");
    let ran = Ran::of(child);
    drop(stdin);
    assert_eq!(ran.code(), Some(130), "{ran:?}");
    assert!(!Path::new(&output).exists());
    let kept = fs::read_to_string(inputs.path("out.partial.csv")).unwrap();
    assert_eq!(ran.json()["partial"], true);
    assert_eq!(kept.lines().count() as u64, 1 + ran.json()["rows"].as_u64().unwrap());
    assert!(kept.lines().skip(1).all(|row| row.starts_with("1,0,0,0,0,80,0,1,")), "{kept}");
}

#[test]
fn a_quiet_program_says_nothing_but_results() {
    let ran = Runs::new("soak").with(&["--ticks=8000", "--quiet", "--json"]).run().done();
    assert_eq!(ran.errors, "");
    assert_eq!(ran.json()["partial"], false);
}

/// A device is written to, not replaced.
#[test]
fn devices_stay_devices() {
    Runs::new("record").with(&["--duration=1", "--output=/dev/null"]).run().done();
    let link = tempfile::tempdir().unwrap();
    let null = link.path().join("null");
    std::os::unix::fs::symlink("/dev/null", &null).unwrap();
    Runs::new("record").with(&["--duration=1", "--output", null.to_str().unwrap()]).run().done();
    assert!(!fs::metadata("/dev/null").unwrap().is_file());
    let full = Runs::new("record").with(&["--duration=1", "--output=/dev/full"]).run();
    full.failed(1, "cannot write /dev/full: No space left on device");
}

/// The names of the files in a folder.
fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap();
    let mut names: Vec<String> =
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

fn wait_for_line(child: &mut std::process::Child) {
    use std::io::{BufRead, BufReader};
    let errors = child.stderr.as_mut().unwrap();
    let mut line = String::new();
    BufReader::with_capacity(1, errors).read_line(&mut line).unwrap();
    assert!(!line.is_empty());
}
