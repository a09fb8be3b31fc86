//! BlazePose on networks with its inputs and outputs that only read a few pixels
//! (`data/blaze_pose.py`).

use nalgebra::Point2;
use ndarray::Array3;
use vision_models::{
    BlazePose, BlazePoseSettings, Body25, Error, Options, PoseRegion, TensorFlowLite, nalgebra,
    ndarray,
};

fn open(name: &str) -> TensorFlowLite {
    let path = format!("{}/tests/data/{name}.tflite", env!("CARGO_MANIFEST_DIR"));
    TensorFlowLite::open(path).unwrap()
}

fn load(most: usize) -> BlazePose {
    let settings = BlazePoseSettings { most, ..BlazePoseSettings::default() };
    let (detector, landmarks) = (open("blaze_detector"), open("blaze_landmarks"));
    BlazePose::load(detector, landmarks, settings, Options::default()).unwrap()
}

/// Returns the region around a person whose pixel in the detector's input is this one.
///
/// The cell of the pixel has forty-six numbers. The first of them belongs to an anchor at another
/// position: two every eight pixels, then two every sixteen.
fn region([row, column]: [usize; 2]) -> PoseRegion {
    let index = 46 * (row / 32 * 7 + column / 32);
    let (index, side, step) =
        if index < 1568 { (index, 28, 8.0) } else { (index - 1568, 14, 16.0) };
    let middle = |cell: usize| (cell as f64 + 0.5) * step;
    let hips = Point2::new(middle(index / 2 % side), middle(index / 2 / side));
    PoseRegion::around(&[hips, Point2::new(hips.x, hips.y - 56.0)])
}

/// Returns a black image with the pixels that the detector reads, and with the corners of the
/// people's regions.
fn image(detected: &[[usize; 2]], present: &[[usize; 2]]) -> Array3<u8> {
    let mut image = Array3::zeros((224, 224, 3));
    for &[row, column] in detected {
        image.slice_mut(ndarray::s![row, column, ..]).fill(255);
    }
    for &person in present {
        let PoseRegion { centre, side, .. } = region(person);
        let near = |pixel: usize, place: f64| (pixel as f64 - (place - 0.5 * side)).abs() < 2.5;
        for ((row, column, _), value) in image.indexed_iter_mut() {
            if near(row, centre.y) && near(column, centre.x) {
                *value = 255;
            }
        }
    }
    image
}

const ONE: [usize; 2] = [64, 96];
const OTHER: [usize; 2] = [160, 160];

#[test]
fn landmarks_are_where_their_region_is() {
    let mut network = load(1);
    let seen = image(&[ONE], &[ONE]);
    let found = network.detect(seen.view()).unwrap();
    assert_eq!(found.len(), 1);
    assert!((found[0].centre - region(ONE).centre).norm() < 1e-4, "{found:?}");
    assert!((found[0].side - 140.0).abs() < 1e-4 && found[0].angle.abs() < 1e-6);

    let people = network.estimate(0.0, seen.view()).unwrap();
    let [person] = &people[..] else { panic!("{people:?}") };
    assert!(person.score.value() > 0.99);
    for (index, landmark) in person.points.iter().enumerate() {
        let index = index as f64;
        let place = [64.0, 32.0].map(|first| (first + 4.0 * index) / 256.0 * 140.0);
        let place = Point2::new(150.0 + place[0], 38.0 + place[1]);
        assert!((landmark.position - place).norm() < 1e-3, "{landmark:?}, not {place}");
        assert!((landmark.depth - 16.0 / 256.0 * 140.0).abs() < 1e-3);
        assert!(
            (landmark.metric.coords - nalgebra::vector![index / 64.0, index / 32.0, 1.0]).norm()
                < 1e-3
        );
        assert!((landmark.visibility.value() - 1.0 / (1.0 + (-4_f64).exp())).abs() < 1e-6);
        assert!(landmark.presence > landmark.visibility);
    }
    let body = person.body().image;
    let at = |joint| body.get(joint).map(|keypoint| keypoint.position);
    assert_eq!(at(Body25::LeftShoulder), Some(person.points[11].position));
    assert_eq!(at(Body25::RightBigToe), Some(person.points[32].position));
    let neck = nalgebra::center(&person.points[11].position, &person.points[12].position);
    assert_eq!(at(Body25::Neck), Some(neck));
    assert_eq!(at(Body25::LeftSmallToe), None);
}

#[test]
fn people_are_followed_without_detector_until_gone() {
    let mut network = load(1);
    assert!(network.estimate(0.0, image(&[], &[ONE]).view()).unwrap().is_empty());
    assert_eq!(network.estimate(0.1, image(&[ONE], &[ONE]).view()).unwrap().len(), 1);
    for frame in 2..5 {
        let time = 0.1 * f64::from(frame);
        assert_eq!(network.estimate(time, image(&[], &[ONE]).view()).unwrap().len(), 1);
    }
    assert!(network.estimate(0.5, image(&[], &[]).view()).unwrap().is_empty());
    assert!(network.estimate(0.6, image(&[], &[ONE]).view()).unwrap().is_empty());
    network.estimate(0.7, image(&[ONE], &[ONE]).view()).unwrap();
    network.forget();
    assert!(network.estimate(0.8, image(&[], &[ONE]).view()).unwrap().is_empty());
}

#[test]
fn several_people_are_followed_each_once() {
    let both = image(&[ONE, OTHER], &[ONE, OTHER]);
    assert_eq!(load(1).estimate(0.0, both.view()).unwrap().len(), 1);
    let mut network = load(3);
    for frame in 0..3 {
        let people = network.estimate(0.1 * f64::from(frame), both.view()).unwrap();
        assert_eq!(people.len(), 2, "frame {frame}");
    }
}

#[test]
fn other_networks_settings_and_images_are_refused() {
    let settings = BlazePoseSettings::default();
    let swapped = BlazePose::load(
        open("blaze_landmarks"),
        open("blaze_detector"),
        settings,
        Options::default(),
    );
    let error = swapped.unwrap_err();
    assert!(error.to_string().contains("no detector of BlazePose"), "{error}");
    for wrong in [
        BlazePoseSettings { most: 0, ..settings },
        BlazePoseSettings { detection: f64::NAN, ..settings },
        BlazePoseSettings { presence: 1.5, ..settings },
    ] {
        assert!(matches!(wrong.validate(), Err(Error::Value { .. })), "{wrong:?}");
    }
    let mut network = load(1);
    let empty = Array3::zeros((0, 4, 3));
    assert!(matches!(network.estimate(0.0, empty.view()), Err(Error::Size { .. })));
    let nowhere = PoseRegion { side: 0.0, ..region(ONE) };
    let refused = network.landmarks(image(&[], &[]).view(), &nowhere);
    assert!(matches!(refused, Err(Error::Value { .. })));
}
