//! The program that learns to recognise actions.

use std::{fs, path::Path};

use human_perception::learning::confusion_figure::confusion_figure;
use vision_models::Action;

use crate::support::{Runs, save_picture, slow_only_r18};

/// A folder of clips of two classes, one of which is named as in HRI30's copies.
struct Clips(tempfile::TempDir);

impl Clips {
    fn new(clips: u32, frames: u32) -> Self {
        let own = Self(tempfile::tempdir().unwrap());
        for (class, level) in [("DeliverObject", 30), ("MoveBackwardWhileDrilling", 200)] {
            for clip in 0..clips {
                let folder = own.0.path().join(format!("clips/{class}/{clip}"));
                fs::create_dir_all(&folder).unwrap();
                for frame in 0..frames {
                    save_picture(&folder.join(format!("{frame}.png")), level, 10 * clip + frame);
                }
            }
        }
        own
    }

    fn path(&self, name: &str) -> String {
        self.0.path().join(name).to_str().unwrap().to_owned()
    }

    fn train(&self) -> Runs {
        self.train_at("--side=32")
    }

    fn train_at(&self, side: &str) -> Runs {
        let (clips, model, cache) = (self.path("clips"), self.path("model"), self.path("cache"));
        let network = ["--network=slowonly_r18_mm", "--length=2", "--interval=2", side];
        Runs::new("actions")
            .with(&["train", &clips, "-o", &model, "--weights", slow_only_r18(), "--cache", &cache])
            .with(&network)
            .with(&["--epochs=50", "--learning-rate=0.01"])
    }

    fn evaluate(&self) -> Runs {
        let (clips, model, cache) = (self.path("clips"), self.path("model"), self.path("cache"));
        Runs::new("actions")
            .with(&["evaluate", &clips, "--model", &model, "--cache", &cache, "--clips=2"])
            .with(&["--weights", slow_only_r18()])
    }

    fn recognise(&self) -> Runs {
        let (clip, model) = (self.path("clips/DeliverObject/0"), self.path("model"));
        Runs::new("infer").with(&[&clip, "--model", &model, "--weights", slow_only_r18()])
    }
}

#[test]
fn trains_evaluates_and_recognises() {
    let clips = Clips::new(4, 6);
    let json = clips.train().with(&["--json", "--quiet"]).run().done().json();
    // 28 of 98 clips of a class are for the test: one of four.
    assert_eq!((&json["training_clips"], &json["test_clips"]), (&6.into(), &2.into()));
    assert_eq!(json["training_accuracy"], 1.0);
    let classes = serde_json::json!(["Deliver Object", "Move Backwards While Drilling"]);
    assert_eq!(json["classes"], classes);

    let out = clips.path("out");
    let ran = clips.evaluate().with(&["--json", "--output", &out]).run().done();
    let json = ran.json();
    assert_eq!(
        (&json["accuracy"], &json["top5"], &json["samples"]),
        (&1.0.into(), &1.0.into(), &2.into())
    );
    assert_eq!(
        (&json["classes"], &json["confusion"]),
        (&classes, &serde_json::json!([[1, 0], [0, 1]]))
    );
    assert_eq!(json["by_group"][0]["group"], "collaboration");
    assert_eq!(json["by_group"][0]["group_accuracy"], 1.0);
    assert_eq!(
        (&json["by_class"][1]["recall"], &json["by_class"][1]["precision"]),
        (&1.0.into(), &1.0.into())
    );
    assert!(
        ran.output
            .contains("\n2 clips: top-1 100.00 %, top-5 100.00 %, right intention 100.00 %\n"),
        "{ran:?}"
    );
    assert!(ran.output.contains("\nHuman-Robot Collaboration"), "{ran:?}");
    let figure = fs::read_to_string(format!("{out}/confusion.svg")).unwrap();
    assert!(figure.contains("Deliver Object") && figure.contains("100.0"));
    assert_eq!(fs::read_to_string(format!("{out}/scores.csv")).unwrap().lines().count(), 3);
    // The second run reads the features from disk.
    let again = clips.evaluate().with(&["--json"]).run().done().json();
    assert_eq!(again["by_class"], json["by_class"]);

    // Two shards give the same bytes.
    let files = ["1", "2"].map(|shard| {
        let file = clips.path(&format!("shard-{shard}.json"));
        let options = [format!("--shard={shard}/2"), "--shard-file".to_owned(), file.clone()];
        clips.evaluate().with(&options).run().done();
        file
    });
    let merged = clips.path("merged");
    let again = Runs::new("merge").with(&files).with(&["--json", "--output", &merged]).run().done();
    assert_eq!(again.output, ran.output);
    for name in ["confusion.svg", "scores.csv", "evaluation.json"] {
        let of = |folder: &str| fs::read(format!("{folder}/{name}")).unwrap();
        assert_eq!(of(&merged), of(&out), "{name}");
    }

    let whole = clips.recognise().with(&["--clips=2", "--json"]).run().done().json();
    assert_eq!(whole["classes"][0]["name"], "Deliver Object");
    let live = clips.recognise().with(&["--live", "--json"]).run().done();
    let json = live.json();
    // The windows have the frames 0, 2 and 2, 4.
    let frames: Vec<_> =
        json["live"]["decided"].as_array().unwrap().iter().map(|d| d["frame"].clone()).collect();
    assert_eq!(frames, [2, 4]);
    assert_eq!((&json["live"]["decisions"], &json["live"]["frames"]), (&2.into(), &6.into()));
    assert!(json["live"]["latency_p95_s"].as_f64().unwrap() > 0.0);
    assert_eq!(json["classes"][0]["name"], "Deliver Object");
    assert!(live.output.starts_with("frame 2: Deliver Object "), "{live:?}");
}

