//! The data that are read from the page of a run are those that were recorded.

use std::ops::ControlFlow;

use base64::{Engine, engine::general_purpose::STANDARD};
use ergo_map::Person;
use moca_model::{Goal, MOCA_URDF};
use moca_replay::page::{ResultRow, Results, page};
use moca_replay::picture::{animation, still};
use moca_replay::recorded::{Recorder, Replay, ReplayError, Role, Shape, Table};
use moca_replay::report::TickRow;
use moca_simulation::people::Walker;
use moca_simulation::run::{Run, Scenario};
use nalgebra::{Isometry3, Point3, Vector3};
use serde_json::Value;
use vision_models::{Body, Body25, Confidence, Keypoint, Percept};

use crate::support::coarse_map;

/// Number of ticks between two samples.
const STRIDE: usize = 20;

/// Six seconds of a walk with all ticks. `prepare` gets the recorder first.
fn recorded(prepare: impl FnOnce(&mut Recorder)) -> (Replay, Vec<TickRow>) {
    let percepts = Walker::random(7).take(120).collect();
    let scenario = Scenario::new(percepts, &Person::average(), coarse_map().clone()).unwrap();
    let scenario = scenario.kinematic();
    let Scenario { model, settings, map, .. } = &scenario;
    let mut recorder = Recorder::new("<on>", model, MOCA_URDF, settings, map).unwrap();
    prepare(&mut recorder);
    let mut rows = Vec::new();
    let run = Run::new(&scenario, Goal::Ergonomics).unwrap().recorded_by(&mut recorder);
    run.play(|row, _| {
        rows.push(row.clone());
        ControlFlow::Continue(())
    })
    .unwrap();
    let late = recorder.add("late", Role::Tool, Shape::Sphere { radius: 0.1 }, [0.5; 3]);
    assert!(matches!(late, Err(ReplayError::LateFrame { .. })), "{late:?}");
    (recorder.finish(), rows)
}

fn data_of(page: &str) -> Value {
    let (_, data) = page.split_once("id=\"data\">").unwrap();
    let (data, _) = data.split_once("</script>").unwrap();
    serde_json::from_str(data).unwrap()
}

/// The numbers of a group by rows.
fn numbers(table: &Value, name: &str) -> Vec<Vec<f64>> {
    let groups = table["groups"].as_array().unwrap();
    let group = groups.iter().find(|group| group["name"] == name).unwrap();
    let size = usize::try_from(group["size"].as_u64().unwrap()).unwrap();
    let width = size * group["columns"].as_array().unwrap().len();
    let bytes = STANDARD.decode(group["data"].as_str().unwrap()).unwrap();
    let list = |key: &str| -> Vec<f64> {
        group[key].as_array().unwrap().iter().map(|value| value.as_f64().unwrap()).collect()
    };
    let (low, step) = (list("low"), list("step"));
    let values: Vec<f64> = if step.is_empty() {
        bytes
            .chunks(4)
            .map(|four| f64::from(f32::from_le_bytes(four.try_into().unwrap())))
            .collect()
    } else {
        let steps = bytes.chunks(2).map(|two| u16::from_le_bytes(two.try_into().unwrap()));
        let value = |(index, count): (usize, u16)| match count {
            u16::MAX => f64::NAN,
            count => low[index % width] + step[index % width] * f64::from(count),
        };
        steps.enumerate().map(value).collect()
    };
    values.chunks(width).map(<[f64]>::to_vec).collect()
}

fn column(table: &Value, group: &str, name: &str) -> usize {
    let groups = table["groups"].as_array().unwrap();
    let group = groups.iter().find(|known| known["name"] == group).unwrap();
    let names = group["columns"].as_array().unwrap();
    let size = usize::try_from(group["size"].as_u64().unwrap()).unwrap();
    size * names.iter().position(|known| known == name).unwrap()
}

