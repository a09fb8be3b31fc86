//! Recordings: every fault is named with its line, and written data are read back.

mod properties;

use std::io::{self, BufReader, Read};

use nalgebra::Point3;
use percept_recording::{
    self, Completeness, Header, IfPartial, Reader, Recording, RecordingError, Writer,
};
use proptest::prelude::*;
use vision_models::{
    Action, Body, Body25, Confidence, Keypoint, Percept, PersonId, RecognisedAction,
    RecognisedSurface, Surface,
};

const HEADER: &str =
    r#"{"format":"moca-recording","version":2,"frame":"world","rate":20.0,"stature":1.75}"#;

/// A frame with only a mid hip; its parts are replaced by the arguments.
fn frame(time: &str, hip: &str, action: &str) -> String {
    let mut keypoints = vec!["null"; 25];
    keypoints[8] = hip;
    let keypoints = keypoints.join(",");
    format!(r#"{{"time":{time},"keypoints":[{keypoints}],"action":{action},"surface":null}}"#)
}

fn good(time: &str) -> String {
    frame(time, "[1.0,0.5,0.9,0.8]", r#"{"name":"Walking","confidence":0.9}"#)
}

/// The closing line of a complete recording.
fn end(frames: usize) -> String {
    format!(r#"{{"end":{{"frames":{frames},"complete":true}}}}"#)
}

/// Reads a text to its end or its first error.
fn read(text: &str) -> Result<Vec<Percept>, RecordingError> {
    Reader::new(text.as_bytes())?.collect()
}

/// The error of a recording whose third line is `line`, after a valid frame at 0 s.
fn error_of(line: &str) -> RecordingError {
    read(&format!("{HEADER}\n{}\n{line}\n{}\n", good("0.0"), good("9.0"))).unwrap_err()
}

/// Asserts the kind of the error, and that its text names the line and the remedy.
macro_rules! assert_error {
    ($error:expr, $kind:pat, $($part:literal),+) => {{
        let error = $error;
        assert!(matches!(error, $kind), "{error:?}");
        let text = error.to_string();
        $(assert!(text.contains($part), "\"{text}\" does not say \"{}\"", $part);)+
    }};
}

#[test]
fn a_good_recording_is_read() {
    let frames = [good("0.0"), String::new(), frame("0.05", "null", "null")].join("\n");
    let text = format!("{HEADER}\n{frames}\n{}", end(2));
    let mut reader = Reader::new(text.as_bytes()).unwrap();
    let header = Header { stature: Some(1.75), ..Header::default() };
    assert_eq!(*reader.header(), header);
    let first = reader.next().unwrap().unwrap();
    assert_eq!(first.time.to_bits(), 0.0_f64.to_bits());
    let hip = first.body.unwrap().get(Body25::MidHip).unwrap();
    assert_eq!(hip.position, Point3::new(1.0, 0.5, 0.9));
    assert_eq!(hip.confidence, Confidence::new(0.8).unwrap());
    assert_eq!(first.action.unwrap().action, Action::Walking);
    let nothing = Percept { time: 0.05, body: None, action: None, surface: None };
    assert_eq!(reader.next().unwrap().unwrap(), nothing);
    assert!(reader.next().is_none());
    assert_eq!(reader.completeness(), Completeness::Complete);
}

#[test]
fn empty_recordings() {
    assert_error!(read("").unwrap_err(), RecordingError::Empty { lines: 0 }, "empty", "`record`");
    assert_error!(read("\n \n").unwrap_err(), RecordingError::Empty { .. }, "empty");
    let old = HEADER.replace("\"version\":2", "\"version\":1");
    assert_error!(read(&old).unwrap_err(), RecordingError::Empty { lines: 1 }, "no camera frame");
    let none = format!("{HEADER}\n{}\n", end(0));
    assert_error!(read(&none).unwrap_err(), RecordingError::Empty { lines: 2 }, "no camera frame");
}

#[test]
fn wrong_headers() {
    let with =
        |from, to| read(&format!("{}\n{}", HEADER.replace(from, to), good("0.0"))).unwrap_err();
    assert_error!(
        read(&good("0.0")).unwrap_err(),
        RecordingError::Header { line: 1, .. },
        "line 1",
        "unknown field `time`",
        "moca-recording"
    );
    assert_error!(with("moca-", "other-"), RecordingError::Header { .. }, "\"other-recording\"");
    assert_error!(
        with("\"version\":2", "\"version\":7"),
        RecordingError::Header { .. },
        "version 7"
    );
    assert_error!(with("world", "camera"), RecordingError::Header { .. }, "`camera`", "`world`");
    assert_error!(with("20.0", "0"), RecordingError::Header { .. }, "rate is 0", "positive");
    for stature in ["0", "-1.75", "175"] {
        assert_error!(
            with("1.75", stature),
            RecordingError::Header { .. },
            "stature",
            "0.5 to 2.5"
        );
    }
}

#[test]
fn malformed_json() {
    for line in ["{", "not json", "[]", "{\"time\":0.1}", "\u{0}", &good("0.1")[..200]] {
        assert_error!(error_of(line), RecordingError::Json { line: 3, .. }, "line 3, column");
    }
    assert_error!(error_of(&good("\"soon\"")), RecordingError::Json { .. }, "expected f64");
    assert_error!(error_of(&good("NaN")), RecordingError::Json { .. }, "JSON has no NaN");
    assert_error!(error_of(&good("1e999")), RecordingError::Json { .. }, "out of range");
    let misspelt = good("0.1").replace("action", "acton");
    assert_error!(error_of(&misspelt), RecordingError::Json { .. }, "unknown field `acton`");
    assert_error!(
        error_of(&frame("0.1", &"[".repeat(10_000), "null")),
        RecordingError::Json { .. },
        "recursion limit"
    );
    let bytes = [HEADER.as_bytes(), b"\n\xff\xfe\n"].concat();
    let error = Reader::new(bytes.as_slice()).unwrap().next().unwrap().unwrap_err();
    assert_error!(error, RecordingError::Json { line: 2, .. }, "line 2");
}

#[test]
fn wrong_keypoints() {
    assert_error!(
        error_of(&good("0.1").replace("null,null,[", "null,[")),
        RecordingError::Value { line: 3, .. },
        "line 3",
        "number of keypoints is 24",
        "25 of BODY_25"
    );
    for hip in ["[1,2,3]", "[1,2,\"3\",0.5]", "[1,2,null,0.5]", "\"here\"", "7", "{}"] {
        assert_error!(
            error_of(&frame("0.1", hip, "null")),
            RecordingError::Value { line: 3, .. },
            "line 3",
            "keypoint 8 (mid hip)",
            "[x, y, z, confidence]"
        );
    }
    assert_error!(
        error_of(&frame("0.1", "[1000.0,200.0,900.0,0.9]", "null")),
        RecordingError::Value { line: 3, .. },
        "mid hip",
        "1000 m",
        "in metres"
    );
    for hip in ["[NaN,0,0,1]", "[Infinity,0,0,1]", "[1e400,0,0,1]"] {
        assert_error!(
            error_of(&frame("0.1", hip, "null")),
            RecordingError::Json { line: 3, .. },
            "null"
        );
    }
}

#[test]
fn wrong_confidences() {
    assert_error!(
        error_of(&frame("0.1", "[1,0,0.9,1.01]", "null")),
        RecordingError::Value { line: 3, .. },
        "keypoint 8 (mid hip)",
        "1.01",
        "[0, 1]"
    );
    assert_error!(
        error_of(&good("0.1").replace("0.9}", "-0.1}")),
        RecordingError::Value { line: 3, .. },
        "the action",
        "-0.1"
    );
    let surface =
        good("0.1").replace("\"surface\":null", r#""surface":{"name":"smooth","confidence":2}"#);
    assert_error!(error_of(&surface), RecordingError::Value { .. }, "the surface is 2");
}

#[test]
fn wrong_names() {
    assert_error!(
        error_of(&good("0.1").replace("Walking", "Flying")),
        RecordingError::Name { line: 3, .. },
        "line 3",
        "\"Flying\"",
        "\"Using The Drill\""
    );
    let surface =
        good("0.1").replace("\"surface\":null", r#""surface":{"name":"rough","confidence":0.5}"#);
    assert_error!(error_of(&surface), RecordingError::Name { .. }, "\"rough\"", "\"drilled\"");
}

#[test]
fn wrong_times() {
    for time in ["0.0", "-1.0"] {
        assert_error!(
            error_of(&good(time)),
            RecordingError::Value { line: 3, .. },
            "line 3",
            "not later than 0 s"
        );
    }
    assert_error!(
        error_of(&good("50.0")),
        RecordingError::Value { line: 3, .. },
        "50 s without a frame",
        "in seconds"
    );
}

/// The result of `follow` for a text, with and without `--partial`.
fn whole(text: &str, if_partial: IfPartial) -> Result<Recording, RecordingError> {
    Recording::read(Reader::new(text.as_bytes())?, if_partial)
}

#[test]
fn early_end_is_named_and_frames_kept() {
    let frames = format!("{HEADER}\n{}\n{}\n", good("0.0"), good("0.1"));
    let interrupted = format!("{frames}{}\n", end(2).replace("true", "false"));
    for (text, line, says) in [
        (frames.clone(), 4, "cut off here, after 2 whole camera frame(s)"),
        (format!("{frames}{}", &good("0.2")[..150]), 4, "cut off here, after 2"),
        (format!("{frames}{}", &end(2)[..12]), 4, "cut off here, after 2"),
        (interrupted, 4, "is partial: it was interrupted after 2 camera frame(s)"),
    ] {
        let error = whole(&text, IfPartial::Refuse).unwrap_err();
        assert!(error.is_early_end(), "{error:?}");
        let words = error.to_string();
        assert!(words.starts_with(&format!("line {line}: ")) && words.contains(says), "{words}");
        let taken = whole(&text, IfPartial::Take).unwrap();
        assert_eq!((taken.percepts.len(), taken.completeness), (2, Completeness::Partial));
    }
    // A text without a complete frame has nothing to take.
    for text in [HEADER.to_owned(), format!("{HEADER}\n{}", &good("0.0")[..150])] {
        assert_error!(
            whole(&text, IfPartial::Take).unwrap_err(),
            RecordingError::Cut { line: 2, frames: 0 },
            "line 2"
        );
    }
    // A damaged recording is not the same as a cut one.
    let damaged = format!("{HEADER}\n{}\nwrong\n", good("0.0"));
    assert_error!(
        whole(&damaged, IfPartial::Take).unwrap_err(),
        RecordingError::Json { line: 3, .. },
        "line 3"
    );
}

#[test]
fn recordings_of_the_first_version_have_no_end() {
    let old = HEADER.replace("\"version\":2", "\"version\":1");
    let text = format!("{old}\n{}\n", good("0.0"));
    let recording = whole(&text, IfPartial::Refuse).unwrap();
    assert_eq!(recording.completeness, Completeness::Unmarked);
    assert_eq!(recording.percepts.len(), 1);
    // A recording that ends within a line is cut off, whatever its version.
    let cut = format!("{text}{}", &good("0.1")[..150]);
    assert_error!(
        whole(&cut, IfPartial::Refuse).unwrap_err(),
        RecordingError::Cut { line: 3, frames: 1 },
        "line 3"
    );
    assert_error!(
        whole(&format!("{text}{}", end(1)), IfPartial::Take).unwrap_err(),
        RecordingError::End { line: 3, .. },
        "line 3",
        "version 1"
    );
}

#[test]
fn wrong_closing_lines() {
    let with = |end: &str| {
        whole(&format!("{HEADER}\n{}\n{end}\n", good("0.0")), IfPartial::Take).unwrap_err()
    };
    assert_error!(
        with(&end(2)),
        RecordingError::End { line: 3, .. },
        "line 3",
        "gives 2 camera frame(s), and there are 1"
    );
    assert_error!(
        with(&format!("{}\n\n{}", end(1), good("0.1"))),
        RecordingError::End { line: 5, .. },
        "line 5",
        "after the closing line"
    );
    for wrong in
        [r#"{"end":{"frames":1}}"#, r#"{"end":7}"#, r#"{ "end" : {"frames":-1}}"#, r#"{"end""#]
    {
        assert_error!(
            with(wrong),
            RecordingError::End { line: 3, .. },
            "line 3",
            "\"complete\":true"
        );
    }
}

#[test]
fn a_byte_order_mark_is_skipped() {
    let text = format!("\u{feff}{HEADER}\r\n{}\r\n{}\r\n", good("0.0"), end(1));
    assert_eq!(read(&text).unwrap().len(), 1);
    assert_error!(read("\u{feff}").unwrap_err(), RecordingError::Empty { .. }, "empty");
}

#[test]
fn errors_quote_little() {
    let long = "x".repeat(60_000);
    let label = |name: &str| format!(r#"{{"name":"{name}","confidence":0.9}}"#);
    for error in [
        error_of(&frame("0.1", "null", &label(&long))),
        error_of(&frame("0.1", &format!("\"{long}\""), "null")),
        error_of(&good("0.1").replace("\"action\"", &format!("\"{long}\""))),
        error_of(&format!("{{\"end\":\"{long}\"}}")),
        read(&HEADER.replace("moca", &long)).unwrap_err(),
        read(&HEADER.replace("world", &long)).unwrap_err(),
    ] {
        let words = error.to_string();
        assert!(words.len() < 4000 && !words.contains(&long[..200]), "{} bytes", words.len());
    }
}

#[test]
fn endless_line_is_refused_in_time() {
    let endless = HEADER.as_bytes().chain(&b"\n"[..]).chain(io::repeat(b' '));
    let error = Reader::new(BufReader::new(endless)).unwrap().next().unwrap().unwrap_err();
    assert_error!(error, RecordingError::LineTooLong { line: 2, .. }, "line 2", "longer than");
}

#[test]
fn after_an_error_a_reader_ends() {
    let text = format!("{HEADER}\nwrong\n{}\n", good("0.1"));
    let mut reader = Reader::new(text.as_bytes()).unwrap();
    assert!(reader.next().unwrap().is_err());
    assert!(reader.next().is_none());
}

#[test]
fn files_that_are_not_there() {
    let error = percept_recording::open("/no/such/recording.jsonl").unwrap_err();
    assert_error!(error, RecordingError::Open { .. }, "/no/such/recording.jsonl", "cannot open");
}

#[test]
fn writer_refuses_unreadable_data_and_goes_on() {
    let mut writer = Writer::new(Vec::new(), &Header::default()).unwrap();
    let at = |time, body| Percept { time, body, action: None, surface: None };
    let hip = |x| {
        let mut body = Body::default();
        let position = Point3::new(x, 0.0, 0.9);
        body.set(Body25::MidHip, Some(Keypoint { position, confidence: Confidence::ONE }));
        Some(body)
    };
    assert_error!(
        writer.write(&at(f64::NAN, None)).unwrap_err(),
        RecordingError::Value { line: 2, .. },
        "finite"
    );
    for x in [f64::NAN, f64::INFINITY, 1e6] {
        assert_error!(
            writer.write(&at(0.0, hip(x))).unwrap_err(),
            RecordingError::Value { line: 2, .. },
            "mid hip"
        );
    }
    writer.write(&at(0.0, hip(1.0))).unwrap();
    assert_error!(
        writer.write(&at(0.0, None)).unwrap_err(),
        RecordingError::Value { line: 3, .. },
        "not later"
    );
    writer.write(&at(0.1, None)).unwrap();
    let bytes = writer.finish().unwrap();
    let percepts: Result<Vec<_>, _> = Reader::new(bytes.as_slice()).unwrap().collect();
    assert_eq!(percepts.unwrap().len(), 2);
    let header = Header { stature: Some(0.0), ..Header::default() };
    let error = Writer::new(Vec::new(), &header).unwrap_err();
    assert_error!(error, RecordingError::Header { .. }, "stature is 0");
}
