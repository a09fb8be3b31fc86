//! The networks agree with PyTorch for any number of threads and instruction set, and reject
//! invalid inputs.

use std::collections::{BTreeMap, BTreeSet};

use crate::support::{input, weights};
use ndarray::{Array4, Array5, ArrayView2, Axis, concatenate, s};
use serde::Deserialize;
use vision_models::{
    Error, InstructionSet, NetworkKind, Options, ResNet, ResNetDepth, ResNetForm, Scores, SlowFast,
    SlowFastForm, SlowOnly, SlowOnlyForm, SlowOnlyStream, Tensor, TensorSource,
};

/// Tolerance relative to the largest value.
const TOLERANCE: f32 = 5e-6;

/// One network's scores, computed by `data/networks.py`.
#[derive(Deserialize)]
struct Golden {
    shape: Vec<usize>,
    classes: usize,
    logits: Vec<f32>,
    largest_logit: f32,
    features: Vec<f32>,
    largest_feature: f32,
}

impl Golden {
    fn of(name: &str) -> Self {
        let all = include_str!("../data/networks.json");
        let mut all: serde_json::Map<String, serde_json::Value> =
            serde_json::from_str(all).unwrap();
        serde_json::from_value(all.remove(name).unwrap()).unwrap()
    }

    fn images(&self) -> Array4<f32> {
        let [n, c, h, w] = self.shape[..] else { panic!("images") };
        input((n, c, h, w))
    }

    fn clips(&self) -> Array5<f32> {
        let [n, c, t, h, w] = self.shape[..] else { panic!("clips") };
        input((n, c, t, h, w))
    }

    fn check(&self, scores: Scores<'_>) {
        for (&value, expected) in scores.logits.iter().zip(&self.logits) {
            let error = (value - expected).abs() / self.largest_logit;
            assert!(error <= TOLERANCE, "logit {value} instead of {expected}");
        }
        for (&value, expected) in scores.features.iter().step_by(16).zip(&self.features) {
            let error = (value - expected).abs() / self.largest_feature;
            assert!(error <= TOLERANCE, "feature {value} instead of {expected}");
        }
        assert_eq!(scores.logits.len(), self.classes);
        assert_eq!(scores.features.len().div_ceil(16), self.features.len());
    }
}

fn options(threads: usize) -> Options {
    Options { threads, ..Options::default() }
}

fn bits(view: ArrayView2<'_, f32>) -> Vec<u32> {
    view.iter().map(|value| value.to_bits()).collect()
}

#[test]
fn resnets_agree_with_pytorch() {
    for (name, depth) in [
        ("resnet18", ResNetDepth::Eighteen.into()),
        ("resnet34", ResNetDepth::ThirtyFour.into()),
        ("resnet50", ResNetDepth::Fifty.into()),
        ("resnet101", ResNetDepth::OneHundredOne.into()),
        ("resnet152", ResNetDepth::OneHundredFiftyTwo.into()),
        ("resnext50_32x4d", ResNetForm::RESNEXT_50_32X4D),
        ("wide_resnet50_2", ResNetForm::WIDE_50_2),
    ] {
        let golden = Golden::of(name);
        let images = golden.images();
        let (_, _, height, width) = images.dim();
        let tensors = weights(ResNet::parameters(depth, golden.classes));
        let mut network = ResNet::load(depth, tensors, [height, width], options(2)).unwrap();
        golden.check(network.infer(images.view()).unwrap());
    }
}

