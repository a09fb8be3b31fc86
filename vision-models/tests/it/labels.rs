//! Label files and metrics.

use proptest::prelude::*;
use vision_models::{Action, ClassNames, ConfusionMatrix, Error, softmax, top_k};

#[test]
fn hri30_in_its_forms() {
    assert_eq!(ClassNames::hri30().actions().unwrap(), Action::ALL);
    let numbered = |join: &str, separator: &str, first: usize| -> String {
        let line = |(index, action): (usize, &Action)| {
            format!("{}{separator}{}\n", index + first, action.name().replace(' ', join))
        };
        Action::ALL.iter().enumerate().map(line).collect()
    };
    for text in [numbered("", " ", 1), numbered("_", ",", 0), numbered(" ", "\t", 1)] {
        let names: ClassNames = text.parse().unwrap();
        assert_eq!(names.actions().unwrap(), Action::ALL);
        assert_eq!(names.index("delivering the object"), None);
        assert_eq!(names.index("deliver object"), Some(0));
    }
    let names: ClassNames = numbered("", " ", 1).parse().unwrap();
    assert_eq!(
        (names.index("1"), names.index("30"), names.index("0"), names.index("31")),
        (Some(0), Some(29), None, None)
    );
    assert!(matches!(
        "Juggling\n".parse::<ClassNames>().unwrap().actions(),
        Err(Error::Name { what: "action", got, .. }) if got == "Juggling"
    ));
}

#[test]
fn files_on_disk() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("classInd.txt");
    std::fs::write(&path, "1 Walking\r\n2 PickUpDrill\r\n\r\n").unwrap();
    assert_eq!(ClassNames::read(&path).unwrap().names(), ["Walking", "PickUpDrill"]);
    assert!(matches!(ClassNames::read(folder.path().join("none")), Err(Error::File { .. })));
}

#[test]
fn class_lists_that_are_refused() {
    for (text, line) in
        [("", 1), ("1 Walking\n3 Running", 2), ("1 Walking\nRunning", 2), ("1 Walking\n2 ", 2)]
    {
        match text.parse::<ClassNames>() {
            Err(Error::Malformed { what, .. }) => {
                assert_eq!(what, format!("label file, line {line}"), "{text:?}");
            }
            other => panic!("{other:?} for {text:?}"),
        }
    }
}

/// Returns a text with this many lines.
fn lines(count: usize, line: impl Fn(usize) -> String) -> String {
    (0..count).map(line).collect::<Vec<_>>().join("\n")
}

/// ImageNet has a dog and a jacket whose names differ only in case, at these places in
/// torchvision's list.
#[test]
fn names_are_distinct_by_case() {
    let list = lines(1000, |class| match class {
        264 => "Cardigan".to_owned(),
        474 => "cardigan".to_owned(),
        _ => format!("class number {class}"),
    });
    let names: ClassNames = list.parse().unwrap();
    assert_eq!((names.index("Cardigan"), names.index("cardigan")), (Some(264), Some(474)));
    // Both match in another case, so neither is returned. Other names are still found in any case.
    assert_eq!(names.index("CARDIGAN"), None);
    assert_eq!(names.index("Class_Number_7"), Some(7));
}

#[test]
fn equal_names_are_reported_with_their_lines() {
    for text in ["Walking\nRunning\n\nWalk_ing\n", "1 Walking\n2 Running\n\n3 Walk_ing\n"] {
        let error = text.parse::<ClassNames>().unwrap_err();
        let message = error.to_string();
        assert!(message.contains("lines 1 and 4: \"Walking\" and \"Walk_ing\""), "{message}");
    }
    // Names may consist of signs only.
    let names: ClassNames = "+\n-\n".parse().unwrap();
    assert_eq!((names.index("+"), names.index("-")), (Some(0), Some(1)));
    let error = "a\na\na_\n".parse::<ClassNames>().unwrap_err().to_string();
    assert!(error.contains("are one name"), "{error}");
}

