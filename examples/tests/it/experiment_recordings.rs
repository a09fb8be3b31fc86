//! Experiments with recordings in place of simulated people, and their page.

use std::fs;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use moca_simulation::experiment::following::{Following, WalkingTrial};
use moca_simulation::experiment::reorientation::Reorientation;
use moca_simulation::experiment::{Conditions, Experiment, Job, Needs, Player, Recorded, Sight};
use moca_simulation::people::{Walker, WalkerSettings};
use moca_simulation::plant::Drive;
use moca_simulation::run::Summary;
use percept_recording::{Header, IfPartial, Recording, Writer};
use vision_models::{Percept, Surface, Tool};

use crate::support::{Runs, average_map};

/// Somebody who uses the tool from the seventh second on.
fn walker() -> Walker {
    let settings = WalkerSettings { offer: 0.0, duration: 13.0, ..WalkerSettings::default() };
    Walker::new(settings).unwrap()
}

fn write(path: &Path, header: &Header, percepts: impl Iterator<Item = Percept>) {
    let mut writer = Writer::new(Vec::new(), header).unwrap();
    percepts.for_each(|percept| writer.write(&percept).unwrap());
    fs::write(path, writer.finish().unwrap()).unwrap();
}

/// The walker's recording, changed.
fn changed(path: &Path, change: impl Fn(Percept) -> Percept) {
    write(path, &walker().header(), walker().map(change));
}

fn job(recordings: &[Arc<Recorded>]) -> Job {
    Job {
        seed: 1,
        cases: 100,
        duration: 30.0,
        conditions: Conditions { drive: Drive::Kinematic, sight: Sight::Modelled },
        recordings: vec!["digest".to_owned(); recordings.len()],
    }
}

fn read(path: PathBuf, needs: Needs) -> Vec<Arc<Recorded>> {
    let reader = percept_recording::open(path).unwrap();
    let recording = Recording::read(reader, IfPartial::Refuse).unwrap();
    vec![Arc::new(Recorded::new(recording, needs).unwrap())]
}

#[test]
fn a_recording_says_who_works_with_what_on_which_side() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("walk.jsonl");
    changed(&path, |percept| percept);
    let recordings = read(path, Needs::Surfaces);
    let [recording] = &recordings[..] else { panic!("{recordings:?}") };
    assert_eq!((recording.stature, recording.tool), (1.75, Tool::Drill));
    // The side that is to be drilled faces the camera, and so not the person.
    assert_eq!(recording.facing_camera, Some(Surface::Drilled));
    let cases = Reorientation::cases(&job(&recordings), &recordings);
    assert_eq!(cases.len(), 1);
    assert_eq!(cases[0].front, Surface::Smooth);
    // The person as tracked is where the person was.
    let (mut truth, mut walk) = (recording.walk.truth.iter(), walker());
    while let Some((person, _)) = walk.next_frame() {
        let Some(known) = truth.as_slice().first().filter(|known| known.time == person.time) else {
            continue;
        };
        truth.next();
        if person.time > 3.0 {
            assert!((known.floor - person.floor).norm() < 0.06, "{known:?} {person:?}");
        }
    }
}

#[test]
fn the_same_recording_twice_gives_the_same_bits() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("walk.jsonl");
    changed(&path, |percept| percept);
    let recordings = read(path, Needs::Tools);
    let job = job(&recordings);
    let cases = Following::cases(&job, &recordings);
    assert_eq!(cases.len(), 1);
    let play = || {
        let mut player = Player::new(&|| ControlFlow::Continue(()));
        let trial = Following::play(&cases[0], average_map(), job.conditions, &mut player).unwrap();
        let WalkingTrial::Path(runs) = trial else { panic!("{trial:?}") };
        // Times of the machine aside.
        runs.map(|run| Summary { tick_us: [0.0; 3], wall: 0.0, ..run })
    };
    let first = play();
    assert!(first.iter().all(|run| run.together > 1.0), "{first:?}");
    let text = |runs| serde_json::to_string(runs).unwrap();
    assert_eq!(text(&first), text(&play()));
}