/// A linear layer after a dropout, and a checkpoint without a linear layer.
#[test]
fn heads_follow_the_checkpoint() {
    let golden = Golden::of("resnet18_dropout");
    let images = golden.images();
    let (_, _, height, width) = images.dim();
    let depth = ResNetDepth::Eighteen;
    let name = |(name, shape): (String, Vec<usize>)| (name.replace("fc.", "fc.1."), shape);
    let parameters = ResNet::parameters(depth, golden.classes).into_iter().map(name).collect();
    let mut network =
        ResNet::load(depth, weights(parameters), [height, width], options(2)).unwrap();
    assert_eq!(network.classes(), golden.classes);
    golden.check(network.infer(images.view()).unwrap());

    let golden = Golden::of("resnet18_headless");
    let images = golden.images();
    let (_, _, height, width) = images.dim();
    let mut parameters = ResNet::parameters(depth, 1);
    parameters.retain(|(name, _)| !name.starts_with("fc."));
    let mut network =
        ResNet::load(depth, weights(parameters), [height, width], options(2)).unwrap();
    assert_eq!(network.classes(), 0);
    let scores = network.infer(images.view()).unwrap();
    assert_eq!(scores.logits.dim(), (1, 0));
    golden.check(scores);
}

#[test]
fn slow_only_agrees_with_mmaction2_and_pytorchvideo() {
    for (name, form) in [
        ("slowonly_mm", SlowOnlyForm::MmAction2),
        ("slowonly_r18_mm", SlowOnlyForm::MmAction2Depth18),
        ("slowonly_r101_mm", SlowOnlyForm::MmAction2Depth101),
        ("slowonly_ptv", SlowOnlyForm::PyTorchVideo),
    ] {
        let golden = Golden::of(name);
        let clips = golden.clips();
        let (_, _, frames, height, width) = clips.dim();
        let tensors = weights(SlowOnly::parameters(form, golden.classes));
        let mut network =
            SlowOnly::load(form, tensors, [frames, height, width], options(2)).unwrap();
        golden.check(network.infer(clips.view()).unwrap());
    }
}

#[test]
fn slow_fast_agrees_with_pytorchvideo_and_mmaction2() {
    for (name, form) in [
        ("slowfast_ptv", SlowFastForm::PyTorchVideo),
        ("slowfast_r50_4x16_mm", SlowFastForm::MmAction2EveryEighth(ResNetDepth::Fifty)),
        ("slowfast_r101_8x8_mm", SlowFastForm::MmAction2EveryFourth(ResNetDepth::OneHundredOne)),
    ] {
        let golden = Golden::of(name);
        let clips = golden.clips();
        let (_, _, frames, height, width) = clips.dim();
        let tensors = weights(SlowFast::parameters(form, golden.classes));
        let mut network =
            SlowFast::load(form, tensors, [frames, height, width], options(2)).unwrap();
        golden.check(network.infer(clips.view()).unwrap());
        let short = network.infer(Array5::zeros((1, 3, 31, height, width)).view()).unwrap_err();
        assert_eq!(short.to_string(), "a clip has 31 frames: give 32");
    }
}

fn small(options: Options, size: [usize; 2]) -> ResNet {
    let tensors = weights(ResNet::parameters(ResNetDepth::Eighteen, 5));
    ResNet::load(ResNetDepth::Eighteen, tensors, size, options).unwrap()
}

#[test]
fn every_instruction_set_agrees_with_pytorch() {
    let golden = Golden::of("resnet18");
    let images = golden.images();
    let (_, _, height, width) = images.dim();
    for instruction_set in InstructionSet::available() {
        let tensors = weights(ResNet::parameters(ResNetDepth::Eighteen, golden.classes));
        let options = Options { threads: 1, instruction_set };
        let mut network =
            ResNet::load(ResNetDepth::Eighteen, tensors, [height, width], options).unwrap();
        golden.check(network.infer(images.view()).unwrap());
    }
}

#[test]
fn the_number_of_threads_changes_no_bit() {
    let images: Array4<f32> = input((1, 3, 75, 64));
    let mut one = small(options(1), [75, 64]);
    let expected = bits(one.infer(images.view()).unwrap().logits);
    for threads in [2, 3] {
        let mut network = small(options(threads), [75, 64]);
        for _ in 0..3 {
            assert_eq!(bits(network.infer(images.view()).unwrap().logits), expected);
        }
    }
}