/// torchvision's list has two classes called `crane`, a bird and a machine, and two called
/// `maillot`.
#[test]
fn classes_of_equal_name_are_shown_with_numbers() {
    let list = lines(1000, |class| match class {
        134 | 517 => "crane".to_owned(),
        638 | 639 => "maillot".to_owned(),
        _ => format!("class number {class}"),
    });
    let names: ClassNames = list.parse().unwrap();
    assert_eq!(names.names().len(), 1000);
    assert_eq!(names.label(517).unwrap(), "crane (517)");
    assert_eq!(names.label(638).unwrap(), "maillot (638)");
    assert_eq!(names.label(7).unwrap(), "class number 7");
    assert_eq!(names.label(1000), None);
    // A name of two classes gives neither.
    assert_eq!((names.index("crane"), names.index("Crane")), (None, None));
    assert_eq!(names.index("517"), Some(517));
}

#[test]
fn a_byte_order_mark_is_ignored() {
    let plain = "1 Walking\n2 Running\n";
    let marked = format!("\u{feff}{plain}");
    assert_eq!(marked.parse::<ClassNames>().unwrap(), plain.parse().unwrap());
    let names: ClassNames = plain.parse().unwrap();
    let clips = names.clips("\u{feff}a.avi,1\n").unwrap();
    assert_eq!(clips, [("a.avi".to_owned(), 0)]);

    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("marked.txt");
    std::fs::write(&path, marked).unwrap();
    assert_eq!(ClassNames::read(&path).unwrap(), names);
}

/// A comparison of each clip with each name would take minutes.
#[test]
fn many_clips_of_many_names() {
    let count = 50_000;
    let list = lines(count, |class| format!("Name {class} a"));
    let names: ClassNames = list.parse().unwrap();
    let clips = lines(count, |clip| format!("{clip}.avi,name_{clip}_A"));
    let clips = names.clips(&clips).unwrap();
    assert_eq!(clips.len(), count);
    for (clip, (name, class)) in clips.iter().enumerate() {
        assert_eq!((name, class), (&format!("{clip}.avi"), &clip));
    }
}