#[test]
fn what_is_read_back_is_what_went_in() {
    let (replay, rows) = recorded(|_| ());
    let row = ResultRow { name: "e_s".to_owned(), digits: 2, values: vec![Some(0.25)] };
    let summary = serde_json::json!({ "score_mean_on": 0.25 });
    let text = "of all".to_owned();
    let results = Results { rows: vec![row], summary: summary.clone(), text };
    let text = page("A walk </script>", &[&replay], &results).unwrap();
    let data = data_of(&text);
    assert!(text.contains("<h1>A walk &lt;/script&gt;</h1>"));
    assert_eq!(data["results"]["summary"], summary);
    assert_eq!(data["results"]["rows"][0]["values"][0], 0.25);
    assert_eq!(data["results"]["text"], "of all");

    let samples = &data["runs"][0]["samples"];
    let sampled: Vec<&TickRow> = rows.iter().step_by(STRIDE).collect();
    assert_eq!(samples["count"], sampled.len());
    let times = STANDARD.decode(samples["times"].as_str().unwrap()).unwrap();
    let times: Vec<f64> =
        times.chunks(8).map(|eight| f64::from_le_bytes(eight.try_into().unwrap())).collect();
    assert!(times.iter().zip(&sampled).all(|(time, row)| *time == row.time));

    let (series, frames) = (numbers(samples, "series"), numbers(samples, "frames"));
    #[expect(clippy::cast_possible_truncation, reason = "f32 is what is kept")]
    let exactly = |value: f64| f64::from(value as f32);
    let [score, reba, actual] =
        ["e_s", "REBA predicted", "actual x"].map(|name| column(samples, "series", name));
    let tool = column(samples, "frames", "tool");
    let mut scored = 0;
    for ((row, series), frames) in sampled.iter().zip(&series).zip(&frames) {
        if row.reba > 0 {
            scored += 1;
            assert_eq!(
                (series[score], series[reba]),
                (exactly(row.score), f64::from(row.reba)),
                "{row:?}"
            );
        } else {
            assert!(series[score].is_nan() && series[reba].is_nan());
        }
        for axis in 0..3 {
            assert_eq!(series[actual + axis], exactly(row.actual[axis]));
            // The resolution is some hundredths of a millimetre.
            assert!((frames[tool + axis] - row.actual[axis]).abs() < 1e-4, "{row:?}");
        }
    }
    assert!(scored > 100);
}

#[test]
fn page_is_small_and_self_contained() {
    let (replay, rows) = recorded(|_| ());
    let one = page("One", &[&replay], &Results::default()).unwrap();
    let two = page("Two", &[&replay, &replay], &Results::default()).unwrap();
    for outside in ["src=\"http", "href=\"http", "url(http", "import ", "@import", "fetch("] {
        assert!(!two.contains(outside), "{outside}");
    }
    for placeholder in ["{{title}}", "{{style}}", "{{data}}", "{{script}}"] {
        assert!(!two.contains(placeholder), "{placeholder}");
    }
    let a_run = (two.len() - one.len()) as f64;
    let minute = one.len() as f64 - a_run + 2.0 * a_run * 60_000.0 / rows.len() as f64;
    assert!(minute < 8e6, "{minute} bytes");
}

/// A frame before the run shows two people beside the person.
#[test]
fn page_shows_others_where_they_were_seen() {
    let at = |x: f64| {
        let mut body = Body::default();
        let position = Point3::new(x, -1.0, 0.9);
        body.set(Body25::MidHip, Some(Keypoint { position, confidence: Confidence::ONE }));
        body
    };
    let percept = Percept { time: -0.05, body: None, action: None, surface: None };
    let (replay, _) = recorded(|recorder| recorder.observe(&percept, &[at(2.0), at(3.0)], None));
    let data = data_of(&page("Others", &[&replay], &Results::default()).unwrap());
    let others = &data["runs"][0]["others"];
    assert_eq!(others["count"], 121);
    let pelvis = column(others, "other 1", "pelvis");
    for (name, x) in [("other 1", 2.0), ("other 2", 3.0)] {
        let rows = numbers(others, name);
        let seen = Vector3::from_row_slice(&rows[0][pelvis..pelvis + 3]);
        assert!((seen - Vector3::new(x, -1.0, 0.9)).norm() < 1e-4, "{seen}");
        assert!(rows[1][pelvis].is_nan(), "who is not seen again is not shown");
    }
    assert!(numbers(others, "other 3")[0][pelvis].is_nan());
    // There is no entry for others if nobody else was there.
    let (alone, _) = recorded(|_| ());
    let data = data_of(&page("Alone", &[&alone], &Results::default()).unwrap());
    assert!(data["runs"][0]["others"].is_null());
}

