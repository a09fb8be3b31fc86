//! Further content of recordings: times of capture and recognition of each part, and the person's segments.

use nalgebra::Point3;
use percept_recording::{
    Header, IfPartial, MeasuredSegments, Reader, Recording, RecordingError, Stamp, Timing, Writer,
};
use vision_models::{
    Action, Body, Body25, Confidence, Keypoint, Percept, PersonId, RecognisedAction,
};

/// The times of the parts of a percept are kept. Recordings without them are read as before.
#[test]
fn timings_are_kept_and_checked() {
    let percept = Percept {
        time: 2.0,
        body: None,
        action: Some(RecognisedAction { action: Action::Walking, confidence: Confidence::ONE }),
        surface: None,
    };
    let action = Stamp { captured: Some(1.8), arrived: Some(2.3) };
    let timing = Timing { arrived: Some(2.05), action, surface: Stamp::default() };
    let mut writer = Writer::new(Vec::new(), &Header::default()).unwrap();
    writer.write_people(&percept, &[], &timing).unwrap();
    writer.write(&Percept { time: 2.1, ..percept.clone() }).unwrap();
    for (of, stamp) in [
        ("captured at 2.3 s", Stamp { captured: Some(2.3), arrived: None }),
        ("arrived at 1.5 s", Stamp { captured: None, arrived: Some(1.5) }),
        ("within 600 s", Stamp { captured: None, arrived: Some(999.0) }),
        ("NaN", Stamp { captured: Some(f64::NAN), arrived: None }),
    ] {
        let wrong = Timing { action: stamp, ..Timing::default() };
        let error = writer.write_people(&Percept { time: 2.2, ..percept.clone() }, &[], &wrong);
        let text = error.unwrap_err().to_string();
        assert!(text.contains(of) && text.contains("the action of the frame"), "{text}");
    }
    let bytes = writer.finish().unwrap();
    let reader = Reader::new(bytes.as_slice()).unwrap();
    let recording = Recording::read(reader, IfPartial::Refuse).unwrap();
    assert_eq!(recording.timings, [timing, Timing::default()]);
    let second = String::from_utf8(bytes).unwrap();
    assert!(!second.lines().nth(2).unwrap().contains("arrived"), "{second}");
}

#[test]
fn measured_segments_are_kept_and_checked() {
    let segments =
        MeasuredSegments { forearm: Some(0.25), thigh: Some(0.43), ..Default::default() };
    let header = Header { stature: Some(1.75), segments, ..Header::default() };
    let mut writer = Writer::new(Vec::new(), &header).unwrap();
    writer.write(&Percept { time: 0.0, body: None, action: None, surface: None }).unwrap();
    let bytes = writer.finish().unwrap();
    assert_eq!(Reader::new(bytes.as_slice()).unwrap().header(), &header);
    let text = String::from_utf8(bytes).unwrap().replace("0.25", "250.0");
    let error = Reader::new(text.as_bytes()).unwrap_err().to_string();
    assert!(error.contains("the length of the forearm is 250"), "{error}");
}

#[test]
fn errors_in_other_people_name_them() {
    let header = r#"{"format":"moca-recording","version":2,"frame":"world","rate":20.0}"#;
    let nobody = ["null"; 25].join(",");
    let error = |others: &str| {
        let frame = format!(
            r#"{{"time":0.0,"keypoints":[{nobody}],"others":[[{nobody}],[{others}]],"action":null,"surface":null}}"#
        );
        let text = format!("{header}\n{frame}\n");
        let mut reader = Reader::new(text.as_bytes()).unwrap();
        reader.next().unwrap().unwrap_err().to_string()
    };
    let few = error("null,null");
    assert!(
        few.starts_with(
            "line 2: the number of keypoints of other person 2 in the frame is 2: give the 25"
        ),
        "{few}"
    );
    let far = error(&nobody.replacen("null", "[0.0,1500.0,0.9,0.5]", 1));
    assert!(far.contains("1500") && far.contains("of other person 2 in the frame"), "{far}");
    // The writer reports the same.
    let mut body = Body::default();
    let position = Point3::new(0.0, f64::NAN, 1.0);
    body.set(Body25::Neck, Some(Keypoint { position, confidence: Confidence::ONE }));
    let percept = Percept { time: 0.0, body: None, action: None, surface: None };
    let mut writer = Writer::new(Vec::new(), &Header::default()).unwrap();
    let error = writer.write_people(&percept, &[body], &Timing::default()).unwrap_err().to_string();
    assert!(error.contains("NaN") && error.contains("other person 1"), "{error}");
}

#[test]
fn each_person_has_an_id_of_their_own() {
    let header = r#"{"format":"moca-recording","version":2,"frame":"world","rate":20.0}"#;
    let somebody = format!("[1.0,0.0,1.6,0.9]{}", ",null".repeat(24));
    let read = |ids: &str| {
        let frame = format!(
            r#"{{"time":0.0,"keypoints":[{somebody}],"others":[[{somebody}]]{ids},"action":null,"surface":null}}"#
        );
        let text = format!("{header}\n{frame}\n");
        let mut reader = Reader::new(text.as_bytes()).unwrap();
        let percept = reader.next().unwrap()?;
        let bodies = percept.body.iter().chain(reader.others());
        Ok(bodies.map(|body| body.id().map(PersonId::number)).collect::<Vec<_>>())
    };
    let error = |ids: &str| -> String {
        let read: Result<_, RecordingError> = read(ids);
        read.unwrap_err().to_string()
    };
    assert_eq!(read("").unwrap(), [None, None], "an old recording");
    assert_eq!(read(r#","ids":[7,null]"#).unwrap(), [Some(7), None]);
    for (wrong, told) in
        [("[7]", "[Some(7)]"), ("[7,7]", "[Some(7), Some(7)]"), ("[1,2,3]", "2, of")]
    {
        let error = error(&format!(r#","ids":{wrong}"#));
        assert!(error.contains("line 2: the ids of the people") && error.contains(told), "{error}");
    }
    for wrong in ["[-1,2]", "[0.5,2]", "[\"a\",2]", "3"] {
        let error = error(&format!(r#","ids":{wrong}"#));
        assert!(error.starts_with("line 2, column"), "{error}");
    }
    // The writer refuses the same.
    let mut body = Body::default();
    let position = Point3::new(1.0, 0.0, 1.6);
    body.set(Body25::Nose, Some(Keypoint { position, confidence: Confidence::ONE }));
    let body = body.with_id(PersonId::new(7));
    let percept = Percept { time: 0.0, body: Some(body.clone()), action: None, surface: None };
    let mut writer = Writer::new(Vec::new(), &Header::default()).unwrap();
    let error = writer.write_people(&percept, &[body], &Timing::default()).unwrap_err().to_string();
    assert!(error.contains("[Some(7), Some(7)]"), "{error}");
}
