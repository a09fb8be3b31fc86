//! Recordings in MCAP.

use std::fs;

use examples::shipped;
use mcap::MessageStream;
use moca_model::{MOCA_HOME, moca};
use moca_replay::mcap::RobotLog;
use moca_replay::report::TickRow;
use nalgebra::Point3;
use percept_recording::mcap::{McapError, from_json_lines, to_json_lines};
use percept_recording::{Header, Timing, Writer};
use proptest::prelude::*;
use vision_models::{Body, Body25, Confidence, Keypoint, Percept};

use crate::support::Runs;

/// The beginning of the shipped recording: this number of frames without a closing line.
fn beginning(frames: usize) -> Vec<u8> {
    shipped::bytes()
        .split_inclusive(|byte| *byte == b'\n')
        .take(frames + 1)
        .flatten()
        .copied()
        .collect()
}

#[test]
fn shipped_recording_survives_conversion_and_shrinks() {
    let file = from_json_lines(shipped::bytes()).unwrap();
    assert_eq!(to_json_lines(&file).unwrap(), shipped::bytes());
    assert!(file.len() < shipped::bytes().len(), "{} bytes", file.len());
}

#[test]
fn cut_or_reformatted_recordings_survive_conversion() {
    let cut = beginning(5);
    for text in [&cut[..], &cut[..cut.len() - 1], &cut[..cut.len() - 40]] {
        let file = from_json_lines(text).unwrap();
        assert_eq!(to_json_lines(&file).unwrap(), text);
    }
    let windows = String::from_utf8(beginning(3)).unwrap().replace('\n', "\r\n");
    let file = from_json_lines(windows.as_bytes()).unwrap();
    assert_eq!(to_json_lines(&file).unwrap(), windows.as_bytes());
}

/// Other people in view are kept, and drawn beside the person.
#[test]
fn other_people_are_kept_and_drawn() {
    let at = |x: f64| {
        let mut body = Body::default();
        let position = Point3::new(x, 0.5, 0.9);
        body.set(Body25::MidHip, Some(Keypoint { position, confidence: Confidence::ONE }));
        body
    };
    let percept = Percept { time: 0.0, body: None, action: None, surface: None };
    let mut writer = Writer::new(Vec::new(), &Header::default()).unwrap();
    writer.write_people(&percept, &[at(2.0), at(3.0)], &Timing::default()).unwrap();
    let both = Percept { time: 0.05, body: Some(at(1.0)), ..percept };
    writer.write_people(&both, &[at(2.0)], &Timing::default()).unwrap();
    let text = writer.finish().unwrap();
    let file = from_json_lines(&text).unwrap();
    assert_eq!(to_json_lines(&file).unwrap(), text);
    let mut drawn = Vec::new();
    for message in MessageStream::new(&file).unwrap() {
        let message = message.unwrap();
        if message.channel.topic == "/person" {
            let value: serde_json::Value = serde_json::from_slice(&message.data).unwrap();
            for entity in value["entities"].as_array().unwrap() {
                let x = entity["spheres"][0]["pose"]["position"]["x"].as_f64().unwrap();
                drawn.push((entity["id"].as_str().unwrap().to_owned(), x));
            }
        }
    }
    let expected = [("other 1", 2.0), ("other 2", 3.0), ("person", 1.0), ("other 1", 2.0)];
    assert_eq!(drawn, expected.map(|(name, x)| (name.to_owned(), x)));
}

