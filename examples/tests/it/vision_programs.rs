//! Common behaviour of the programs with networks.

use std::path::Path;

use ndarray::Array4;

use crate::support::{Runs, resnet18, save_picture, slow_only_r18, write_npy};

const PROGRAMS: [&str; 4] = ["infer", "convert", "surface", "actions"];

/// Each program with options that let it print something soon.
fn programs(folder: &Path) -> Vec<Runs> {
    let path = |name: &str| folder.join(name).to_str().unwrap().to_owned();
    std::fs::create_dir_all(path("frames")).unwrap();
    let frame = save_picture(&folder.join("frames/1.png"), 60, 1);
    write_npy(path("in.npy"), &Array4::<f32>::zeros((1, 3, 32, 32)));
    let resnet = ["--weights", resnet18()];
    let slow_only = ["--weights", slow_only_r18(), "--model=slowonly_r18_mm", "--length=1"];
    vec![
        Runs::new("infer").with(&resnet).with(&[&frame]),
        Runs::new("infer").with(&resnet).with(&[
            "--model=resnet18",
            &path("in.npy"),
            "--output",
            &path("out.npy"),
        ]),
        Runs::new("infer").with(&slow_only).with(&[path("frames")]),
        Runs::new("convert").with(&[resnet18()]),
        Runs::new("surface").with(&["generate", &path("surfaces"), "--count=1", "--size=16"]),
    ]
}

#[test]
fn a_closed_output_ends_each_quietly() {
    let folder = tempfile::tempdir().unwrap();
    let helps = PROGRAMS.map(|name| Runs::new(name).with(&["--help"]));
    for program in programs(folder.path()).into_iter().chain(helps) {
        let ran = program.run_closed();
        assert_eq!((ran.code(), ran.errors.contains("error")), (Some(141), false), "{ran:?}");
    }
}

#[test]
fn full_output_has_its_own_exit_status() {
    let says = "cannot write to standard output: No space left on device";
    let folder = tempfile::tempdir().unwrap();
    for program in programs(folder.path()) {
        program.run_full().failed(74, says);
    }
}

#[test]
fn quiet_program_only_prints_json() {
    let folder = tempfile::tempdir().unwrap();
    for program in programs(folder.path()) {
        let ran = program.with(&["--json", "--quiet"]).run().done();
        assert_eq!((ran.errors.as_str(), &ran.json()["partial"]), ("", &false.into()), "{ran:?}");
    }
}

#[test]
fn help_says_what_each_does() {
    for (name, does) in [
        ("infer", "Runs a network on images, on a folder of frames, or on an array"),
        ("convert", "Prints what a checkpoint holds"),
    ] {
        let help = Runs::new(name).with(&["--help"]).run().done().output;
        assert!(help.starts_with(does), "{name}: {help}");
        for part in ["--json", "--quiet", "--output", "Exit status: 0 done"] {
            assert!(help.contains(part), "{name}: {part}");
        }
    }
}

#[test]
fn help_says_what_each_command_does() {
    for (name, command, does) in [
        ("surface", "generate", "Draws pictures of plates"),
        ("surface", "train", "Trains a new last layer and a support vector machine"),
        ("surface", "evaluate", "Classifies images of known classes"),
        ("actions", "train", "Trains a new last layer of a SlowOnly"),
        ("actions", "evaluate", "Recognises clips of known classes"),
    ] {
        let help = Runs::new(name).with(&[command, "--help"]).run().done().output;
        assert!(help.starts_with(does), "{name} {command}: {help}");
        for part in ["--json", "--quiet"] {
            assert!(help.contains(part), "{name} {command}: {part}");
        }
    }
}

#[test]
fn folder_or_device_as_checkpoint_is_refused() {
    for place in ["/", "/dev/zero", "/dev/null", "/nope"] {
        let named = format!("error: {place}: ");
        Runs::new("convert").with(&[place]).run().failed(1, &named);
        Runs::new("infer").with(&["a.png", "--weights", place]).run().failed(1, &named);
    }
}
