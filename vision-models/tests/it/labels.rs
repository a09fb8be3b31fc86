//! Label files and figures of merit.

use proptest::prelude::*;
use vision_models::{Action, ClassNames, ConfusionMatrix, Error, likeliest, softmax, top_accuracy};

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
        Err(Error::UnknownAction { name }) if name == "Juggling"
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
    for (text, line) in [
        ("", 1),
        ("1 Walking\n3 Running", 2),
        ("1 Walking\nRunning", 2),
        ("1 Walking\n2 ", 2),
        ("Walking\nwalk_ing", 2),
    ] {
        match text.parse::<ClassNames>() {
            Err(Error::Labels { line: at, .. }) => assert_eq!(at, line, "{text:?}"),
            other => panic!("{other:?} for {text:?}"),
        }
    }
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
        assert!(matches!(names.clips(text), Err(Error::Labels { line: 2, .. })));
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
    assert_eq!(matrix.add(0, 3), Err(Error::ClassIndex { class: 3, classes: 3 }));
    assert_eq!(matrix.add(3, 0), Err(Error::ClassIndex { class: 3, classes: 3 }));
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
    assert_eq!(likeliest(&scores, 3), [1, 2, 3]);
    assert_eq!(likeliest(&scores, 9).len(), 5);
    let samples = [(&scores[..], 2), (&scores[..], 4), (&scores[..], 1), (&scores[..], 3)];
    assert_eq!(top_accuracy(samples, 1), Some(0.25));
    assert_eq!(top_accuracy(samples, 3), Some(0.75));
    assert_eq!(top_accuracy(samples, 5), Some(1.0));
    assert_eq!(top_accuracy([], 5), None);
}

proptest! {
    #[test]
    fn probabilities(scores in prop::collection::vec(-1e3..1e3_f32, 1..40)) {
        let probabilities = softmax(&scores);
        prop_assert!((probabilities.iter().sum::<f32>() - 1.0).abs() < 1e-5);
        prop_assert!(probabilities.iter().all(|p| (0.0..=1.0).contains(p)));
        prop_assert_eq!(likeliest(&probabilities, 1).len(), 1);
    }

    #[test]
    fn any_text_is_read_or_refused(text in "[0-9a-c ,:\n\t]{0,80}") {
        if let Ok(names) = text.parse::<ClassNames>() {
            prop_assert!(!names.names().is_empty());
            for name in names.names() {
                prop_assert!(names.index(name).is_some());
            }
            let _ = names.clips(&text);
        }
    }
}