#[test]
fn batches_agree_with_single_images() {
    let images: Array4<f32> = input((3, 3, 64, 64));
    let mut network = small(options(2), [64, 64]);
    let batch = bits(network.infer(images.view()).unwrap().features);
    let mut single = Vec::new();
    for index in 0..3 {
        let image = images.slice(s![index..=index, .., .., ..]);
        single.extend(bits(network.infer(image).unwrap().features));
    }
    assert_eq!(batch, single);
}

#[test]
fn images_may_have_any_memory_layout() {
    let images: Array4<f32> = input((1, 3, 64, 64));
    let channels_last = images.view().permuted_axes([0, 2, 3, 1]).as_standard_layout().into_owned();
    let mut network = small(options(1), [64, 64]);
    let expected = bits(network.infer(images.view()).unwrap().logits);
    let seen = network.infer(channels_last.view().permuted_axes([0, 3, 1, 2])).unwrap();
    assert_eq!(bits(seen.logits), expected);
}

/// Loaded for one size, run at another one and back. The plan is computed again, and the weights
/// stay.
#[test]
fn the_size_may_change() {
    let golden = Golden::of("resnet18");
    let images = golden.images();
    let (_, _, height, width) = images.dim();
    let tensors = weights(ResNet::parameters(ResNetDepth::Eighteen, golden.classes));
    let mut network = ResNet::load(ResNetDepth::Eighteen, tensors, [224, 224], options(2)).unwrap();
    for _ in 0..2 {
        network.infer(input((1, 3, 40, 200)).view()).unwrap();
        golden.check(network.infer(images.slice(s![.., .., ..height, ..width])).unwrap());
    }
}

#[test]
fn streams_score_bit_for_bit_like_whole_clips() {
    let (frames, height, width) = (4, 48, 64);
    let video: Array5<f32> = input((1, 3, frames + 3, height, width));
    for form in [SlowOnlyForm::MmAction2, SlowOnlyForm::MmAction2Depth18] {
        let load = || {
            let tensors = weights(SlowOnly::parameters(form, 7));
            SlowOnly::load(form, tensors, [frames, height, width], options(2)).unwrap()
        };
        let mut whole = load();
        let mut stream = SlowOnlyStream::new(load(), [frames, height, width]).unwrap();
        for last in 0..video.len_of(Axis(2)) {
            let frame = video.slice(s![0, .., last, .., ..]);
            let Some(scores) = stream.push(frame).unwrap() else {
                assert!(last + 1 < frames);
                continue;
            };
            let first = last + 1 - frames;
            let expected = whole.infer(video.slice(s![.., .., first..=last, .., ..])).unwrap();
            assert_eq!(bits(scores.logits), bits(expected.logits));
            assert_eq!(bits(scores.features), bits(expected.features));
        }
        stream.clear();
        assert!(stream.push(video.slice(s![0, .., 0, .., ..])).unwrap().is_none());
    }
}

#[test]
fn everything_wrong_with_a_checkpoint_is_listed() {
    let mut tensors = weights(ResNet::parameters(ResNetDepth::Eighteen, 5));
    tensors.remove("conv1.weight").unwrap();
    tensors.remove("layer4.1.bn2.running_var").unwrap();
    tensors.remove("fc.bias").unwrap();
    tensors.insert("fc.bias", Tensor::new(vec![4], vec![0.0; 4]).unwrap()).unwrap();
    let batches = Tensor::new(vec![], vec![3.0]).unwrap();
    tensors.insert("bn1.num_batches_tracked", batches.clone()).unwrap();
    tensors.insert("head.weight", batches).unwrap();
    let loaded = ResNet::load(ResNetDepth::Eighteen, tensors, [224, 224], options(1));
    let error = loaded.unwrap_err();
    let message = error.to_string();
    let Error::Weights { network, found, missing, surplus, misshapen } = error else {
        panic!("{message}")
    };
    assert_eq!((network.as_deref(), found), (Some("ResNet-18"), None));
    assert_eq!(missing, ["conv1.weight [64, 3, 7, 7]", "layer4.1.bn2.running_var [512]"]);
    assert_eq!(surplus, ["head.weight"]);
    assert_eq!(misshapen, ["fc.bias [4] instead of [5]"]);
    assert_eq!(
        message,
        "the checkpoint does not fit a ResNet-18; missing: conv1.weight [64, 3, 7, 7], \
         layer4.1.bn2.running_var [512]; surplus: head.weight; misshapen: fc.bias [4] instead of \
         [5]"
    );
}

