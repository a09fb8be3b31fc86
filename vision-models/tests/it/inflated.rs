//! Weights of networks for images, inflated to those for clips.

use vision_models::{
    Error, InflatedResNet, Options, ResNet, ResNetDepth, SlowOnly, SlowOnlyForm, Tensor,
    TensorSource, Tensors,
};

use crate::support::{input, weights};

/// The name in torchvision's ResNet of a tensor in mmaction2's SlowOnly.
fn torchvision(name: &str) -> String {
    let name = name.strip_prefix("backbone.").unwrap().replace(".conv.weight", ".weight");
    let mut name = name.replace("downsample.weight", "downsample.0.weight");
    for part in ["weight", "bias", "running_mean", "running_var"] {
        name = name.replace(&format!("downsample.bn.{part}"), &format!("downsample.1.{part}"));
        for number in 1..=3 {
            name = name.replace(&format!("conv{number}.bn.{part}"), &format!("bn{number}.{part}"));
        }
    }
    name
}

/// The tensor of a network for clips, element by element.
fn inflated(image: &Tensor, shape: &[usize]) -> Tensor {
    let &[filters, channels, frames, rows, columns] = shape else { return image.clone() };
    let mut data = Vec::new();
    for filter in 0..filters {
        for channel in 0..channels {
            for _ in 0..frames {
                for place in 0..rows * columns {
                    let from = (filter * channels + channel) * rows * columns + place;
                    data.push(image.data()[from] / frames as f32);
                }
            }
        }
    }
    Tensor::new(shape.to_vec(), data).unwrap()
}

#[test]
fn kernels_are_repeated_over_their_frames() {
    for (form, depth, prefix) in [
        (SlowOnlyForm::MmAction2Depth18, ResNetDepth::Eighteen, ""),
        (SlowOnlyForm::MmAction2, ResNetDepth::Fifty, "model."),
    ] {
        let images = weights(ResNet::parameters(depth, 7));
        let mut behind = Tensors::new();
        for name in images.names() {
            behind.insert(format!("{prefix}{name}"), images.get(name).unwrap().clone()).unwrap();
        }
        let mut found = InflatedResNet::new(form, behind).unwrap();
        let mut expected = SlowOnly::parameters(form, 7);
        expected.retain(|(name, _)| !name.starts_with("cls_head"));
        assert_eq!(found.names().len(), expected.len());
        for (name, shape) in expected {
            let image = images.get(&torchvision(&name)).unwrap_or_else(|| panic!("{name}"));
            assert_eq!(found.shape(&name), Some(shape.as_slice()));
            assert_eq!(found.take(&name).unwrap(), inflated(image, &shape), "{name}");
        }
    }
}

/// PyTorchVideo has other names for the same layers.
#[test]
fn pytorchvideo_names_the_same_layers() {
    let images = weights(ResNet::parameters(ResNetDepth::Fifty, 7));
    let mut found = InflatedResNet::new(SlowOnlyForm::PyTorchVideo, images.clone()).unwrap();
    for (clip, image) in [
        ("blocks.0.conv.weight", "conv1.weight"),
        ("blocks.0.norm.running_var", "bn1.running_var"),
        ("blocks.1.res_blocks.0.branch1_conv.weight", "layer1.0.downsample.0.weight"),
        ("blocks.2.res_blocks.3.branch2.norm_b.bias", "layer2.3.bn2.bias"),
        ("blocks.4.res_blocks.2.branch2.conv_c.weight", "layer4.2.conv3.weight"),
    ] {
        let shape = found.shape(clip).unwrap().to_vec();
        assert_eq!(found.take(clip).unwrap(), inflated(images.get(image).unwrap(), &shape));
    }
}

#[test]
fn an_inflated_network_has_features_and_no_classes() {
    let form = SlowOnlyForm::MmAction2Depth18;
    let images = || weights(ResNet::parameters(ResNetDepth::Eighteen, 7));
    let inflated_weights = InflatedResNet::new(form, images()).unwrap();
    let mut network =
        SlowOnly::load(form, inflated_weights, [4, 32, 32], Options::default()).unwrap();
    assert_eq!((network.classes(), network.features()), (0, 512));
    let scores = network.infer(input((1, 3, 4, 32, 32)).view()).unwrap();
    assert!(scores.features.iter().any(|feature| *feature > 0.0));
    // A ResNet of another depth, and no ResNet.
    let other = InflatedResNet::new(SlowOnlyForm::MmAction2, images()).err().unwrap();
    assert!(
        matches!(other, Error::Weights { found: Some(ref name), .. } if &**name == "ResNet-18")
    );
    let clips = weights(SlowOnly::parameters(form, 7));
    assert!(matches!(InflatedResNet::new(form, clips), Err(Error::Weights { .. })));
}
