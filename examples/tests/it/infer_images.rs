//! Networks over images.

use std::fs;

use serde_json::Value;
use vision_models::{Checkpoint, Options, Preprocessing, ResNet, ResNetDepth, read_image, softmax};

use crate::support::{Runs, png_that_claims, resnet18, save_picture};

const NAMES: &str = "Cardigan\nbeach\ncardigan\ndrill\nhammer\nlamp\nsaw\n";

/// The program with the small network.
fn infer() -> Runs {
    Runs::new("infer").with(&["--weights", resnet18()])
}

#[test]
fn prints_the_most_probable_classes() {
    let folder = tempfile::tempdir().unwrap();
    let image = save_picture(&folder.path().join("a.png"), 90, 1);
    let names = folder.path().join("names.txt");
    fs::write(&names, format!("\u{feff}{NAMES}")).unwrap();

    let ran = infer().with(&[&image, "--json", "--names", names.to_str().unwrap()]).run().done();
    let json = ran.json();
    assert_eq!((&json["partial"], &json["unreadable"]), (&false.into(), &0.into()));
    let classes = json["images"][0]["classes"].as_array().unwrap();

    let preprocessing = Preprocessing::TORCHVISION;
    let weights = Checkpoint::open(resnet18()).unwrap();
    let mut network =
        ResNet::load(ResNetDepth::Eighteen, weights, [224, 224], Options::default()).unwrap();
    let pixels = preprocessing.image(read_image(&image).unwrap().view()).unwrap();
    let scores = network.infer(pixels.view()).unwrap().logits;
    let probabilities = softmax(&scores.iter().copied().collect::<Vec<_>>());
    let mut order: Vec<usize> = (0..7).collect();
    order.sort_by(|&one, &other| probabilities[other].total_cmp(&probabilities[one]));

    let names: Vec<&str> = NAMES.lines().collect();
    let mut lines = ran.output.lines();
    assert_eq!(lines.next(), Some(image.as_str()));
    for (rank, (class, expected)) in classes.iter().zip(&order).enumerate() {
        let probability = probabilities[*expected];
        assert_eq!(class["class"], *expected);
        assert_eq!(class["name"], names[*expected]);
        assert!((class["probability"].as_f64().unwrap() - f64::from(probability)).abs() < 1e-6);
        let (rank, name) = (rank + 1, names[*expected]);
        let line = format!("{rank}  {:6.2} %  {name}", 100.0 * probability);
        assert_eq!(lines.next(), Some(line.as_str()));
    }
    assert_eq!(classes.len(), 5);
}

#[test]
fn unreadable_image_only_fails_the_exit_status() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let (one, two) = (save_picture(&path("1.png"), 30, 1), save_picture(&path("2.png"), 60, 2));
    let none = path("none.png").to_str().unwrap().to_owned();
    let ran = infer().with(&[&one, &none, &two, "--json"]).run();
    assert_eq!(ran.code(), Some(1), "{ran:?}");
    assert!(ran.errors.contains(&format!("left out: {none}: No such file")), "{ran:?}");
    let images: Vec<Value> =
        ran.json()["images"].as_array().unwrap().iter().map(|i| i["image"].clone()).collect();
    assert_eq!(images, [one.as_str(), &two]);
}

/// A file of 33 kB claims 16,384 × 16,384 pixels, which would take 1.7 GB.
#[test]
fn small_file_with_large_claim_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("huge.png");
    fs::write(&path, png_that_claims(16_384, 16_384)).unwrap();
    let ran =
        Runs::within("infer", 512).with(&["--weights", resnet18(), path.to_str().unwrap()]).run();
    let says =
        "huge.png: no JPEG or PNG image that can be read: 16384 × 16384 pixels take 1024 MiB";
    ran.failed(1, says);
}

#[test]
fn a_wrong_depth_is_told_in_one_line() {
    let wrong = ["--weights", resnet18(), "--model=resnet50", "none.png"];
    let wrong = Runs::new("infer").with(&wrong).run();
    assert_eq!(
        wrong.errors,
        format!("error: {}: this is a ResNet-18: try --model resnet18\n", resnet18())
    );
    wrong.failed(1, "");
}

#[test]
fn threads_are_from_1_to_1024() {
    for (threads, says) in [
        ("0", "0 is not in 1..=1024"),
        ("1025", "1025 is not in 1..=1024"),
        ("40000", "40000 is not in 1..=1024"),
        ("100000", "'100000' for '--threads"),
        ("18446744073709551615", "'18446744073709551615' for '--threads"),
    ] {
        let threads = format!("--threads={threads}");
        infer().with(&["none.png", &threads]).run().failed(2, says);
    }
}

/// The weights do not exist either: outputs are checked before inputs.
#[test]
fn outputs_are_checked_before_the_work() {
    let none = || Runs::new("infer").with(&["--weights=/nope/weights.pth"]);
    let says = "cannot write /nope/out.txt: there is no folder /nope";
    none().with(&["a.png", "--output=/nope/out.txt"]).run().failed(1, says);
}

#[test]
fn results_go_to_a_file_if_asked() {
    let folder = tempfile::tempdir().unwrap();
    let image = save_picture(&folder.path().join("a.png"), 90, 1);
    let out = folder.path().join("out.txt");
    let ran = infer().with(&[&image, "--json", "-o", out.to_str().unwrap()]).run().done();
    let (whole, alone) = (ran.json(), ran.output.lines().count());
    assert_eq!((alone, whole["images"][0]["image"].as_str()), (1, Some(image.as_str())));
    let text = fs::read_to_string(out).unwrap();
    assert!(text.starts_with(&format!("{image}\n1  ")) && text.lines().count() == 6, "{text}");
}

#[test]
fn an_interrupt_keeps_the_images_so_far() {
    let folder = tempfile::tempdir().unwrap();
    let image = save_picture(&folder.path().join("a.png"), 90, 1);
    let out = folder.path().join("out.txt");
    let many = vec![image.as_str(); 20_000];
    let ran = infer()
        .with(&many)
        .with(&["--json", "-o", out.to_str().unwrap()])
        .interrupt_at("images: ", "INT");
    assert_eq!(ran.code(), Some(130), "{ran:?}");
    let json = ran.json();
    let count = json["images"].as_array().unwrap().len();
    assert!(json["partial"] == true && (1..20_000).contains(&count), "{count}");
    assert!(!out.exists());
    let kept = fs::read_to_string(folder.path().join("out.partial.txt")).unwrap();
    assert_eq!(kept.lines().count(), 6 * count);
    assert!(ran.errors.contains("interrupted: "), "{}", ran.errors);
}

#[test]
fn names_that_do_not_fit_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    fs::write(path("clash.txt"), "Walking\nrun\n\nwalk\nWalk_ing\n").unwrap();
    let clash = "clash.txt: label file, lines 1 and 5: \"Walking\" and \"Walk_ing\" are one name";
    let none = ["a.png", "--weights=/nope/weights.pth", "--names", &path("clash.txt")];
    Runs::new("infer").with(&none).run().failed(1, clash);
    fs::write(path("two.txt"), "a\nb\n").unwrap();
    let says = "two.txt: 2 names, but the network has 7 classes";
    infer().with(&["a.png", "--names", &path("two.txt")]).run().failed(1, says);
}

#[test]
fn strict_program_ends_at_first_unreadable_image() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    fs::write(path("broken.png"), "no image").unwrap();
    let strict = infer().with(&[&path("broken.png"), "--strict"]).run();
    strict.failed(1, "broken.png: no JPEG or PNG image");
}
