//! `perceive` with networks: joints, surface and action, each with when it was seen and known.

use std::path::Path;

use examples::recording::{IfPartial, Recording};
use nalgebra::Point2;
use ndarray::{Array1, Array2};
use vision_models::{
    Camera, DepthImage, DepthNoise, Intrinsics, LinearHead, LinearSvm, PersonBox, Surface,
};

use crate::support::{Runs, resnet18, simple_baseline, slow_only_r18};

/// A short film of somebody who works, small: its folder.
fn film(folder: &Path) -> String {
    let frames = folder.join("frames").to_str().unwrap().to_owned();
    let film = ["--frames", &frames, "--size=160x120", "--duration=1.2", "--drop=0"];
    Runs::new("record").with(&film).run().done();
    frames
}

#[test]
fn surfaces_and_actions_come_with_their_own_ages() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let frames = film(folder.path());
    // A machine that takes every surface for a smooth one.
    let svm = LinearSvm::new(
        vec!["drilled".into(), "smooth".into()],
        Array2::zeros((1, 512)),
        Array1::from_elem(1, 0.7),
    );
    std::fs::write(path("surface.svm"), svm.unwrap().to_string()).unwrap();
    let (skeletons, output, svm) =
        (format!("{frames}/skeletons"), path("p.jsonl"), path("surface.svm"));
    let options = [
        &frames,
        "--skeletons",
        &skeletons,
        "--output",
        &output,
        "--json",
        "--quiet",
        "--surface-weights",
        resnet18(),
        "--surface-depth=18",
        "--surface-svm",
        &svm,
        "--surface-interval=8",
        "--action-weights",
        slow_only_r18(),
        "--action-model=slowonly_r18_mm",
        "--action-length=2",
        "--action-interval=8",
    ];
    let ran = Runs::new("perceive").with(&options).run().done();
    let json = ran.json();
    assert_eq!((&json["frames"], &json["with_surface"]), (&25.into(), &25.into()));
    assert_eq!(json["with_action"], 17, "from the second frame of a clip on");
    for stage in ["poses", "surface", "action"] {
        assert!(json[stage]["median_us"].as_f64().unwrap() > 0.0, "{stage}");
    }
    let reader = examples::recording::open(&output).unwrap();
    let recording = Recording::read(reader, IfPartial::Refuse).unwrap();
    for (percept, timing) in recording.percepts.iter().zip(&recording.timings) {
        let surface = percept.surface.unwrap();
        assert_eq!(surface.surface, Surface::Smooth);
        assert!((surface.confidence.value() - 1.0 / (1.0 + (-0.7_f64).exp())).abs() < 1e-3);
        // Looked at every eighth frame, 0.4 s apart, and known after the camera took the image.
        let age = |captured: f64| percept.time - captured;
        let captured = timing.surface.captured.unwrap();
        assert!((0.0..0.4).contains(&age(captured)) && timing.surface.arrived.unwrap() > captured);
        assert_eq!(percept.action.is_some(), timing.action.arrived.is_some());
        assert!(timing.arrived.unwrap() > percept.time);
        assert!(timing.action.captured.is_none_or(|captured| (0.0..0.4).contains(&age(captured))));
    }
    // It plays.
    let follow = Runs::follow().with(&["--no-report", "--stature=1.75", "--recording", &output]);
    follow.run().done();

    // A head in the SVM's place.
    let head = LinearHead::random(vec!["drilled".into(), "smooth".into()], 512, 1).unwrap();
    let file = std::fs::File::create(path("head.safetensors")).unwrap();
    head.tensors("fc").unwrap().write_safetensors(file).unwrap();
    let options = [
        &frames,
        "--skeletons",
        &skeletons,
        "--output",
        &output,
        "--json",
        "--quiet",
        "--surface-weights",
        resnet18(),
        "--surface-depth=18",
        "--surface-head",
        &path("head.safetensors"),
        "--surface-interval=100",
    ];
    let ran = Runs::new("perceive").with(&options).run().done();
    assert_eq!((&ran.json()["with_surface"], &ran.json()["with_action"]), (&25.into(), &0.into()));
}

#[test]
fn a_pose_network_stands_in_for_skeletons() {
    let folder = tempfile::tempdir().unwrap();
    let frames = film(folder.path());
    let index = Path::new(&frames).join("frames.jsonl");
    let lines = std::fs::read_to_string(&index).unwrap();
    // One frame is enough for a network that costs 11 GFLOP.
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

/// Somebody who stands before a wall, beside a box, is found in the depth image and where a tracker
/// expects them.
#[test]
fn a_person_is_found_without_a_detector() {
    let size = [160, 120];
    let intrinsics = Intrinsics::new(size, [150.0, 150.0], [79.5, 59.5]).unwrap();
    let (eye, target) =
        (nalgebra::Point3::new(0.0, 0.0, 1.2), nalgebra::Point3::new(3.0, 0.0, 1.2));
    let camera = Camera::looking_at(intrinsics, eye, target, DepthNoise::D435I).unwrap();
    // At 3 m a pixel is 2 cm: the person is 0.5 m wide and from 0.3 to 1.8 m high, the box 0.4 m high.
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
