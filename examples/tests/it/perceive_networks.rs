//! `perceive` with networks: joints, surface and action, each with its times of capture and recognition.

use std::{collections::BTreeMap, path::Path};

use human_perception::{
    actions::{model::ActionModel, window::Window},
    learning::backbone::WeightsIdentity,
    surface::model::{OverNetwork, SurfaceModel},
};
use nalgebra::Point2;
use ndarray::{Array1, Array2};
use percept_recording::{IfPartial, Recording};
use vision_models::{
    Camera, DepthImage, DepthNoise, Intrinsics, LinearHead, LinearSvm, PersonBox, ResNetDepth,
    Surface,
};

use crate::support::{Runs, resnet18, simple_baseline, slow_only_r18};

/// Makes a short small film of a working person. Returns its folder.
fn film(folder: &Path) -> String {
    let frames = folder.join("frames").to_str().unwrap().to_owned();
    let film = ["--frames", &frames, "--size=160x120", "--duration=1.2", "--drop=0"];
    Runs::new("record").with(&film).run().done();
    frames
}

/// Makes a model of surfaces over a random ResNet-18. Its support vector machine takes every surface for a smooth one,
/// its layer for a drilled one.
fn surface_model(folder: &Path) -> String {
    let classes = vec!["drilled".to_owned(), "smooth".to_owned()];
    let (none, bias) = (Array2::zeros((1, 512)), Array1::from_elem(1, 0.7));
    let layer = Array2::zeros((2, 512));
    let network = OverNetwork {
        depth: ResNetDepth::Eighteen,
        weights: WeightsIdentity::RandomSeed(1),
        head: LinearHead::new(classes.clone(), layer, Array1::from_vec(vec![1.0, 0.0])).unwrap(),
        svm: LinearSvm::new(classes.clone(), none, bias).unwrap(),
    };
    let folder = folder.join("surface");
    let model = SurfaceModel { classes, parts: BTreeMap::new(), networks: vec![network] };
    model.write(&folder).unwrap();
    folder.to_str().unwrap().to_owned()
}

/// Makes a model of actions over a random SlowOnly-R18, which always gives the classes the same logits.
fn action_model(folder: &Path, logits: &[(&str, f32)]) -> String {
    let classes = logits.iter().map(|(class, _)| (*class).to_owned()).collect();
    let biases = logits.iter().map(|(_, logit)| *logit).collect();
    let head = LinearHead::new(classes, Array2::zeros((logits.len(), 512)), biases).unwrap();
    let network = "slowonly_r18_mm".to_owned();
    let window = Window { network, length: 2, interval: 8, side: 32 };
    let (weights, parts) = (WeightsIdentity::RandomSeed(1), BTreeMap::new());
    let folder = folder.join("action");
    ActionModel { head, window, weights, parts }.write(&folder).unwrap();
    folder.to_str().unwrap().to_owned()
}

fn read(file: &str) -> Recording {
    Recording::read(percept_recording::open(file).unwrap(), IfPartial::Refuse).unwrap()
}

/// `perceive` with the skeletons of the film.
fn perceive(frames: &str, output: &str) -> Runs {
    let skeletons = format!("{frames}/skeletons");
    let options = ["--skeletons", &skeletons, "--output", output, "--json", "--quiet"];
    Runs::new("perceive").with(&[frames]).with(&options)
}