#[test]
fn lists_of_clips_are_taken_by_name() {
    let clips = Clips::new(1, 3);
    let folder = clips.path("flat");
    fs::create_dir(&folder).unwrap();
    fs::rename(clips.path("clips/DeliverObject/0"), format!("{folder}/CID01_SID01_VID01")).unwrap();
    fs::rename(
        clips.path("clips/MoveBackwardWhileDrilling/0"),
        format!("{folder}/CID02_SID01_VID01"),
    )
    .unwrap();
    let (names, list) = (clips.path("classInd.txt"), clips.path("list.csv"));
    fs::write(&names, "1 DeliverObject\n2 MoveBackwardWhileDrilling\n").unwrap();
    let train = |says: Option<&str>| {
        let train =
            ["train", &folder, "-o", &clips.path("model"), "--list", &list, "--names", &names];
        let ran = Runs::new("actions").with(&train).with(&[
            "--random-backbone=1",
            "--network=slowonly_r18_mm",
            "--length=1",
            "--side=32",
            "--no-flips",
            "--json",
        ]);
        match says {
            Some(says) => drop(ran.run().failed(1, says)),
            None => assert_eq!(ran.run().done().json()["training_clips"], 2),
        }
    };
    fs::write(&list, "CID01_SID01_VID01.avi,1\nCID02_SID01_VID01.avi,2\n").unwrap();
    train(None);
    fs::write(&list, "CID01_SID01_VID01.avi,1\nCID02_SID01_VID01.avi,3\n").unwrap();
    train(Some("list.csv: label file, line 2"));
    fs::write(&list, "CID01_SID01_VID01.avi,1\nCID09_SID01_VID01.avi,2\n").unwrap();
    train(Some("CID09_SID01_VID01 with the frames of \"CID09_SID01_VID01.avi\""));
    fs::write(&list, "CID01_SID01_VID01.avi,1\n").unwrap();
    train(Some("list.csv: no clip of the class \"Move Backwards While Drilling\""));
    // The list is refused by its size before it is read.
    fs::File::create(&list).unwrap().set_len(1 << 36).unwrap();
    train(Some("list.csv: larger than such a file can be: at most 67108864 bytes"));
}

/// A mirror image of walking left shows walking right.
#[test]
fn mirror_images_are_of_the_mirrored_class() {
    let clips = Clips::new(2, 2);
    fs::rename(
        clips.path("clips/MoveBackwardWhileDrilling"),
        clips.path("clips/MoveLeftWhileDrilling"),
    )
    .unwrap();
    for clip in ["0", "1"] {
        let folder = clips.path(&format!("clips/MoveRightWhileDrilling/{clip}"));
        fs::create_dir_all(&folder).unwrap();
        for frame in ["0.png", "1.png"] {
            let left =
                image::open(clips.path(&format!("clips/MoveLeftWhileDrilling/{clip}/{frame}")));
            left.unwrap().fliph().save(format!("{folder}/{frame}")).unwrap();
        }
    }
    // Left and right only differ by the mirror. They could not be learnt if a label were wrong.
    let json = clips.train().with(&["--json", "--standardise"]).run().done().json();
    assert_eq!(json["training_accuracy"], 1.0, "{json}");
}