#[test]
fn messages_are_json_with_schemas_that_foxglove_knows() {
    let mut log = RobotLog::new(&beginning(2), &moca().unwrap()).unwrap();
    let (min, max) = ([0.2, -0.5, 0.7], [0.7, 0.2, 1.6]);
    for (tick, bounds) in [([f64::NAN; 3], [f64::NAN; 3]), (min, max)].into_iter().enumerate() {
        let time = 0.05 * tick as f64;
        let (workspace_min, workspace_max) = bounds;
        log.push(&TickRow {
            time,
            q: MOCA_HOME.to_vec(),
            workspace_min,
            workspace_max,
            ..TickRow::default()
        })
        .unwrap();
    }
    let file = log.finish().unwrap();
    assert_eq!(to_json_lines(&file).unwrap(), beginning(2));
    let mut found = std::collections::BTreeMap::new();
    for message in MessageStream::new(&file).unwrap() {
        let message = message.unwrap();
        let schema = message.channel.schema.clone().unwrap();
        assert_eq!((&*schema.encoding, &*message.channel.message_encoding), ("jsonschema", "json"));
        let described: serde_json::Value = serde_json::from_slice(&schema.data).unwrap();
        assert_eq!(described["type"], "object");
        let value: serde_json::Value = serde_json::from_slice(&message.data).unwrap();
        found.insert(message.channel.topic.clone(), (schema.name.clone(), value));
    }
    let named: Vec<(&str, &str)> =
        found.iter().map(|(topic, (name, _))| (&**topic, &**name)).collect();
    assert_eq!(
        named,
        [
            ("/joint_states", "moca.JointStates"),
            ("/percepts", "moca.Percept"),
            ("/person", "foxglove.SceneUpdate"),
            ("/scores", "moca.Scores"),
            ("/tf", "foxglove.FrameTransforms"),
            ("/workspace", "foxglove.SceneUpdate"),
        ]
    );
    assert_eq!(found["/joint_states"].1["position"]["panda_joint4"], MOCA_HOME[6]);
    assert_eq!(found["/workspace"].1["entities"][1]["cubes"][0]["size"]["y"], 0.7);
    let transforms = found["/tf"].1["transforms"].as_array().unwrap();
    let hand = transforms.iter().find(|frame| frame["child_frame_id"] == "panda_hand").unwrap();
    assert!(hand["translation"]["z"].as_f64().unwrap() > 0.5, "{hand}");
}

#[test]
fn a_file_of_something_else_is_refused() {
    let file = from_json_lines(&beginning(2)).unwrap();
    let mut sink = mcap::Writer::new(std::io::Cursor::new(Vec::new())).unwrap();
    sink.finish().unwrap();
    let empty = sink.into_inner().into_inner();
    assert!(matches!(to_json_lines(&empty), Err(McapError::NoRecording { .. })));
    assert!(matches!(to_json_lines(b"nonsense"), Err(McapError::Mcap(_))));
    assert!(matches!(to_json_lines(b""), Err(McapError::Mcap(_))));
    assert!(matches!(from_json_lines(&file), Err(McapError::Recording(_))));
    assert!(matches!(from_json_lines(b""), Err(McapError::Recording(_))));

    let mut sink = mcap::Writer::new(std::io::Cursor::new(Vec::new())).unwrap();
    let schema = sink.add_schema("other", "jsonschema", b"{}").unwrap();
    let channel_id = sink.add_channel(schema, "/percepts", "json", &[].into()).unwrap();
    let header =
        mcap::records::MessageHeader { channel_id, sequence: 0, log_time: 0, publish_time: 0 };
    sink.write_to_known_channel(&header, b"{}").unwrap();
    sink.finish().unwrap();
    let error = to_json_lines(&sink.into_inner().into_inner()).unwrap_err().to_string();
    assert!(error.contains("\"other\", expected moca.Percept"), "{error}");
}

/// Several writers may store messages out of order. They count by their time.
#[test]
fn messages_come_in_the_order_of_their_time() {
    let file = include_bytes!("../data/neighbours.mcap");
    let text = to_json_lines(file).unwrap();
    let times: Vec<f64> = percept_recording::Reader::new(text.as_slice())
        .unwrap()
        .map(|percept| percept.unwrap().time)
        .collect();
    assert!(times.len() > 2);
    assert!(times.is_sorted_by(|one, other| one < other), "{times:?}");
    // The reader of recordings refuses messages in stored order.
    assert_eq!(to_json_lines(&from_json_lines(&text).unwrap()).unwrap(), text);
}

