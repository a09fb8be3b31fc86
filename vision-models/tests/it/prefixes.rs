//! Prefixes of a network's weights from wrappers and training programs, and other tensors in the
//! file.

use std::{io::Cursor, sync::LazyLock};

use crate::support::{input, weights};
use vision_models::{
    Checkpoint, Error, NetworkKind, Options, ResNet, ResNetDepth, SimpleBaseline,
    SimpleBaselineForm, Tensor, Tensors,
};

const DEPTH: ResNetDepth = ResNetDepth::Eighteen;

fn plain() -> Tensors {
    static PLAIN: LazyLock<Tensors> = LazyLock::new(|| weights(ResNet::parameters(DEPTH, 3)));
    PLAIN.clone()
}

/// Returns the same tensors with a prefix before each name.
fn behind(prefix: &str, mut tensors: Tensors) -> Tensors {
    let names: Vec<String> = tensors.names().map(str::to_owned).collect();
    let mut renamed = Tensors::new();
    for name in names {
        renamed.insert(format!("{prefix}{name}"), tensors.remove(&name).unwrap()).unwrap();
    }
    renamed
}

fn add(tensors: &mut Tensors, name: &str, shape: &[usize]) {
    let elements = vec![0.5; shape.iter().product()];
    tensors.insert(name, Tensor::new(shape.to_vec(), elements).unwrap()).unwrap();
}

fn safetensors(tensors: &Tensors) -> Vec<u8> {
    let mut file = Vec::new();
    tensors.write_safetensors(&mut file).unwrap();
    file
}

/// Returns a file with a changed header and this many more bytes after the tensors.
fn with_header(file: &[u8], change: impl Fn(&mut serde_json::Value, u64), more: usize) -> Vec<u8> {
    let length = u64::from_le_bytes(file[..8].try_into().unwrap());
    let (header, data) = file[8..].split_at(usize::try_from(length).unwrap());
    let mut header: serde_json::Value = serde_json::from_slice(header).unwrap();
    change(&mut header, data.len() as u64);
    let header = serde_json::to_vec(&header).unwrap();
    let length = (header.len() as u64).to_le_bytes();
    [&length[..], &header, data, &vec![1; more]].concat()
}

fn open(file: Vec<u8>) -> Checkpoint<Cursor<Vec<u8>>> {
    Checkpoint::from_reader(Cursor::new(file)).unwrap()
}

fn kind() -> NetworkKind {
    NetworkKind::ResNet(DEPTH.into())
}

/// A common prefix of all names does not change the network's results.
#[test]
fn a_common_prefix_changes_nothing() {
    let image = input((1, 3, 40, 40));
    let mut network = ResNet::load(DEPTH, plain(), [40, 40], Options::default()).unwrap();
    let expected = network.infer(image.view()).unwrap().logits.to_owned();
    for prefix in [
        "module.",
        "module.module.",
        "_orig_mod.",
        "_orig_mod.module.",
        "model.",
        "net.backbone.resnet.",
        "model.layer1.",
    ] {
        let tensors = behind(prefix, plain());
        assert_eq!(NetworkKind::of(&tensors), Some(kind()), "{prefix}");
        let file = open(safetensors(&tensors));
        assert_eq!(NetworkKind::of(&file), Some(kind()), "{prefix}");
        let mut network = ResNet::load(DEPTH, tensors, [40, 40], Options::default()).unwrap();
        assert_eq!(network.classes(), 3);
        assert_eq!(network.infer(image.view()).unwrap().logits, expected, "{prefix}");
        let mut network = ResNet::load(DEPTH, file, [40, 40], Options::default()).unwrap();
        assert_eq!(network.infer(image.view()).unwrap().logits, expected, "{prefix}");
    }
}

#[test]
fn extra_buffers_are_left_out_by_name() {
    // torch's AveragedModel, and a module of Lightning with a loss and a normalisation.
    for (prefix, buffers) in [
        ("module.", vec![("n_averaged", vec![])]),
        ("model.", vec![("loss.weight", vec![3]), ("mean", vec![1, 3, 1, 1]), ("step", vec![1])]),
    ] {
        let mut tensors = behind(prefix, plain());
        for (name, shape) in &buffers {
            add(&mut tensors, name, shape);
        }
        let mut names: Vec<_> = buffers.iter().map(|(name, _)| (*name).to_owned()).collect();
        names.sort();
        assert_eq!(kind().left_out(&tensors), Some(names), "{prefix}");
        ResNet::load(DEPTH, tensors, [40, 40], Options::default()).unwrap();
    }
    assert_eq!(kind().left_out(&plain()), Some(Vec::new()));
}

/// Weights of another layer show that the checkpoint belongs to another network. It is then
/// rejected completely.
#[test]
fn extra_weights_are_refused_by_name() {
    let mut tensors = behind("model.", plain());
    add(&mut tensors, "projection.weight", &[8, 3]);
    let error = ResNet::load(DEPTH, tensors, [40, 40], Options::default()).unwrap_err();
    let Error::Weights { missing, surplus, misshapen, .. } = error else { panic!("{error}") };
    assert_eq!((missing, misshapen), (vec![], vec![]));
    assert_eq!(surplus, ["projection.weight"]);
    // Among the network's own names even a vector belongs to a layer.
    let mut tensors = plain();
    add(&mut tensors, "layer1.0.extra.bias", &[64]);
    assert_eq!(NetworkKind::of(&tensors), None);
    // Two networks in one file.
    let mut both = behind("student.", plain());
    let mut teacher = behind("teacher.", plain());
    let names: Vec<String> = teacher.names().map(str::to_owned).collect();
    for name in names {
        both.insert(name.clone(), teacher.remove(&name).unwrap()).unwrap();
    }
    assert_eq!(NetworkKind::of(&both), None);
    // A pose network is not a ResNet with the prefix "backbone.".
    let form = SimpleBaselineForm::MmPose0;
    let pose = weights(SimpleBaseline::parameters(form));
    assert_eq!(NetworkKind::of(&behind("model.", pose)), Some(NetworkKind::SimpleBaseline(form)));
}

/// A counter beside the weights, and a tensor of a type that no layer has.
#[test]
fn tensors_of_other_types_are_reported() {
    let whole = safetensors(&plain());
    for (dtype, size) in [("I64", 8), ("C64", 8), ("U64", 8), ("F8_E4M3", 1)] {
        let file = with_header(
            &whole,
            |header, end| {
                header["aux.table"] = serde_json::json!({"dtype": dtype, "shape": [2], "data_offsets": [end, end + 2 * size]});
            },
            2 * usize::try_from(size).unwrap(),
        );
        let checkpoint = open(file);
        let told = match dtype {
            "I64" => kind().left_out(&checkpoint).unwrap(),
            _ => checkpoint.unread().to_vec(),
        };
        assert_eq!(told, ["aux.table"], "{dtype}");
        assert_eq!(NetworkKind::of(&checkpoint), Some(kind()), "{dtype}");
        ResNet::load(DEPTH, checkpoint, [40, 40], Options::default()).unwrap();
    }
}
