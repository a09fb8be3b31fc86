//! The program that learns to distinguish surfaces.

use std::{fs, path::Path};

use crate::support::{Runs, resnet18, save_picture};

/// A folder for the tests with pictures of two classes.
struct Pictures(tempfile::TempDir);

impl Pictures {
    fn new(count: u32) -> Self {
        let own = Self(tempfile::tempdir().unwrap());
        for (class, level) in [("drilled", 30), ("smooth", 200)] {
            let folder = own.0.path().join("images").join(class);
            fs::create_dir_all(&folder).unwrap();
            for seed in 0..count {
                save_picture(&folder.join(format!("{seed}.png")), level, seed);
            }
        }
        own
    }

    fn path(&self, name: &str) -> String {
        self.0.path().join(name).to_str().unwrap().to_owned()
    }

    /// The training command with a random network of 18 layers.
    fn train(&self) -> Runs {
        Runs::new("surface")
            .with(&["train", &self.path("images"), "--output", &self.path("model")])
            .with(&[
                "--random-backbone=1",
                "--depth=18",
                "--epochs=20",
                "--threads=2",
                "--cache",
                &self.path("cache"),
            ])
    }

    fn evaluate(&self) -> Runs {
        Runs::new("surface").with(&[
            "evaluate",
            &self.path("images"),
            "--model",
            &self.path("model"),
        ])
    }

    fn cached(&self) -> Runs {
        self.evaluate().with(&["--cache", &self.path("cache")])
    }
}

fn names(folder: &str) -> Vec<String> {
    let mut names: Vec<String> = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    names
}

#[test]
fn trains_evaluates_and_predicts() {
    let pictures = Pictures::new(4);
    let trained = pictures.train().with(&["--json", "--quiet"]).run().done();
    assert_eq!(trained.errors, "");
    let json = trained.json();
    assert_eq!(
        (&json["training_images"], &json["validation_images"], &json["test_images"]),
        (&4.into(), &2.into(), &2.into())
    );
    assert!(json["models"]["resnet18+svm"]["gap"].as_f64().unwrap() <= 1e-9);
    assert_eq!(json["models"]["resnet18+svm"]["validation_accuracy"], 1.0);
    assert_eq!(
        names(&pictures.path("model")),
        ["resnet18-head.safetensors", "resnet18.svm", "surface.json"]
    );

    let out = pictures.path("out");
    let ran = pictures.cached().with(&["--json", "--output", &out]).run().done();
    let json = ran.json();
    for model in ["resnet18", "resnet18+svm"] {
        let own = &json["models"][model];
        assert_eq!((&own["samples"], &own["top5"]), (&2.into(), &1.0.into()), "{json}");
        assert!(ran.output.contains(&format!("\n{model}\n")), "{ran:?}");
    }
    let svm = &json["models"]["resnet18+svm"];
    assert_eq!(
        (&svm["accuracy"], &svm["confusion"]),
        (&1.0.into(), &serde_json::json!([[1, 0], [0, 1]]))
    );
    assert_eq!(
        names(&out),
        [
            "confusion-resnet18+svm.svg",
            "confusion-resnet18.svg",
            "evaluation.json",
            "scores-resnet18+svm.csv",
            "scores-resnet18.csv"
        ]
    );
    let scores = fs::read_to_string(format!("{out}/scores-resnet18+svm.csv")).unwrap();
    let lines: Vec<&str> = scores.lines().collect();
    assert_eq!((lines[0], lines.len()), ("image,class,given,score_drilled,score_smooth", 3));
    assert!(lines[1].starts_with("drilled/") && lines[1].contains(",drilled,drilled,"), "{scores}");
    assert!(fs::read_to_string(format!("{out}/confusion-resnet18.svg")).unwrap().contains("100.0"));

    // Features from disk are those of the network.
    let fresh = pictures.evaluate().with(&["--json"]).run().done();
    assert_eq!(fresh.json()["models"], json["models"]);

    let image = pictures.path("images/smooth/0.png");
    let infer = [&image, "--model", &pictures.path("model"), "--json"];
    let json = Runs::new("infer").with(&infer).run().done().json();
    let own: Vec<_> = json["images"].as_array().unwrap().iter().collect();
    assert_eq!((own.len(), &own[1]["model"]), (2, &"resnet18+svm".into()));
    assert_eq!((&own[1]["class"], &own[1]["image"]), (&"smooth".into(), &image.as_str().into()));
}

#[test]
fn generated_pictures_are_of_their_seed() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    for (name, seed) in [("a", "1"), ("b", "1"), ("c", "2")] {
        let generate =
            ["generate", &path(name), "--count=2", "--size=24", "--seed", seed, "--json"];
        let json = Runs::new("surface").with(&generate).run().done().json();
        assert_eq!((&json["images"], &json["partial"]), (&4.into(), &false.into()));
    }
    let read = |name: &str, image: &str| fs::read(folder.path().join(name).join(image)).unwrap();
    let image = "drilled/00001.png";
    assert_eq!(read("a", image), read("b", image));
    assert_ne!(read("a", image), read("c", image));
    assert_ne!(read("a", image), read("a", "drilled/00000.png"));
    assert_ne!(read("a", image), read("a", "smooth/00001.png"));
    let again = ["generate", &path("a"), "--count=2"];
    Runs::new("surface").with(&again).run().failed(1, "a/smooth: there are files already");
}