#[test]
fn surfaces_and_actions_come_with_their_own_ages() {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("p.jsonl").to_str().unwrap().to_owned();
    let frames = film(folder.path());
    let model = surface_model(folder.path());
    let networks = [
        "--surface-model",
        &model,
        "--surface-interval=8",
        "--action-weights",
        slow_only_r18(),
        "--action-network=slowonly_r18_mm",
        "--action-length=2",
        "--action-interval=8",
    ];
    let ran = perceive(&frames, &output).with(&networks).run().done();
    let json = ran.json();
    assert_eq!((&json["frames"], &json["with_surface"]), (&25.into(), &25.into()));
    assert_eq!(json["with_action"], 17, "from the second frame of a clip on");
    for stage in ["poses", "surface", "action"] {
        assert!(json[stage]["median_us"].as_f64().unwrap() > 0.0, "{stage}");
    }
    let recording = read(&output);
    for (percept, timing) in recording.percepts.iter().zip(&recording.timings) {
        let surface = percept.surface.unwrap();
        assert_eq!(surface.surface, Surface::Smooth);
        assert!((surface.confidence.value() - 1.0 / (1.0 + (-0.7_f64).exp())).abs() < 1e-3);
        // Every eighth frame, 0.4 s apart, is examined. The result is known after the camera took the image.
        let age = |captured: f64| percept.time - captured;
        let captured = timing.surface.captured.unwrap();
        assert!((0.0..0.4).contains(&age(captured)) && timing.surface.arrived.unwrap() > captured);
        assert_eq!(percept.action.is_some(), timing.action.arrived.is_some());
        assert!(timing.arrived.unwrap() > percept.time);
        assert!(timing.action.captured.is_none_or(|captured| (0.0..0.4).contains(&age(captured))));
    }
    // The recording can be played.
    let follow = Runs::follow().with(&["--no-report", "--stature=1.75", "--recording", &output]);
    follow.run().done();
}

/// The controller need not know the tool. The probability that the person works counts.
#[test]
fn trained_models_are_compared_with_the_truth() {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("p.jsonl").to_str().unwrap().to_owned();
    let frames = film(folder.path());
    let truth = format!("{frames}/truth.jsonl");
    let surface = surface_model(folder.path());
    let perceive = |logits: &[(&str, f32)]| {
        let action = action_model(folder.path(), logits);
        let models = ["--surface-model", &surface, "--action-model", &action, "--truth", &truth];
        let options = ["--surface-decision=head", "--surface-interval=100"];
        let ran = perceive(&frames, &output).with(&models).with(&options).run().done();
        assert!(ran.output.contains("\nagainst the truth: surface "), "{ran:?}");
        (ran.json()["truth"].clone(), read(&output).percepts.pop().unwrap())
    };
    // A person who carries the object shows no surface. The window is full in the ninth of 25 frames.
    let carrying =
        [("Walking With Object", 1.0), ("Using The Drill", 0.9), ("Using The Polisher", 0.8)];
    let (json, percept) = perceive(&carrying);
    assert_eq!((&json["surface_right"], &json["delay"]), (&serde_json::Value::Null, &0.5.into()));
    assert_eq!(json["action_right"], 0.0);
    // The intention is apart until work has been seen for 0.2 s.
    assert!((0.3..0.9).contains(&json["intention_right"].as_f64().unwrap()), "{json}");
    let seen = percept.action.unwrap();
    assert_eq!(seen.action.name(), "Using The Drill");
    let [one, other, rest] = [0.9_f64, 0.8, 1.0].map(f64::exp);
    let sum = (one + other) / (one + other + rest);
    assert!((seen.confidence.value() - sum).abs() < 1e-3, "{seen:?}");
    let carrying =
        [("Walking With Object", 2.0), ("Using The Drill", 0.7), ("Using The Polisher", 0.6)];
    let (json, percept) = perceive(&carrying);
    assert_eq!((&json["action_right"], &json["intention_right"]), (&0.68.into(), &1.0.into()));
    assert_eq!(percept.surface.unwrap().surface, Surface::Drilled);
}

#[test]
fn models_that_do_not_fit_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("p.jsonl").to_str().unwrap().to_owned();
    let frames = film(folder.path());
    let refused = |options: &[&str], code: i32, says: &str| {
        perceive(&frames, &output).with(options).run().failed(code, says);
        assert!(!Path::new(&output).exists());
    };
    let action = action_model(folder.path(), &[("Walking", 0.0), ("Dancing", 0.0)]);
    refused(&["--action-model", &action], 1, "unknown action \"Dancing\"");
    let surface = surface_model(folder.path());
    refused(&["--surface-model", &surface, "--surface-depth=50"], 1, "networks of 18 layers");
    let [weights, file] = ["--surface-weights", resnet18()];
    let says = "but the model was trained with random weights of seed 1";
    refused(&[weights, file, "--surface-model", &surface], 1, says);
    let says = "the network has 7 classes, not drilled and smooth";
    refused(&[weights, file, "--surface-depth=18"], 1, says);
    refused(&["--action-model", &action, "--action-length=3"], 2, "cannot be used with");
    refused(&["--truth", &output], 1, "p.jsonl");
}