/// The output is a valid recording, or there is an error. An invalid message is not passed on.
#[test]
fn converted_recordings_are_checked() {
    let (header, line) =
        (br#"{"format":"moca-recording","version":2,"frame":"world","rate":20.0}"#, "{}\n");
    let mut sink = mcap::Writer::new(std::io::Cursor::new(Vec::new())).unwrap();
    let entries = [
        ("header", String::from_utf8(header.to_vec()).unwrap() + "\n"),
        ("closing", String::new()),
        ("frames", "1".to_owned()),
    ];
    let metadata = entries.map(|(name, text)| (name.to_owned(), text)).into();
    sink.write_metadata(&mcap::records::Metadata { name: "moca.Recording".to_owned(), metadata })
        .unwrap();
    let schema = sink.add_schema("moca.Percept", "jsonschema", b"{}").unwrap();
    let channel_id = sink.add_channel(schema, "/percepts", "json", &[].into()).unwrap();
    let header =
        mcap::records::MessageHeader { channel_id, sequence: 0, log_time: 0, publish_time: 0 };
    sink.write_to_known_channel(&header, line.as_bytes()).unwrap();
    sink.finish().unwrap();
    let file = sink.into_inner().into_inner();
    assert!(matches!(to_json_lines(&file), Err(McapError::Recording(_))));
}

/// A schema that claims four gigabytes takes no memory.
#[test]
fn schema_length_is_checked_against_the_file() {
    let mut file = from_json_lines(&beginning(2)).unwrap();
    let name = b"\x0a\0\0\0jsonschema";
    let place = file.windows(name.len()).rposition(|text| text == name).unwrap() + name.len();
    file[place..place + 4].fill(0xff);
    let folder = tempfile::tempdir().unwrap();
    let [from, to] = ["a.mcap", "a.jsonl"].map(|name| folder.path().join(name));
    fs::write(&from, file).unwrap();
    // The recording does not need the summary.
    Runs::within("mcap", 1000).with(&[&from]).with(&["--output"]).with(&[&to]).run().done();
    assert_eq!(fs::read(&to).unwrap(), beginning(2));
}

/// The error names LZ4 and a remedy.
#[test]
fn a_compression_that_is_not_read_is_named() {
    let file = from_json_lines(&beginning(2)).unwrap();
    // The name of the compression follows its length in the head of a chunk. It is replaced by an unknown one of that
    // length.
    let place = file.windows(8).position(|name| name == b"\x04\0\0\0zstd").unwrap();
    let mut other = file;
    other[place + 4..place + 8].copy_from_slice(b"lz4!");
    let error = to_json_lines(&other).unwrap_err();
    assert!(matches!(error, McapError::Compression { .. }), "{error}");
    assert!(error.to_string().contains("lz4!") && error.to_string().contains("zstd"), "{error}");
}

proptest! {
    /// A cut file gives an error, never a panic and never a part that counts as complete.
    #[test]
    fn a_cut_file_is_refused(place in any::<proptest::sample::Index>(), damage in any::<u8>()) {
        let mut file = from_json_lines(&beginning(3)).unwrap();
        let place = place.index(file.len());
        prop_assert!(to_json_lines(&file[..place]).is_err());
        file[place] = damage;
        let _ = to_json_lines(&file);
    }
}

/// Any byte may be wrong. A length of 10¹⁹ must not make the library allocate that memory and abort.
#[test]
fn no_byte_of_a_file_breaks_its_reader() {
    let file = from_json_lines(&beginning(1)).unwrap();
    for place in 0..file.len() {
        for damage in [0, 0x72, 0xff] {
            let mut file = file.clone();
            file[place] = damage;
            let _ = to_json_lines(&file);
        }
    }
}

#[test]
fn the_programs_write_and_convert_them() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let (recording, file, back) = (path("a.jsonl"), path("a.mcap"), path("b.jsonl"));
    Runs::new("record").with(&["--duration=1", "--output", &recording]).run().done();
    let played = ["--recording", &recording, "--no-report", "--mcap", &file];
    Runs::follow().with(&played).run().done();
    let ran = Runs::new("mcap").with(&[&file, "--output", &back, "--json"]).run().done().json();
    assert_eq!(ran["from"], "MCAP");
    assert_eq!(fs::read(&recording).unwrap(), fs::read(&back).unwrap());
    fs::write(&file, &fs::read(&file).unwrap()[..1000]).unwrap();
    Runs::new("mcap").with(&[&file, "--output", &back]).run().failed(1, "not a whole MCAP file");
}

/// Checks that the MCAP of a loop in a folder gives back its recording, and has its motion and its states.
pub(crate) fn check_drive(folder: &std::path::Path) {
    let file = fs::read(folder.join("drive.mcap")).unwrap();
    let recording = fs::read(folder.join("recording.jsonl")).unwrap();
    assert_eq!(to_json_lines(&file).unwrap(), recording);
    let (mut joints, mut states) = (0, Vec::new());
    for message in MessageStream::new(&file).unwrap() {
        let message = message.unwrap();
        match message.channel.topic.as_str() {
            "/joint_states" => joints += 1,
            "/control_state" => {
                let value: serde_json::Value = serde_json::from_slice(&message.data).unwrap();
                states.push(value["state"].as_str().unwrap().to_owned());
            }
            _ => {}
        }
    }
    assert!((1700..=1900).contains(&joints), "{joints} in 18 s and the stop, at 100 Hz");
    assert!(states.iter().any(|state| state == "apart"), "{states:?}");
    assert!(states.iter().any(|state| state.contains("stop requested")), "{states:?}");
}
