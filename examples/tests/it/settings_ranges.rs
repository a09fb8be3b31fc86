//! No number of the settings makes a program panic, or succeed without ever solving anything.

use std::collections::BTreeSet;

use examples::settings::{RobotSettings, SettingsFile};
use toml::{Table, Value};

use crate::support::Runs;

/// A step on the path to a number in a table: a name or an index.
#[derive(Clone, Debug)]
enum Step {
    Name(String),
    Place(usize),
}

/// Finds the paths of all numbers, and of the first number of long lists.
fn numbers(value: &Value, path: &[Step], found: &mut Vec<Vec<Step>>) {
    let below = |step: Step| path.iter().cloned().chain([step]).collect::<Vec<_>>();
    match value {
        Value::Integer(_) | Value::Float(_) => found.push(path.to_vec()),
        Value::Table(table) => {
            table
                .iter()
                .for_each(|(name, value)| numbers(value, &below(Step::Name(name.clone())), found));
        }
        Value::Array(items) => {
            items.iter().take(1).enumerate().for_each(|(place, value)| {
                numbers(value, &below(Step::Place(place)), found);
            });
        }
        _ => {}
    }
}

fn put(value: &mut Value, path: &[Step], new: Value) {
    let place = path.iter().fold(value, |value, step| match step {
        Step::Name(name) => &mut value.as_table_mut().unwrap()[name],
        Step::Place(place) => &mut value.as_array_mut().unwrap()[*place],
    });
    *place = new;
}

fn name(path: &[Step]) -> String {
    let names = path.iter().filter_map(|step| match step {
        Step::Name(name) => Some(name.as_str()),
        Step::Place(_) => None,
    });
    names.collect::<Vec<_>>().join(".")
}

fn all() -> Table {
    let mut settings = RobotSettings::default();
    settings.controller.on_board_camera = Some([0.1, 0.2, 0.3]);
    settings.controller.budget.iterations = Some(1000);
    settings.controller.budget.time = Some(std::time::Duration::from_millis(10));
    settings.camera.pose = Some([1.0, 0.0, 2.0, 0.0, 0.0, 0.0, 1.0]);
    let mut table = Table::try_from(settings).unwrap();
    table.insert("version".to_owned(), Value::Integer(1));
    table
}

const WRONG: [&str; 9] =
    ["nan", "inf", "-inf", "1e308", "-1e308", "0", "0.0", "-1", "9223372036854775807"];

/// The settings that hold a number, each once, without the contact limits of the body's regions.
fn settings_with_numbers(all: Table) -> BTreeSet<String> {
    let mut places = Vec::new();
    numbers(&Value::Table(all), &[], &mut places);
    let names = places.iter().map(|path| name(path)).filter(|name| name != "version");
    let is_of_region = |name: &String| {
        name.strip_prefix("controller.safety.contact.").is_some_and(|rest| rest.contains('.'))
    };
    let (of_regions, names): (BTreeSet<_>, BTreeSet<_>) = names.partition(is_of_region);
    assert_eq!(of_regions.len(), 12 * 4, "the table of ISO/TS 15066");
    names
}

/// A number stays a setting as long as a user can choose it.
#[test]
fn at_most_fifty_numbers_are_settings() {
    let written: Table = RobotSettings::default().to_toml().unwrap().parse().unwrap();
    // The second has also the numbers that may be "none" and those that follow from the person.
    for settings in [written, all()] {
        let names = settings_with_numbers(settings);
        assert!((40..=50).contains(&names.len()), "{}: {names:#?}", names.len());
    }
}

/// Every number has a range. Outside it an error names the setting; within it a controller can be made.
#[test]
fn each_unusable_number_is_refused_by_name() {
    let whole = all();
    let mut places = Vec::new();
    numbers(&Value::Table(whole.clone()), &[], &mut places);
    places.retain(|path| name(path) != "version");
    assert!(places.len() > 90, "{} numbers", places.len());
    let mut accepted = Vec::new();
    for path in &places {
        for wrong in WRONG {
            let value: Table = format!("x = {wrong}").parse().unwrap();
            let mut changed = Value::Table(whole.clone());
            put(&mut changed, path, value["x"].clone());
            let text = toml::to_string(&changed).unwrap();
            let read =
                SettingsFile::parse(&text).and_then(|file| file.over(&RobotSettings::default()));
            match read {
                Ok(_) => accepted.push(format!("{} = {wrong}", name(path))),
                Err(error) => {
                    let last = name(path).rsplit('.').next().unwrap().to_owned();
                    let error = error.to_string();
                    let words = last.replace('_', " ");
                    assert!(
                        error.contains(&last) || error.contains(&words) || error.contains("line "),
                        "{} = {wrong}: {error}",
                        name(path)
                    );
                }
            }
        }
    }
    // Zero may mean none, but NaN never does.
    let strange =
        |one: &&String| !one.ends_with("= 0") && !one.ends_with("= 0.0") && !one.ends_with("= -1");
    let strange: Vec<_> = accepted.iter().filter(strange).collect();
    for one in strange {
        let ages = ["supervisor.reduced_age", "supervisor.stop_age"];
        let known = ages.iter().any(|age| {
            one.contains(&format!("{age} = 1e308"))
                || one.contains(&format!("{age} = 9223372036854775807"))
        });
        assert!(known, "accepted: {one}");
    }
    // Accepted settings run or give an error; nothing panics.
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("settings.toml");
    for one in &accepted {
        let (path, value) = one.split_once(" = ").unwrap();
        let place = places.iter().find(|place| name(place) == path).unwrap();
        let value: Table = format!("x = {value}").parse().unwrap();
        let mut changed = Value::Table(whole.clone());
        put(&mut changed, place, value["x"].clone());
        std::fs::write(&file, toml::to_string(&changed).unwrap()).unwrap();
        let ran = Runs::new("soak")
            .with(&["--ticks=60", "--kinematic", "--settings"])
            .with(&[&file])
            .run();
        assert!(matches!(ran.code(), Some(0 | 1)), "{one}: {ran:?}");
        assert!(!ran.errors.contains("panicked"), "{one}: {ran:?}");
        if ran.output.is_empty() {
            assert!(ran.errors.contains("settings.toml"), "{one}: {ran:?}");
        }
    }
}

#[test]
fn run_without_solutions_is_a_failure() {
    let folder = tempfile::tempdir().unwrap();
    let (file, recording) = (folder.path().join("settings.toml"), folder.path().join("a.jsonl"));
    std::fs::write(&file, "version = 1\n[controller.budget]\niterations = 1\n").unwrap();
    Runs::new("record").with(&["--duration=1", "--output"]).with(&[&recording]).run().done();
    let follow = Runs::follow().with(&["--no-report", "--recording"]).with(&[&recording]);
    let starved = follow.with(&["--kinematic", "--settings"]).with(&[&file]).run();
    starved.failed(1, "no control period");
    let json = Runs::follow()
        .with(&["--no-report", "--kinematic", "--json", "--recording"])
        .with(&[&recording])
        .run()
        .done()
        .json();
    assert_eq!(json["solver_failures"], 0, "{json}");
}

#[test]
fn options_that_never_work_are_refused() {
    for spin in ["nan", "-1", "inf", "1e9"] {
        Runs::new("drive").with(&[&format!("--spin={spin}")]).run().failed(2, "microseconds");
    }
    for period in ["1e-308", "nan", "0", "2"] {
        Runs::new("ik")
            .with(&["none.urdf", "--frame=x", &format!("--period={period}")])
            .run()
            .failed(2, "0.00001 to 1");
    }
}