#[test]
fn label_files_that_are_too_large() {
    let list = lines(100_001, |class| format!("c{class}"));
    let error = list.parse::<ClassNames>().unwrap_err().to_string();
    assert!(error.starts_with("label file, line 100001: "), "{error}");
    // An endless device.
    match ClassNames::read("/dev/zero") {
        Err(Error::File { path, reason }) => {
            assert!(path == "/dev/zero" && reason.contains("67108864 bytes"), "{reason}");
        }
        other => panic!("{other:?}"),
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("latin.txt");
    std::fs::write(&path, b"caf\xe9\n").unwrap();
    let error = ClassNames::read(&path).unwrap_err().to_string();
    assert!(error.contains("latin.txt") && error.contains("not UTF-8 text: byte 3"), "{error}");
}

/// The message about a name in a file is short, however long the name is.
#[test]
fn messages_are_short() {
    let name = "x".repeat(1 << 20);
    for error in [
        name.parse::<ClassNames>().unwrap().actions().unwrap_err(),
        format!("{name}\n{name}-\n").parse::<ClassNames>().unwrap_err(),
        Action::from_name(&name).unwrap_err(),
    ] {
        assert!(error.to_string().len() < 500, "{} bytes", error.to_string().len());
    }
    let error = Action::from_name("a\nb\u{1b}[2J").unwrap_err().to_string();
    assert!(error.contains(r"a\nb\u{1b}[2J") && !error.contains('\n'), "{error}");
}

#[test]
fn clips_and_their_classes() {
    let names: ClassNames = "1 Walking\n2 Pick Up Drill\n".parse().unwrap();
    let text =
        "video,label\nCID01_SID02_VID03.avi,2\nv_1 g.avi, Walking\nother.avi Pick Up Drill\n";
    assert_eq!(
        names.clips(text).unwrap(),
        [("CID01_SID02_VID03.avi".into(), 1), ("v_1 g.avi".into(), 0), ("other.avi".into(), 1)]
    );
    for text in ["a.avi,1\nb.avi,3\n", "a.avi,1\nb.avi\n"] {
        let error = names.clips(text).unwrap_err().to_string();
        assert!(error.starts_with("label file, line 2: "), "{error}");
    }
}

#[test]
fn confusion() {
    let mut matrix = ConfusionMatrix::new(3);
    assert_eq!(matrix.accuracy(), None);
    for (truth, given) in [(0, 0), (0, 1), (1, 1), (1, 1), (1, 1), (1, 2)] {
        matrix.add(truth, given).unwrap();
    }
    assert_eq!(matrix.accuracy(), Some(4.0 / 6.0));
    assert_eq!(matrix.count(0, 1), 1);
    assert_eq!(matrix.percent(1, 1), Some(75.0));
    assert_eq!(matrix.percent(2, 2), None);
    assert_eq!((matrix.count(9, 0), matrix.count(0, 3), matrix.count(usize::MAX, 1)), (0, 0, 0));
    for (truth, given) in [(0, 3), (3, 0)] {
        let error = matrix.add(truth, given).unwrap_err();
        assert_eq!(error.to_string(), "the class is 3: give an index below 3");
    }
}

#[test]
fn the_paper_s_accuracy() {
    // 727 of 840 test clips.
    let mut matrix = ConfusionMatrix::new(30);
    for clip in 0..840 {
        matrix.add(clip % 30, if clip < 727 { clip % 30 } else { (clip + 1) % 30 }).unwrap();
    }
    assert_eq!(format!("{:.2}", 100.0 * matrix.accuracy().unwrap()), "86.55");
}

#[test]
fn top_five() {
    let scores = [0.1, 0.9, 0.5, 0.5, -1.0];
    assert_eq!(top_k(&scores, 3), [1, 2, 3]);
    assert_eq!(top_k(&scores, 9), [1, 2, 3, 0, 4]);
}

proptest! {
    #[test]
    fn probabilities(scores in prop::collection::vec(-1e3..1e3_f32, 1..40)) {
        let probabilities = softmax(&scores);
        prop_assert!((probabilities.iter().sum::<f32>() - 1.0).abs() < 1e-5);
        prop_assert!(probabilities.iter().all(|p| (0.0..=1.0).contains(p)));
        // exp is monotonic: two probabilities are in the order of their scores, or equal by
        // rounding. Also, p_i / p_j = exp(s_i − s_j).
        for (&score, &p) in scores.iter().zip(&probabilities) {
            for (&other, &q) in scores.iter().zip(&probabilities) {
                prop_assert!(score <= other || p >= q, "{score}: {p}, {other}: {q}");
                let ratio = f64::from(score - other).exp();
                if q > 1e-30 && p > 1e-30 {
                    let error = f64::from(p) / f64::from(q) / ratio - 1.0;
                    prop_assert!(error.abs() < 1e-4, "{p} / {q} instead of {ratio}");
                }
            }
        }
    }

    #[test]
    fn any_text_is_read_or_refused(text in "[0-9a-c ,:\n\t]{0,80}") {
        match text.parse::<ClassNames>() {
            Ok(names) => {
                prop_assert!(!names.names().is_empty());
                for (class, name) in names.names().iter().enumerate() {
                    let is_shared = names.names().iter().filter(|other| *other == name).count() > 1;
                    let number = name.parse::<usize>().is_ok();
                    if !is_shared {
                        prop_assert_eq!(names.index(name), Some(class));
                    } else if !number {
                        prop_assert_eq!(names.index(name), None);
                    }
                }
                let lines = text.lines().filter(|line| !line.trim().is_empty()).count();
                prop_assert_eq!(names.names().len(), lines);
                match names.clips(&text) {
                    Ok(clips) => {
                        prop_assert!(clips.len() == lines || clips.len() == lines - 1);
                        prop_assert!(clips.iter().all(|&(_, class)| class < lines));
                    }
                    Err(error) => prop_assert!(matches!(error, Error::Malformed { .. }), "{error}"),
                }
            }
            Err(Error::Malformed { what, .. }) => {
                let numbers = what.split(|c: char| !c.is_ascii_digit());
                let lines: Vec<usize> = numbers.filter_map(|number| number.parse().ok()).collect();
                prop_assert!(!lines.is_empty() && lines.is_sorted(), "{what}");
                prop_assert!(lines.iter().all(|line| (1..=text.lines().count().max(1)).contains(line)));
            }
            Err(error) => prop_assert!(false, "{error}"),
        }
    }
}