#[test]
fn the_object_is_where_it_is_placed() {
    let grip = Isometry3::new(Vector3::new(0.7, -0.2, 1.1), Vector3::new(0.1, 0.2, 0.3));
    let size = [0.4, 0.05, 0.3];
    let (replay, _) = recorded(|recorder| {
        let [object, gone] = ["object", "tool in hand"].map(|name| {
            recorder.add(name, Role::Object, Shape::Box { size }, [0.6, 0.5, 0.3]).unwrap()
        });
        recorder.place(object, Some(grip)).unwrap();
        recorder.place(gone, None).unwrap();
    });
    let data = data_of(&page("Object", &[&replay], &Results::default()).unwrap());
    let run = &data["runs"][0];
    let solids = run["solids"].as_array().unwrap();
    let object = solids.iter().find(|solid| solid["name"] == "object").unwrap();
    assert_eq!(object["shape"], serde_json::json!({ "kind": "box", "size": size }));
    assert_eq!(object["role"], "object");
    let frames = numbers(&run["samples"], "frames");
    let place = column(&run["samples"], "frames", "object");
    assert_eq!(object["frame"], place / 7);
    let rotation = grip.rotation.coords;
    for row in &frames {
        let seen = nalgebra::Vector4::from_row_slice(&row[place + 3..place + 7]);
        assert!(
            (Vector3::from_row_slice(&row[place..place + 3]) - grip.translation.vector).norm()
                < 1e-4
        );
        assert!((seen - rotation).norm().min((seen + rotation).norm()) < 1e-4);
        assert!(row[column(&run["samples"], "frames", "tool in hand")].is_nan());
    }
}

#[test]
fn a_frame_of_another_recorder_is_refused() {
    let mut other = None;
    let (_, rows) = recorded(|recorder| {
        let ball = Shape::Sphere { radius: 0.1 };
        other = Some(recorder.add("ball", Role::Surroundings, ball, [0.5; 3]).unwrap());
    });
    assert!(!rows.is_empty());
    recorded(|recorder| {
        let refused = recorder.place(other.unwrap(), None).unwrap_err();
        assert!(matches!(refused, ReplayError::UnknownFrame { slot: 0, count: 0 }), "{refused}");
    });
}

#[test]
fn pictures_have_scenes_and_stay_small() {
    let (replay, _) = recorded(|_| ());
    let runs = [&replay, &replay];
    let (still, moving) = (still(&runs).unwrap(), animation(&runs).unwrap());
    for (picture, most) in [(&still, 100_000), (&moving, 500_000)] {
        assert!(picture.starts_with("<svg xmlns=") && picture.ends_with("</svg>\n"));
        assert_eq!(picture.matches("&lt;on>").count(), 2, "its titles are escaped");
        assert!(!picture.contains("NaN") && !picture.contains("inf"));
        assert!(picture.len() < most, "{} bytes", picture.len());
    }
    assert!(moving.contains("<animate ") && !still.contains("<animate"));
}

#[test]
fn long_run_is_sampled_less_often() {
    let mut table = Table::new(Vec::new());
    for tick in 0..4 * Table::MOST {
        table.push(tick as f64, &[]);
        assert!(table.len() <= Table::MOST);
    }
    assert!(table.times().windows(2).all(|pair| pair[1] - pair[0] == 4.0), "evenly");
}
