//! The program `experiment`, and the output of `merge` for its shards.

use std::fs;
use std::ops::ControlFlow;

use examples::experiment::program;
use examples::shards::Part;
use moca_simulation::experiment::reorientation::{
    self, Case, Reorientation, ReorientationResult, Trial,
};
use moca_simulation::experiment::{Conditions, Experiment, Job, Player, Sight, Source};
use moca_simulation::plant::Drive;

use crate::support::{Runs, coarse_map};

const KINEMATIC: Conditions =
    Conditions { drive: Drive::Kinematic, sight: Sight::Modelled, paper: false };

/// Two machines have played a trial each. `merge` prints and draws the same as one machine.
#[test]
fn merged_experiments_are_the_whole() {
    let go_on = || ControlFlow::Continue(());
    // The robot turns the object once in the first trial.
    let play = |(mut case, duration): (Case, f64)| {
        let Source::Simulated(person) = &mut case.person else { panic!("{case:?}") };
        person.duration = duration;
        case.play(coarse_map(), KINEMATIC, &mut Player::new(&go_on)).unwrap()
    };
    let trials: Vec<Trial> =
        reorientation::cases(1, 2).into_iter().zip([16.0, 6.0]).map(play).collect();
    let whole = &ReorientationResult::new(trials.clone());
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let job =
        Job { seed: 1, cases: 2, duration: 16.0, conditions: KINEMATIC, recordings: Vec::new() };
    let files = ["1/2", "2/2"].map(|shard| (shard, path(&shard.replace('/', "-"))));
    for ((shard, file), (number, trial)) in files.iter().zip((0..).zip(&trials)) {
        let part = Part {
            program: program::<Reorientation>(),
            job: job.clone(),
            shard: shard.parse().unwrap(),
            cases: 2,
            results: [(number, trial.clone())].into(),
            times: (),
        };
        fs::write(file, part.to_json().unwrap()).unwrap();
    }
    let [(_, first), (_, second)] = &files;
    let options = [second, first, "--output", &path("figures"), "--json"];
    let run = Runs::new("merge").with(&options).run().done();
    let (table, line) = run.output.trim_end().rsplit_once('\n').unwrap();
    assert_eq!(format!("{table}\n"), whole.to_string());
    let line: serde_json::Value = serde_json::from_str(line).unwrap();
    assert_eq!((&line["experiment"], &line["seed"]), (&"reorientation".into(), &1.into()));
    assert_eq!(line["turns_on"], serde_json::to_value(&whole.turns_on).unwrap());
    let drawn = fs::read_to_string(path("figures/reorientation.svg")).unwrap();
    assert_eq!(drawn, Reorientation::figure(whole).unwrap());
}

#[test]
fn help_and_wrong_folders_of_each_experiment() {
    let file = env!("CARGO_MANIFEST_PATH");
    for (name, does) in [
        ("reorientation", "Experiment 3"),
        ("following", "Experiment 4"),
        ("subjects", "Experiment 5"),
    ] {
        let help = Runs::new("experiment").with(&[name, "--help"]).run().done().output;
        assert!(help.starts_with(does), "{help}");
        for part in ["--json", "--quiet", "--seed", "--threads", "--cases", "--pixels", "--shard"] {
            assert!(help.contains(part), "{name}: {part}");
        }
        let program = |folder| Runs::new("experiment").with(&[name, "--output", folder]).run();
        program(file).failed(1, "it is a file; give a folder");
        program("/proc/out").failed(1, "cannot write /proc/out");
        Runs::new("experiment").with(&[name, "--cases", "0"]).run().failed(2, "--cases");
    }
}