#[test]
fn a_pose_network_stands_in_for_skeletons() {
    let folder = tempfile::tempdir().unwrap();
    let frames = film(folder.path());
    let index = Path::new(&frames).join("frames.jsonl");
    let lines = std::fs::read_to_string(&index).unwrap();
    // One frame suffices for a network that takes 11 GFLOP.
    let first = lines.lines().next().unwrap();
    std::fs::write(&index, format!("{first}\n")).unwrap();
    let output = folder.path().join("p.jsonl").to_str().unwrap().to_owned();
    let with = |weights: &str| {
        let options = ["--pose-weights", weights, "--output", &output, "--json", "--quiet"];
        Runs::new("perceive").with(&[&frames]).with(&options).run()
    };
    let json = with(simple_baseline()).done().json();
    assert_eq!((&json["frames"], &json["without_skeletons"]), (&1.into(), &0.into()));
    assert!(json["poses"]["median_us"].as_f64().unwrap() > 1000.0, "{json}");
    let says = "this is a ResNet-18: give the weights of a simple baseline or of OpenPose";
    with(resnet18()).failed(1, says);
}

/// A person stands in front of a wall beside a box. They are found in the depth image and where a tracker expects them.
#[test]
fn a_person_is_found_without_a_detector() {
    let size = [160, 120];
    let intrinsics = Intrinsics::new(size, [150.0, 150.0], [79.5, 59.5]).unwrap();
    let (eye, target) =
        (nalgebra::Point3::new(0.0, 0.0, 1.2), nalgebra::Point3::new(3.0, 0.0, 1.2));
    let camera = Camera::looking_at(intrinsics, eye, target, DepthNoise::D435I).unwrap();
    // A pixel is 2 cm at 3 m. The person is 0.5 m wide and from 0.3 to 1.8 m high, the box 0.4 m high.
    let at = |column: usize, row: usize| match (column, row) {
        (70..95, 30..105) => 3.0,
        (110..135, 85..105) => 2.0,
        _ => 5.0,
    };
    let depths = (0..size[0] * size[1]).map(|index| at(index % size[0], index / size[0])).collect();
    let depth = DepthImage::from_metres(size, depths).unwrap();
    let found = PersonBox::nearest(&camera, &depth).unwrap();
    assert_eq!((found.left, found.top, found.width, found.height), (70.0, 30.0, 24.0, 74.0));
    let nobody = DepthImage::from_metres(size, vec![5.0; size[0] * size[1]]).unwrap();
    assert_eq!(PersonBox::nearest(&camera, &nobody), None);

    let expected = PersonBox::around(&camera, &Point2::new(3.0, -0.05), 1.75).unwrap();
    assert!(expected.left <= 70.0 && expected.left + expected.width >= 95.0, "{expected:?}");
    assert!(expected.top <= 34.0 && expected.top + expected.height >= 105.0, "{expected:?}");
    assert_eq!(
        PersonBox::around(&camera, &Point2::new(-3.0, 0.0), 1.75),
        None,
        "behind the camera"
    );
}

/// The networks find a person where everything is white, with their landmarks along a line.
#[test]
fn blaze_pose_is_a_pose_network() {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("p.jsonl").to_str().unwrap().to_owned();
    let frames = film(folder.path());
    for image in Path::new(&frames).join("colour").read_dir().unwrap() {
        let white = image::RgbImage::from_pixel(160, 120, image::Rgb([255; 3]));
        white.save(image.unwrap().path()).unwrap();
    }
    let data = concat!(env!("CARGO_MANIFEST_DIR"), "/../vision-models/tests/data");
    let landmarks = format!("{data}/blaze_landmarks.tflite");
    let detector = format!("--pose-detector={data}/blaze_detector.tflite");
    let options = ["--pose", &landmarks, "--output", &output, "--json", "--quiet"];
    let perceive = || Runs::new("perceive").with(&[&frames]).with(&options);
    let json = perceive().with(&[&detector, "--pose-people=2"]).run().done().json();
    assert_eq!((&json["frames"], &json["without_skeletons"]), (&25.into(), &0.into()));
    assert!(json["poses"]["median_us"].as_f64().unwrap() > 0.0);
    let missing = "pose_solution_packed_assets.data";
    perceive().run().failed(1, missing);
}
