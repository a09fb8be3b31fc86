//! The `record` program from the outside.

use std::process::{Command, Output};

fn record(options: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_record")).args(options).output().unwrap()
}

#[test]
fn without_options_it_makes_the_shipped_recording() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("follow.jsonl");
    let output = record(&["--output", file.to_str().unwrap()]);
    assert!(output.status.success(), "{output:?}");
    let shipped = include_bytes!("../../recordings/follow.jsonl");
    assert!(
        std::fs::read(file).unwrap() == shipped,
        "make it anew: cargo run --release -p examples --bin record -- \
         --output examples/recordings/follow.jsonl"
    );
    assert!(shipped.len() < 1_500_000);
}

#[test]
fn options_are_obeyed() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("short.jsonl");
    let output = record(&[
        "--output",
        file.to_str().unwrap(),
        "--duration=20",
        "--stature=1.6",
        "--path=1.4,0 2.0,0.5",
        "--tool=polisher",
        "--noise=0",
        "--drop=0",
        "--vanish=1",
        "--jump=1",
        "--seed=7",
    ]);
    assert!(output.status.success(), "{output:?}");
    let reader = percept_recording::open(file).unwrap();
    assert_eq!(reader.header().stature, Some(1.6));
    let percepts: Vec<_> = reader.collect::<Result<_, _>>().unwrap();
    assert_eq!(percepts.len(), 401);
    let tools = percepts.iter().filter_map(|percept| percept.action?.action.tool());
    assert!(tools.filter(|tool| *tool == vision_models::Tool::Polisher).count() > 100);
    assert!(percepts.iter().any(|percept| percept.body.is_none()));
}

/// The truth is that of the recording without noise, also between its frames.
#[test]
fn the_truth_is_written_beside_the_recording() {
    let folder = tempfile::tempdir().unwrap();
    let [file, truth] = ["seen.jsonl", "truth.jsonl"].map(|name| folder.path().join(name));
    let (file, truth) = (file.to_str().unwrap(), truth.to_str().unwrap());
    let output = record(&[
        "--output",
        file,
        "--truth",
        truth,
        "--duration=30",
        "--noise=0",
        "--drop=0",
        "--movement=bow",
    ]);
    assert!(output.status.success(), "{output:?}");
    let seen: Vec<_> = percept_recording::open(file).unwrap().map(Result::unwrap).collect();
    let known: Vec<_> = percept_recording::open(truth).unwrap().map(Result::unwrap).collect();
    assert!(known.windows(2).all(|pair| (pair[1].time - pair[0].time - 0.01).abs() < 2e-6));
    let nose = |percept: &vision_models::Percept| {
        percept.body.as_ref().unwrap().get(vision_models::Body25::Nose).unwrap().position
    };
    for (frame, percept) in seen.iter().enumerate() {
        let same = &known[5 * frame];
        assert!((same.time - percept.time).abs() < 2e-6);
        assert!((nose(same) - nose(percept)).norm() < 3e-4);
    }
    let lowest = known.iter().map(|percept| nose(percept).z).fold(f64::INFINITY, f64::min);
    assert!(lowest < 1.5, "somebody bows: {lowest} m");
    assert!(moca_simulation::run::TrueMotion::read(truth.as_ref()).is_ok());
    let error = moca_simulation::run::TrueMotion::read(file.as_ref()).unwrap_err();
    assert!(
        std::error::Error::source(&error)
            .is_some_and(|cause| cause.to_string().contains("at 50 Hz or more"))
    );
}

/// Somebody dances at the robot, and a recording of it can be danced again.
#[test]
fn motions_of_real_people_are_repeated() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let repeat = |motion: &str, output: &str| {
        let more = ["--duration=12", "--noise=0", "--drop=0"];
        let options = [&["--motion", motion, "--output", output][..], &more].concat();
        let output = record(&options);
        assert!(output.status.success(), "{output:?}");
    };
    let (dance, again) = (path("dance.jsonl"), path("again.jsonl"));
    repeat("dance", &dance);
    repeat(&dance, &again);
    let places = |file: &str| {
        let reader = percept_recording::open(file).unwrap();
        assert_eq!(reader.header().stature, Some(1.62));
        let percepts: Vec<_> = reader.collect::<Result<_, _>>().unwrap();
        let works = |action: vision_models::RecognisedAction| action.action.is_collaborative();
        assert!(percepts.iter().any(|percept| percept.action.is_some_and(works)));
        let wrist = |percept: vision_models::Percept| {
            Some(percept.body?.get(vision_models::Body25::RightWrist)?.position)
        };
        percepts.into_iter().filter_map(wrist).collect::<Vec<_>>()
    };
    let (once, twice) = (places(&dance), places(&again));
    let way = |places: &[nalgebra::Point3<f64>]| -> f64 {
        places.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum()
    };
    assert!(way(&once) > 20.0, "{} m", way(&once));
    // It is played slowly towards its ends.
    assert!((0.5..=1.0).contains(&(way(&twice) / way(&once))), "{} m", way(&twice));
}

#[test]
fn wrong_options_are_named() {
    for (options, says) in [
        (&["--output=/no/such/folder/a.jsonl"][..], "/no/such/folder/a.jsonl"),
        (&["--output=a.jsonl", "--stature=-1"], "stature = -1: give 1 to 2.3 m"),
        (&["--output=a.jsonl", "--path=zigzag"], "path \"zigzag\": give stations"),
        (&["--output=a.jsonl", "--motion=fly"], "motion \"fly\": give walk, balance, punch"),
        (&["--output=a.jsonl", "--motion=walk", "--stature=1.8"], "cannot be used with"),
        (&["--output=a.jsonl", "--drop=2"], "drop = 2: give a probability"),
        (&["--output=a.jsonl", "--duration=NaN"], "duration = NaN: give 0 to 3600 s"),
        (&["--output=a.jsonl", "--tool=hammer"], "give drill or polisher"),
        (&[], "--output"),
    ] {
        let output = record(options);
        let text = String::from_utf8_lossy(&output.stderr);
        assert!(!output.status.success() && text.contains(says), "{options:?}: {text}");
    }
}
