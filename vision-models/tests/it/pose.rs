//! The pose networks agree with PyTorch and find the contents of an image.

use ndarray::{Array3, Array4, ArrayView4};
use serde::Deserialize;
use vision_models::{
    Body25, Error, GroupingSettings, OpenPose, OpenPoseForm, Options, Passes, PersonBox,
    SimpleBaseline, SimpleBaselineForm, Tensor, Tensors,
};

use crate::support::{input, weights};

/// Tolerance relative to the largest value.
const TOLERANCE: f32 = 5e-6;

/// A network's maps, computed by `data/pose.py`.
#[derive(Deserialize)]
struct Golden {
    shape: [usize; 4],
    maps: Vec<GoldenMap>,
}

#[derive(Deserialize)]
struct GoldenMap {
    shape: [usize; 4],
    largest: f32,
    /// Every seventh value.
    values: Vec<f32>,
}

fn golden<T: serde::de::DeserializeOwned>(name: &str) -> T {
    let all = include_str!("../data/pose.json");
    let mut all: serde_json::Map<String, serde_json::Value> = serde_json::from_str(all).unwrap();
    serde_json::from_value(all.remove(name).unwrap()).unwrap()
}

impl Golden {
    fn images(&self) -> Array4<f32> {
        input(self.shape)
    }
}

impl GoldenMap {
    fn check(&self, map: ArrayView4<'_, f32>) {
        assert_eq!(map.shape(), self.shape);
        assert_eq!(map.len().div_ceil(7), self.values.len());
        for (&value, expected) in map.iter().step_by(7).zip(&self.values) {
            let error = (value - expected).abs() / self.largest;
            assert!(error <= TOLERANCE, "{value} instead of {expected}: {error}");
        }
    }
}

fn options() -> Options {
    Options { threads: 2, ..Options::default() }
}

#[test]
fn simple_baseline_agrees_with_pytorch() {
    let golden: Golden = golden("simple_baseline");
    let tensors = weights(SimpleBaseline::parameters(SimpleBaselineForm::Microsoft));
    let mut network = SimpleBaseline::load(tensors, Passes::One, options()).unwrap();
    golden.maps[0].check(network.heatmaps(golden.images().view()).unwrap());
}

#[test]
fn open_pose_agrees_with_pytorch() {
    let golden: Golden = golden("open_pose");
    let [_, _, height, width] = golden.shape;
    let tensors = weights(OpenPose::parameters(OpenPoseForm::Caffe));
    let mut network = OpenPose::load(tensors, [height, width], options()).unwrap();
    let images = golden.images();
    let maps = network.maps(images.view()).unwrap();
    for (golden, map) in golden.maps.iter().zip(maps) {
        golden.check(map);
    }
}

/// The same tensors under other names are the same network.
#[test]
fn checkpoints_are_known_by_their_names() {
    let microsoft = SimpleBaseline::parameters(SimpleBaselineForm::Microsoft);
    for (form, backbone, head) in [
        (SimpleBaselineForm::MmPose0, "backbone.", "keypoint_head."),
        (SimpleBaselineForm::MmPose1, "backbone.", "head."),
    ] {
        let rename = |(name, shape): &(String, Vec<usize>)| {
            let is_head = name.starts_with("deconv") || name.starts_with("final");
            (format!("{}{name}", if is_head { head } else { backbone }), shape.clone())
        };
        let renamed: Vec<_> = microsoft.iter().map(rename).collect();
        assert_eq!(SimpleBaseline::parameters(form), renamed);
    }
    let names =
        |form| OpenPose::parameters(form).into_iter().map(|(name, _)| name).collect::<Vec<_>>();
    let modules = names(OpenPoseForm::Modules);
    assert_eq!(modules[0], "model0.conv1_1.weight");
    assert!(modules.contains(&"model1_2.conv5_5_CPM_L2.bias".to_owned()));
    assert!(modules.contains(&"model6_1.Mconv7_stage6_L1.weight".to_owned()));
    let plain = |name: &String| name.split_once('.').unwrap().1.to_owned();
    assert_eq!(modules.iter().map(plain).collect::<Vec<_>>(), names(OpenPoseForm::Caffe));

    let error = SimpleBaseline::load(Tensors::new(), Passes::One, options()).unwrap_err();
    let Error::Weights { network, .. } = &error else { panic!("{error}") };
    assert_eq!(network.as_deref(), Some("simple baseline of Microsoft"));
}