/// Names and shapes of a network's tensors, without their elements.
struct Shapes(BTreeMap<String, Vec<usize>>);

impl TensorSource for Shapes {
    fn names(&self) -> Vec<&str> {
        self.0.keys().map(String::as_str).collect()
    }

    fn shape(&self, name: &str) -> Option<&[usize]> {
        self.0.get(name).map(Vec::as_slice)
    }

    fn take(&mut self, name: &str) -> Result<Tensor, Error> {
        Err(Error::Name { what: "tensor", got: name.into(), wanted: "another" })
    }
}

fn shapes(kind: NetworkKind, classes: usize) -> Shapes {
    Shapes(kind.parameters(classes).into_iter().collect())
}

#[test]
fn a_checkpoint_of_another_network_is_recognised() {
    for kind in NetworkKind::all() {
        assert_eq!(NetworkKind::of(&shapes(kind, 7)), Some(kind));
        let mut other = shapes(kind, 7);
        other.0.pop_last();
        assert_eq!(NetworkKind::of(&other), None, "a {kind} without its last tensor");
        if kind == NetworkKind::ResNet(ResNetDepth::Fifty.into()) {
            continue;
        }
        let fifty = ResNetDepth::Fifty;
        let error = ResNet::load(fifty, shapes(kind, 7), [224, 224], options(1)).unwrap_err();
        assert_eq!(error.to_string(), format!("the checkpoint is a {kind}, not a ResNet-50"));
        assert!(
            matches!(error, Error::Weights { found, .. } if found == Some(kind.to_string().into()))
        );
    }
    let names: BTreeSet<_> = NetworkKind::all().iter().map(ToString::to_string).collect();
    assert_eq!(names.len(), NetworkKind::all().len());
}

/// An error with many names must be short.
#[test]
fn misfit_errors_are_short() {
    let nothing = Shapes([("w".repeat(1 << 20), vec![1])].into());
    let error = ResNet::load(ResNetDepth::Fifty, nothing, [224, 224], options(1)).unwrap_err();
    let message = error.to_string();
    assert!(message.len() < 500, "{} bytes", message.len());
    assert!(message.contains("missing: conv1.weight [64, 3, 7, 7], ") && message.contains(" more"));
    let Error::Weights { missing, surplus, .. } = error else { panic!("{message}") };
    // A checkpoint without a linear layer counts as one without a head.
    assert_eq!((missing.len(), surplus.len()), (265, 1));
}

#[test]
fn a_checkpoint_without_classes_is_refused() {
    let kind = NetworkKind::ResNet(ResNetDepth::Eighteen.into());
    let error = ResNet::load(ResNetDepth::Eighteen, shapes(kind, 0), [64, 64], options(1));
    let Err(Error::Weights { found: None, misshapen, .. }) = error else { panic!("{error:?}") };
    assert_eq!(misshapen[0], "fc.weight [0, 512] instead of [1, 512]");
}

#[test]
fn threads_are_counted_before_they_are_started() {
    let kind = NetworkKind::ResNet(ResNetDepth::Eighteen.into());
    for threads in [0, Options::MAX_THREADS + 1, 40_000, 100_000, usize::MAX] {
        let loaded =
            ResNet::load(ResNetDepth::Eighteen, shapes(kind, 5), [64, 64], options(threads));
        let error = loaded.unwrap_err();
        let reason = "give from 1 to 1024".to_owned();
        assert_eq!(error, Error::Threads { threads, reason });
        assert_eq!(options(threads).validate(), Err(error));
    }
    assert_eq!(options(1).validate(), Ok(()));
    assert_eq!(options(Options::MAX_THREADS).validate(), Ok(()));
}

