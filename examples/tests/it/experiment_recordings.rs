//! Experiments with recordings in place of simulated people, and their page.

use std::fs;
use std::path::Path;

use moca_simulation::people::{Walker, WalkerSettings};
use percept_recording::{Header, Writer};
use vision_models::Percept;

use crate::support::Runs;

/// A person who uses the tool from the seventh second on.
fn walker() -> Walker {
    let settings = WalkerSettings { offer: 0.0, duration: 13.0, ..WalkerSettings::default() };
    Walker::new(settings).unwrap()
}

fn write(path: &Path, header: &Header, percepts: impl Iterator<Item = Percept>) {
    let mut writer = Writer::new(Vec::new(), header).unwrap();
    percepts.for_each(|percept| writer.write(&percept).unwrap());
    fs::write(path, writer.finish().unwrap()).unwrap();
}

/// The walker's recording with a change.
fn changed(path: &Path, change: impl Fn(Percept) -> Percept) {
    write(path, &walker().header(), walker().map(change));
}

/// The page has the numbers of the JSON line and the program's table.
#[test]
fn page_has_the_numbers_of_the_table() {
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
fn unfit_recordings_are_refused_before_the_work() {
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
    // A recording that fits does not hide one that does not.
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