#[test]
fn classes_that_cannot_be_learnt_are_named() {
    let pictures = Pictures::new(3);
    let refused = |says: &str| pictures.train().run().failed(1, says);
    let images = pictures.path("images");
    // There is one class only.
    fs::rename(format!("{images}/smooth"), pictures.path("aside")).unwrap();
    refused("images: 1 folders with images, give one for each of at least two classes");
    fs::create_dir(format!("{images}/smooth")).unwrap();
    refused("smooth: no JPEG or PNG files");
    // Each class has one image.
    save_picture(Path::new(&format!("{images}/smooth/0.png")), 200, 1);
    refused("class \"smooth\" has 1 samples: give at least 3");
    for name in ["1.png", "2.png"] {
        fs::write(format!("{images}/smooth/{name}"), "none").unwrap();
    }
    fs::write(format!("{images}/smooth/0.png"), "none").unwrap();
    refused("smooth: no image to train with can be read");
    assert!(!Path::new(&pictures.path("model")).exists());
    let none = Runs::new("surface").with(&["train", &images, "-o", &pictures.path("model")]);
    none.run().failed(1, "no network: give --weights 50=FILE");
}

/// Descriptions never end, have another version, or are of another program.
#[test]
fn models_that_are_none_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let model = folder.path().to_str().unwrap();
    let image = save_picture(&folder.path().join("a.png"), 30, 1);
    for file in ["surface.json", "actions.json"] {
        let path = folder.path().join(file);
        let refused = |says: &str| {
            let ran = Runs::new("infer").with(&[&image, "--model", model]).run();
            assert!(ran.failed(1, says).errors.contains(file));
        };
        refused("there is neither surface.json nor actions.json in it");
        std::os::unix::fs::symlink("/dev/zero", &path).unwrap();
        refused("takes at most 64 MiB");
        fs::remove_file(&path).unwrap();
        fs::write(&path, "{}").unwrap();
        refused("missing field");
        fs::remove_file(&path).unwrap();
    }
}

#[test]
fn mismatched_labels_weights_and_caches_are_refused() {
    let pictures = Pictures::new(3);
    pictures.train().run().done();
    // The features are of another seed.
    let other = pictures.train().with(&["--no-flips"]).run().done();
    assert!(!other.output.is_empty());
    let seed = Runs::new("surface").with(&[
        "train",
        &pictures.path("images"),
        "-o",
        &pictures.path("other"),
    ]);
    let seed =
        seed.with(&["--random-backbone=2", "--depth=18", "--cache", &pictures.path("cache")]);
    seed.run().failed(
        1,
        "resnet18.features: the features are of other weights: of \"resnet18, 255 x 255",
    );
    // A checkpoint replaces the random network.
    let weights = format!("--weights=18={}", resnet18());
    pictures
        .evaluate()
        .with(&[&weights])
        .run()
        .failed(1, "but the model was trained with random weights of seed 1");
    // There is one class too many, then one too few.
    let images = pictures.path("images");
    fs::create_dir(format!("{images}/rusty")).unwrap();
    pictures.evaluate().run().failed(1, "the folder \"rusty\" is no class of");
    fs::rename(format!("{images}/smooth"), format!("{images}/rusty/smooth")).unwrap();
    fs::rename(format!("{images}/rusty"), pictures.path("rusty")).unwrap();
    fs::create_dir(format!("{images}/more")).unwrap();
    pictures.evaluate().run().failed(1, "the folder \"more\" is no class of");
    fs::remove_dir(format!("{images}/more")).unwrap();
    fs::create_dir(format!("{images}/smooth")).unwrap();
    pictures.evaluate().run().failed(1, "smooth: no JPEG or PNG files");
    // The file is not a cache.
    save_picture(Path::new(&format!("{images}/smooth/9.png")), 200, 1);
    fs::write(pictures.path("cache/resnet18.features"), "what else\n").unwrap();
    let cached = pictures.cached().with(&["--part=all"]).run();
    cached.failed(1, "resnet18.features: no file of features");
}

#[test]
fn an_interrupted_training_keeps_the_features_so_far() {
    let pictures = Pictures::new(40);
    let ran = pictures.train().interrupt_at("features of resnet18: ", "INT");
    assert_eq!(ran.code(), Some(130), "{ran:?}");
    assert!(ran.errors.contains("the features so far are kept in"), "{}", ran.errors);
    assert!(!Path::new(&pictures.path("model")).exists());
    let cache = pictures.path("cache/resnet18.features");
    let kept = fs::read(&cache).unwrap();
    // An incomplete record is dropped, the others count: each has 512 features.
    let head = kept.iter().take_while(|byte| **byte != b'\n').count() + 1;
    let head = head + kept[head..].iter().take_while(|byte| **byte != b'\n').count() + 1;
    let record = 36 + 4 * 512 + 8;
    let records = (kept.len() - head) / record;
    assert!(
        records > 0 && records < 112 && (kept.len() - head).is_multiple_of(record),
        "{records}"
    );
    fs::write(&cache, &kept[..kept.len() - 5]).unwrap();
    let images = pictures.path("images");
    for class in ["smooth", "drilled"] {
        for seed in 3..40 {
            fs::remove_file(format!("{images}/{class}/{seed}.png")).unwrap();
        }
    }
    pictures.train().run().done();
    let grown = fs::read(&cache).unwrap();
    assert_eq!(grown[..kept.len() - record], kept[..kept.len() - record]);
    assert_eq!((grown.len() - head) % record, 0);
}

#[test]
fn outputs_are_checked_before_the_work() {
    let pictures = Pictures::new(3);
    let file = pictures.path("images/smooth/0.png");
    let train = Runs::new("surface").with(&["train", "/nope", "-o", &file, "--random-backbone=1"]);
    train.run().failed(1, "it is a file; give a folder");
    pictures.evaluate().with(&["--output", &file]).run().failed(1, "it is a file; give a folder");
    let generate = Runs::new("surface").with(&["generate", &format!("{file}/x")]);
    generate.run().failed(1, "it is a file; give a folder");
}