#[test]
fn score_widths_are_known_before_an_inference() {
    let mut network = small(options(1), [32, 32]);
    let (classes, features) = (network.classes(), network.features());
    let images: Array4<f32> = input((1, 3, 32, 32));
    let scores = network.infer(images.view()).unwrap();
    assert_eq!((scores.logits.ncols(), scores.features.ncols()), (classes, features));
}

#[test]
fn networks_refuse_bad_inputs_and_continue() {
    let mut network = small(options(1), [64, 64]);
    let image: Array4<f32> = input((1, 3, 64, 64));
    let expected = bits(network.infer(image.view()).unwrap().logits);
    for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let mut bad = image.clone();
        bad[[0, 1, 5, 9]] = value;
        let error = network.infer(bad.view()).unwrap_err();
        assert!(
            matches!(&error, Error::Value { what, .. } if what.contains("[0, 1, 0, 5, 9]")),
            "{value} gave {error}"
        );
    }
    for shape in [(0, 3, 64, 64), (1, 1, 64, 64), (1, 4, 64, 64), (1, 0, 64, 64)] {
        let error = network.infer(Array4::zeros(shape).view()).unwrap_err();
        assert!(matches!(error, Error::Size { .. }), "{shape:?} gave {error}");
    }
    for shape in [(1, 3, 0, 64), (1, 3, 64, 0), (1, 3, 0, 0)] {
        let error = network.infer(Array4::zeros(shape).view()).unwrap_err();
        assert!(error.to_string().contains("too small"), "{shape:?} gave {error}");
    }
    assert_eq!(bits(network.infer(image.view()).unwrap().logits), expected);
    // The smallest image.
    network.infer(Array4::zeros((1, 3, 1, 1)).view()).unwrap();
}

#[test]
fn clips_unfit_for_the_head_are_refused() {
    let form = SlowOnlyForm::PyTorchVideo;
    let tensors = || weights(SlowOnly::parameters(form, 3));
    let mut network = SlowOnly::load(form, tensors(), [8, 224, 224], options(1)).unwrap();
    let short = network.infer(Array5::zeros((1, 3, 7, 200, 200)).view()).unwrap_err();
    let says = |error: &Error, part: &str| assert!(error.to_string().contains(part), "{error}");
    says(&short, "has 7 frames: give more");
    says(&short, "takes 8");
    let narrow = network.infer(Array5::zeros((1, 3, 8, 200, 192)).view()).unwrap_err();
    says(&narrow, "has 6 columns: give more");
    says(&narrow, "takes 7");
    let none = network.infer(Array5::zeros((1, 3, 0, 200, 200)).view()).unwrap_err();
    says(&none, "too small");
}

#[test]
fn a_stream_refuses_other_frames() {
    let form = SlowOnlyForm::MmAction2Depth18;
    let tensors = weights(SlowOnly::parameters(form, 3));
    let network = SlowOnly::load(form, tensors, [2, 48, 40], options(1)).unwrap();
    let mut stream = SlowOnlyStream::new(network, [2, 48, 40]).unwrap();
    let frame: Array4<f32> = input((1, 3, 48, 40));
    let frame = frame.index_axis(Axis(0), 0);
    assert!(stream.push(frame).unwrap().is_none());
    let doubled = concatenate(Axis(1), &[frame, frame]).unwrap();
    assert!(matches!(stream.push(doubled.view()), Err(Error::Size { .. })));
    let mut bad = frame.to_owned();
    bad[[2, 3, 4]] = f32::NAN;
    assert!(matches!(stream.push(bad.view()), Err(Error::Value { .. })));
    assert!(stream.push(frame).unwrap().is_some());
}