/// A network that copies one colour of the image to the first map would be ideal. In this network
/// the last layer sees nothing instead: every map is its bias, and the highest cell is the first.
fn constant(maps: &[f32]) -> Tensors {
    let mut tensors = Tensors::new();
    for (name, shape) in SimpleBaseline::parameters(SimpleBaselineForm::MmPose1) {
        let count = shape.iter().product();
        let data = match name.as_str() {
            "head.final_layer.bias" => maps.to_vec(),
            name if name.ends_with("running_var") => vec![1.0; count],
            _ => vec![0.0; count],
        };
        tensors.insert(name, Tensor::new(shape, data).unwrap()).unwrap();
    }
    tensors
}

#[test]
fn joints_are_seen_where_maps_are_positive() {
    let mut maps = [-0.1; 17];
    (maps[5], maps[6], maps[10]) = (0.5, 0.75, 7.0);
    let image = Array3::zeros((200, 300, 3));
    let person = PersonBox { left: 100.0, top: 50.0, width: 60.0, height: 96.0 };
    for passes in [Passes::One, Passes::Mirrored] {
        let mut network = SimpleBaseline::load(constant(&maps), passes, options()).unwrap();
        let body = network.estimate(image.view(), &person).unwrap();
        // Shoulders, a wrist, and the neck between the shoulders. The mirrored pass exchanges left
        // and right.
        assert_eq!(body.iter().count(), if passes == Passes::One { 4 } else { 5 });
        let shoulder = body.get(Body25::LeftShoulder).unwrap();
        let expected = if passes == Passes::One { 0.5 } else { 0.625 };
        assert_eq!(shoulder.confidence.value(), expected);
        // The first cell: the corner of the widened box, 90 × 120 pixels around 130, 98.
        let corner = [130.0 - 45.0, 98.0 - 60.0];
        assert!((shoulder.position.x - corner[0]).abs() < 1e-9);
        assert!((shoulder.position.y - corner[1]).abs() < 1e-9);
        assert_eq!(body.get(Body25::RightWrist).unwrap().confidence.value(), 1.0);
    }
}

#[test]
fn invalid_boxes_and_images_are_refused() {
    let mut network = SimpleBaseline::load(constant(&[0.5; 17]), Passes::One, options()).unwrap();
    let image = Array3::zeros((200, 300, 3));
    let good = PersonBox { left: 100.0, top: 50.0, width: 60.0, height: 90.0 };
    for bad in [
        PersonBox { left: f64::NAN, ..good },
        PersonBox { width: f64::INFINITY, ..good },
        PersonBox { height: -1.0, ..good },
        PersonBox { left: 300.0, ..good },
        PersonBox { top: -90.0, ..good },
        PersonBox { top: 1e300, ..good },
    ] {
        let error = network.estimate(image.view(), &bad).unwrap_err();
        assert!(matches!(error, Error::Value { .. }), "{bad:?} gave {error}");
    }
    // A box may be partly outside.
    let edge = PersonBox { left: -50.0, top: 150.0, ..good };
    assert!(network.estimate(image.view(), &edge).is_ok());
    for shape in [(0, 300, 3), (200, 0, 3), (200, 300, 4)] {
        let error = network.estimate(Array3::zeros(shape).view(), &good).unwrap_err();
        assert!(matches!(error, Error::Size { .. }), "{shape:?} gave {error}");
    }
}

#[test]
fn open_pose_refuses_what_it_cannot_take() {
    let load = |size| {
        let tensors = weights(OpenPose::parameters(OpenPoseForm::Modules));
        OpenPose::load(tensors, size, options())
    };
    let refused = |size| load(size).unwrap_err().to_string();
    assert!(refused([0, 40]).contains("too small"));
    assert!(refused([40, usize::MAX]).contains("too large"));
    let mut network = load([33, 40]).unwrap();
    let settings = GroupingSettings { least_joints: 0, ..GroupingSettings::default() };
    let image = Array3::zeros((50, 60, 3));
    assert!(matches!(network.estimate(image.view(), &settings), Err(Error::Value { .. })));
    let none = network.estimate(Array3::zeros((0, 60, 3)).view(), &GroupingSettings::default());
    assert!(matches!(none, Err(Error::Size { .. })));
    assert!(network.estimate(image.view(), &GroupingSettings::default()).is_ok());
}