#[test]
fn clips_that_cannot_be_learnt_are_named() {
    let clips = Clips::new(2, 2);
    let refused = |says: &str| clips.train().run().failed(1, says);
    // The clip is shorter than a window.
    fs::remove_file(clips.path("clips/DeliverObject/0/1.png")).unwrap();
    fs::remove_file(clips.path("clips/DeliverObject/1/1.png")).unwrap();
    refused("1 frames are fewer than the 2 of a window");
    // A class has one clip; a class has none; there is one class.
    fs::remove_dir_all(clips.path("clips/DeliverObject/1")).unwrap();
    refused("class \"Deliver Object\" has 1 samples: give at least 2");
    fs::remove_dir_all(clips.path("clips/DeliverObject/0")).unwrap();
    refused("DeliverObject: no folders of frames");
    fs::remove_dir_all(clips.path("clips/DeliverObject")).unwrap();
    refused("clips: 1 folders with images, give one for each of at least two classes");
    fs::create_dir_all(clips.path("clips/Move Backwards while drilling/0")).unwrap();
    refused("two folders are of the class \"Move Backwards While Drilling\"");
    assert!(!Path::new(&clips.path("model")).exists());
}

#[test]
fn mismatched_labels_weights_and_caches_are_refused() {
    let clips = Clips::new(2, 3);
    clips.train().run().done();
    let (folder, model, cache) = (clips.path("clips"), clips.path("model"), clips.path("cache"));
    let train = Runs::new("actions").with(&["train", &folder, "-o", &model, "--cache", &cache]);
    let random = train.with(&[
        "--random-backbone=1",
        "--network=slowonly_r18_mm",
        "--length=2",
        "--side=32",
    ]);
    random.run().failed(1, "slowonly_r18_mm.features: the features are of other weights");
    let none = Runs::new("actions").with(&["evaluate", &folder, "--model", &model]);
    none.run().failed(1, "give the model's weights: --weights FILE");
    let other = clips.path("clips/DeliverObject/0/0.png");
    let other = ["evaluate", &folder, "--model", &model, "--weights", &other];
    Runs::new("actions")
        .with(&other)
        .run()
        .failed(1, "but the model was trained with the weights with SHA-256");
    fs::rename(clips.path("clips/DeliverObject"), clips.path("clips/Walking")).unwrap();
    clips.evaluate().run().failed(1, "\"Walking\" is no class of");
}

#[test]
fn an_interrupted_training_keeps_the_features_so_far() {
    let clips = Clips::new(60, 2);
    let ran = clips.train_at("--side=40").interrupt_at("features of clips: ", "INT");
    assert_eq!(ran.code(), Some(130), "{ran:?}");
    assert!(ran.errors.contains("the features so far are kept in"), "{}", ran.errors);
    assert!(!Path::new(&clips.path("model")).exists());
    // There are two views of 512 features each.
    let kept = fs::read(clips.path("cache/slowonly_r18_mm.features")).unwrap();
    assert!(kept.len() > 36 + 8 * 512 + 8, "{}", kept.len());
}

/// There are thirty classes, as in HRI30. Each name is beside a row and below a column. Every share other than zero is
/// in its cell.
#[test]
fn thirty_classes_fit_into_one_figure() {
    let classes = Action::ALL.map(|action| action.name().to_owned());
    let counts = |row: usize| {
        (0..30).map(move |column| if row == column { 25 } else { u64::from(column % 7 == row % 5) })
    };
    let confusion: Vec<Vec<u64>> = (0..30).map(|row| counts(row).collect()).collect();
    let figure = confusion_figure("SlowOnly", &classes, &confusion).unwrap();
    let texts = |figure: &str| figure.matches("<text ").count();
    for class in &classes {
        let shown = figure.lines().filter(|line| line.trim() == class).count();
        assert_eq!(shown, 2, "{class}");
    }
    let numbers = confusion.iter().flatten().filter(|count| **count > 0).count();
    assert_eq!(texts(&figure), 1 + 2 * 30 + numbers);
}
