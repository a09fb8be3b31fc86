//! Maps and modes of the program `follow`.

use std::fs;

use ergo_map::{ErgonomicsMap, MapOptions, Person, Side};

use crate::support::{Runs, average_map};

/// Plays a second of `record`. Returns the messages and the scores of every tick.
fn scores(options: &[&str]) -> (String, Vec<String>) {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    Runs::new("record").with(&["--duration=1", "--output", &path("r.jsonl")]).run().done();
    let follow = Runs::new("follow").with(options).with(&["--recording", &path("r.jsonl")]);
    let ran = follow.with(&["--output", &path("report")]).run().done();
    let table = fs::read_to_string(path("report/ticks-on.csv")).unwrap();
    let mut lines = table.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let column = lines.next().unwrap().iter().position(|name| *name == "score").unwrap();
    (ran.output, lines.map(|line| line[column].to_owned()).collect())
}

#[test]
fn saved_map_plays_like_a_built_one() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    average_map().save(path("average.ergomap")).unwrap();
    let (_, built) = scores(&[]);
    assert!(built.len() == 1001 && built.iter().any(|score| *score != built[0]), "{built:?}");
    assert_eq!(scores(&["--map", &path("average.ergomap")]).1, built);
    // Another map gives other scores.
    let left = MapOptions { side: Side::Left, spacing: 0.1, ..MapOptions::default() };
    let left = ErgonomicsMap::build(&Person::average(), &left, None).unwrap();
    left.save(path("left.ergomap")).unwrap();
    assert_ne!(scores(&["--map", &path("left.ergomap")]).1, built);
    // A robot that measures itself with other noise ends elsewhere.
    assert_ne!(scores(&["--robot-noise=10"]).1, built);
    for factor in ["-1", "NaN", "inf", "much"] {
        let ran = Runs::new("follow").with(&["--no-report", "--robot-noise", factor]).run();
        ran.failed(2, "give a finite factor of 0 or more");
    }
}

#[test]
fn a_map_of_another_person_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let tall = folder.path().join("tall.ergomap");
    average_map().for_stature(1.94).unwrap().save(&tall).unwrap();
    let tall = tall.to_str().unwrap();
    let follow = |options: &[&str]| {
        Runs::new("follow").with(&["--no-report", "--map", tall]).with(options).run()
    };
    let says = "this map is of a person of 1.94 m, but the recording says 1.75 m: give that \
                person's map, or --stature 1.94";
    assert_eq!(follow(&[]).failed(1, says).errors, format!("error: {tall}: {says}\n"));
    for stature in ["1.9", "NaN"] {
        let says = format!("1.94 m, but --stature says {stature} m");
        follow(&["--stature", stature]).failed(1, &says);
    }
    // Statures that agree to the centimetre are of the same person.
    let short = folder.path().join("short.jsonl");
    let record = Runs::new("record").with(&["--duration=1", "--stature=1.935", "--output"]);
    record.with(&[&short]).run().done();
    follow(&["--recording", short.to_str().unwrap()]).done();

    let not_there = Runs::new("follow").with(&["--map=/nope/p.ergomap", "--no-report"]).run();
    not_there.failed(1, "cannot read /nope/p.ergomap: No such file");
    let no_map = short.to_str().unwrap();
    let ran = Runs::new("follow").with(&["--no-report", "--map", no_map]).run();
    ran.failed(1, &format!("{no_map}: "));
}

/// Plays two seconds of a person who works with the robot by its kinematics, and returns the JSON object.
fn working(options: &[&str]) -> serde_json::Value {
    let folder = tempfile::tempdir().unwrap();
    let person = folder.path().join("person.jsonl").to_str().unwrap().to_owned();
    Runs::new("record").with(&["--duration=8", "--seed=2", "--output", &person]).run().done();
    let follow = Runs::follow().with(&["--kinematic", "--no-report", "--json", "--recording"]);
    follow.with(&[&person]).with(options).run().done().json()
}

#[test]
fn the_papers_controller_is_a_mode() {
    let json = working(&["--paper", "--compare-stacking=50"]);
    assert_eq!((&json["separation"], &json["solver_failures"]), (&false.into(), &0.into()));
    let stacking = &json["stacking"];
    assert!(stacking["compared"].as_u64().unwrap() > 250, "{stacking}");
    assert!(stacking["largest_difference"].as_f64().unwrap() < 1e-6, "{stacking}");
    // The same person and robot with the default stack.
    let extended = working(&[]);
    assert_eq!(extended["separation"], true);
    assert_ne!(extended["tracking_error_rms_mm"], json["tracking_error_rms_mm"]);
}

/// Joints of a person who walks towards the robot, and of one on a balance beam.
#[test]
fn recordings_of_real_people_are_played_whole() {
    for (name, seconds) in [("walk.jsonl", 3.5), ("balance.jsonl", 1.5)] {
        let recording = concat!(env!("CARGO_MANIFEST_DIR"), "/recordings/").to_owned() + name;
        let ran =
            Runs::new("follow").with(&["--recording", &recording, "--no-report", "--json"]).run();
        let result: serde_json::Value =
            serde_json::from_str(ran.done().output.lines().last().unwrap()).unwrap();
        for count in
            ["limit_violations", "jerk_violations", "separation_violations", "solver_failures"]
        {
            assert_eq!(result[count], 0, "{name}: {count}");
        }
        assert!(result["duration_s"].as_f64().unwrap() > seconds, "{name}: {result}");
    }
}
