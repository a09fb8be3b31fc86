//! Weights that no training produces, and activations that overflow, give errors and never scores.

use std::sync::LazyLock;

use crate::support::{input, weights};
use ndarray::{Array4, Array5, s};
use vision_models::{
    Error, InstructionSet, Options, ResNet, ResNetDepth, SlowOnly, SlowOnlyForm, SlowOnlyStream,
    Tensor, TensorSource, Tensors,
};

const DEPTH: ResNetDepth = ResNetDepth::Eighteen;

fn sound() -> Tensors {
    static SOUND: LazyLock<Tensors> = LazyLock::new(|| weights(ResNet::parameters(DEPTH, 3)));
    SOUND.clone()
}

/// Returns valid weights except for some elements of one tensor.
fn with(name: &str, places: &[(usize, f32)]) -> Tensors {
    let mut tensors = sound();
    let tensor = tensors.remove(name).unwrap();
    let shape = tensor.shape().to_vec();
    let mut data = tensor.into_data();
    for &(place, value) in places {
        data[place] = value;
    }
    tensors.insert(name, Tensor::new(shape, data).unwrap()).unwrap();
    tensors
}

fn load(tensors: impl TensorSource, instruction_set: InstructionSet) -> Result<ResNet, Error> {
    ResNet::load(DEPTH, tensors, [64, 64], Options { threads: 2, instruction_set })
}

#[test]
fn weights_that_are_not_finite_are_named() {
    let isa = InstructionSet::detect();
    for (tensor, place, index) in [
        ("conv1.weight", 64 * 3 * 49 - 1, &[63, 2, 6, 6][..]),
        ("layer2.0.downsample.0.weight", 65, &[1, 1, 0, 0]),
        ("layer3.1.bn2.weight", 7, &[7]),
        ("bn1.bias", 0, &[0]),
        ("layer1.0.bn1.running_mean", 63, &[63]),
        ("layer4.1.bn2.running_var", 500, &[500]),
        ("fc.weight", 513, &[1, 1]),
        ("fc.bias", 2, &[2]),
    ] {
        for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            let error = load(with(tensor, &[(place, bad)]), isa).unwrap_err();
            let Error::Value { what, got, .. } = &error else { panic!("{error}") };
            assert_eq!(*what, format!("tensor \"{tensor}\": element {index:?}"));
            assert_eq!(*got, bad.to_string());
        }
    }
}

#[test]
fn a_negative_variance_is_refused() {
    let isa = InstructionSet::detect();
    let error = load(with("bn1.running_var", &[(5, -1e-6)]), isa).unwrap_err();
    assert_eq!(
        error.to_string(),
        "tensor \"bn1.running_var\": element [5] is -0.000001: give a finite number, zero or \
         more: a variance"
    );
    assert!(load(with("bn1.running_var", &[(5, 0.0), (6, -0.0)]), isa).is_ok());
}

#[test]
fn weights_overflowing_with_batch_norm_are_refused() {
    let mut tensors = with("layer1.0.bn2.running_var", &[(3, 0.0)]);
    let gain = tensors.remove("layer1.0.bn2.weight").unwrap();
    let mut data = gain.into_data();
    data[3] = f32::MAX;
    tensors.insert("layer1.0.bn2.weight", Tensor::new(vec![64], data).unwrap()).unwrap();
    let error = load(tensors, InstructionSet::detect()).unwrap_err();
    assert!(
        matches!(&error, Error::Overflow { what, .. } if what.contains("layer1.0.conv2")),
        "{error}"
    );
}

/// Returns true if the error is about the activations of this input.
fn overflows(error: &Error, input: usize) -> bool {
    matches!(error, Error::Overflow { what, .. } if what.starts_with(&format!("input {input}: ")))
}

/// Finite weights, and activations that overflow upwards or downwards in any layer, before any
/// kernel.
#[test]
fn activations_that_overflow_are_an_error() {
    let image: Array4<f32> = input((1, 3, 64, 64));
    for isa in InstructionSet::available() {
        for layer in
            ["bn1", "layer1.0.bn1", "layer1.1.bn2", "layer2.0.downsample.1", "layer3.0.bn1"]
        {
            for sign in [1.0, -1.0] {
                let mut tensors = sound();
                for (part, value) in [("weight", 2e37 * sign), ("bias", 3e38 * sign)] {
                    let name = format!("{layer}.{part}");
                    let size = tensors.remove(&name).unwrap().shape()[0];
                    let data = Tensor::new(vec![size], vec![value; size]).unwrap();
                    tensors.insert(name, data).unwrap();
                }
                let mut network = load(tensors, isa).unwrap();
                let error = network.infer(image.view()).unwrap_err();
                assert!(overflows(&error, 0), "{layer} {} {sign}: {error}", isa.name());
            }
        }
    }
}

#[test]
fn an_overflowing_input_is_named_and_isolated() {
    for isa in InstructionSet::available() {
        let mut network = load(sound(), isa).unwrap();
        let mut images: Array4<f32> = input((2, 3, 64, 64));
        let first = images.slice(s![..1, .., .., ..]).to_owned();
        let expected = network.infer(first.view()).unwrap().logits.to_owned();
        images.slice_mut(s![1, .., .., ..]).fill(f32::MAX);
        assert!(overflows(&network.infer(images.view()).unwrap_err(), 1));
        assert_eq!(network.infer(first.view()).unwrap().logits, expected);
    }
}

#[test]
fn streams_report_overflow_until_the_frame_leaves() {
    let form = SlowOnlyForm::MmAction2Depth18;
    let tensors = weights(SlowOnly::parameters(form, 3));
    let network = SlowOnly::load(form, tensors, [2, 32, 32], Options::default()).unwrap();
    let mut stream = SlowOnlyStream::new(network, [2, 32, 32]).unwrap();
    let mut video: Array5<f32> = input((1, 3, 4, 32, 32));
    video.slice_mut(s![0, .., 1, .., ..]).fill(f32::MAX);
    let mut push = |frame: usize| {
        stream.push(video.slice(s![0, .., frame, .., ..])).map(|scores| scores.is_some())
    };
    assert_eq!(push(0), Ok(false));
    assert!(overflows(&push(1).unwrap_err(), 0));
    assert!(overflows(&push(2).unwrap_err(), 0));
    assert_eq!(push(3), Ok(true));
}

/// A user's source may give another shape than it announces.
#[test]
fn sources_with_wrong_shapes_are_refused() {
    struct Liar(Tensors);
    impl TensorSource for Liar {
        fn names(&self) -> Vec<&str> {
            self.0.names().collect()
        }
        fn shape(&self, name: &str) -> Option<&[usize]> {
            self.0.get(name).map(Tensor::shape)
        }
        fn take(&mut self, _: &str) -> Result<Tensor, Error> {
            Tensor::new(vec![1], vec![0.0])
        }
    }
    let error = load(Liar(sound()), InstructionSet::detect()).unwrap_err();
    let message = "a tensor of shape [64, 3, 7, 7] has 1 elements: give one for each place";
    assert_eq!(error.to_string(), message);
}