/// The page's numbers are those of the line that the program prints, and its table is the program's.
#[test]
fn a_run_of_a_recording_is_a_page_with_the_numbers_of_the_table() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    changed(&folder.path().join("walk.jsonl"), |percept| percept);
    let run = Runs::new("experiment")
        .with(&["following", "--kinematic", "--json", "--output", &path("report")])
        .with(&["--recording", &path("walk.jsonl")])
        .run()
        .done();
    let (table, line) = run.output.trim_end().rsplit_once('\n').unwrap();
    let line: serde_json::Value = serde_json::from_str(line).unwrap();
    assert!(table.starts_with("1 cases, in 0 more they never met"), "{table}");
    let page = fs::read_to_string(path("report/following.html")).unwrap();
    let (_, data) = page.split_once("id=\"data\">").unwrap();
    let (data, _) = data.split_once("</script>").unwrap();
    let data: serde_json::Value = serde_json::from_str(data).unwrap();
    assert_eq!(data["results"]["summary"], line["shown"]);
    assert_eq!(data["results"]["text"], table.trim_end());
    assert_eq!(line["shown"]["score_mean_on"], line["score_on"]["mean"]);
    let runs = data["runs"].as_array().unwrap();
    assert_eq!(runs.len(), 2);
    for (run, title) in runs.iter().zip(["Ergonomics on", "Ergonomics off"]) {
        assert_eq!(run["title"], title);
        let lanes = run["lanes"].as_array().unwrap();
        let phase = lanes.iter().find(|lane| lane["name"] == "phase").unwrap();
        let labels: Vec<_> = phase["spans"].as_array().unwrap().iter().collect();
        assert_eq!(labels[0]["label"], "apart");
        assert_eq!(labels[1]["label"], "working: the person engages");
    }
}

#[test]
fn recordings_that_do_not_fit_are_refused_before_the_work() {
    let folder = tempfile::tempdir().unwrap();
    let name = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let refused = |experiment: &str, file: &str, says: &str| {
        let output = name("report");
        let options = [experiment, "--output", &output, "--recording", file];
        let run = Runs::new("experiment").with(&options).run().failed(1, says);
        assert!(run.errors.starts_with("error: ") && run.errors.contains(file), "{}", run.errors);
        assert_eq!(run.errors.lines().count(), 1, "{}", run.errors);
    };
    let whole = folder.path().join("walk.jsonl");
    changed(&whole, |percept| percept);

    let cut = name("cut.jsonl");
    let bytes = fs::read(&whole).unwrap();
    fs::write(&cut, &bytes[..bytes.len() / 2]).unwrap();
    refused("subjects", &cut, "cut off");

    let silent = name("tools.jsonl");
    changed(silent.as_ref(), |percept| Percept { action: None, ..percept });
    refused("following", &silent, "nobody uses a tool in it");

    let bare = name("surfaces.jsonl");
    changed(bare.as_ref(), |percept| Percept { surface: None, ..percept });
    refused("reorientation", &bare, "it has no surface before the tool is used");

    let empty = name("nobody.jsonl");
    changed(empty.as_ref(), |percept| Percept { body: None, ..percept });
    refused("following", &empty, "nobody is seen in it");

    let short = name("stature.jsonl");
    write(short.as_ref(), &Header::default(), walker());
    refused("subjects", &short, "how tall the person is");

    refused("following", &name("gone.jsonl"), "No such file");
    // One that fits does not hide one that does not.
    let whole = name("walk.jsonl");
    let both = ["following", "--no-report", "--recording", &whole, &cut];
    Runs::new("experiment").with(&both).run().failed(1, "cut off");

    let with = |options: &[&str]| {
        Runs::new("experiment").with(&["following", "--recording", &whole]).with(options).run()
    };
    with(&["--pixels"]).failed(2, "--pixels");
    with(&["--cases", "3"]).failed(2, "--cases");
    with(&["--duration", "30"]).failed(2, "--duration");
    with(&["--show", "1", "--no-report"]).failed(1, "--show 1: there are 1 cases, from 0");
    with(&["--output", &whole]).failed(1, "it is a file; give a folder");
    with(&["--output", "/proc/out"]).failed(1, "cannot write /proc/out");
    with(&["--no-report", "--shard", "1/1", "--shard-file", "/proc/shard"])
        .failed(1, "/proc/shard");
}
