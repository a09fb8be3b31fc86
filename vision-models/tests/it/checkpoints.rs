//! Checkpoints of every format are read as in PyTorch, and inconsistent files are rejected.

use std::{collections::BTreeMap, fs, io::Cursor};

use serde_json::Value;
use vision_models::{
    Checkpoint, ElementType, Error, Format, Tensor, TensorInfo, TensorSource, Tensors,
};

fn path(name: &str) -> String {
    format!("{}/tests/data/{name}", env!("CARGO_MANIFEST_DIR"))
}

fn bytes(name: &str) -> Vec<u8> {
    fs::read(path(name)).unwrap()
}

fn open(bytes: impl AsRef<[u8]>) -> Result<Checkpoint<Cursor<Vec<u8>>>, Error> {
    Checkpoint::from_reader(Cursor::new(bytes.as_ref().to_vec()))
}

fn refusal(bytes: impl AsRef<[u8]>) -> String {
    match open(bytes).and_then(Checkpoint::read) {
        Err(error @ Error::Checkpoint { .. }) => error.to_string(),
        other => panic!("expected a refusal, got {other:?}"),
    }
}

/// Returns PyTorch's contents of the file.
fn expected(name: &str) -> BTreeMap<String, Tensor> {
    let json: BTreeMap<String, Value> = serde_json::from_slice(&bytes(name)).unwrap();
    json.into_iter()
        .map(|(name, tensor)| {
            let shape = tensor["shape"].as_array().unwrap().iter();
            let shape = shape.map(|axis| axis.as_u64().unwrap().try_into().unwrap()).collect();
            let values = tensor["values"].as_array().unwrap().iter();
            #[allow(clippy::cast_possible_truncation)] // they were f32
            let values =
                values.map(|value| value.as_f64().unwrap_or(f64::INFINITY) as f32).collect();
            (name, Tensor::new(shape, values).unwrap())
        })
        .collect()
}

fn assert_holds(tensors: &Tensors, expected: &BTreeMap<String, Tensor>) {
    assert_eq!(
        tensors.names().collect::<Vec<_>>(),
        expected.keys().map(String::as_str).collect::<Vec<_>>()
    );
    for (name, tensor) in expected {
        assert_eq!(tensors.get(name), Some(tensor), "{name}");
    }
}

#[test]
fn every_format_and_element_type() {
    let expected = expected("plain.json");
    for (name, format) in [
        ("plain.pth", Format::TorchZip),
        ("protocol5.pth", Format::TorchZip),
        ("stream.pth", Format::TorchStream),
        ("plain.safetensors", Format::Safetensors),
    ] {
        let mut checkpoint = Checkpoint::open(path(name)).unwrap();
        assert_eq!(checkpoint.format(), format);
        for (name, tensor) in &expected {
            assert_eq!(TensorSource::shape(&checkpoint, name), Some(tensor.shape()));
            assert_eq!(&checkpoint.tensor(name).unwrap(), tensor, "{name}");
        }
        let elements: Vec<_> =
            checkpoint.tensors().map(|(_, info)| info.element()).take(4).collect();
        assert_eq!(
            elements,
            [ElementType::Bf16, ElementType::Bool, ElementType::I64, ElementType::F32]
        );
        assert_holds(&Tensors::read(path(name)).unwrap(), &expected);
    }
}

#[test]
fn wrappers_and_prefixes() {
    let expected = expected("wrapped.json");
    let wrapped = Checkpoint::open(path("wrapped.pth")).unwrap();
    assert_eq!(wrapped.wrappers(), ["state_dict"]);
    assert_eq!(wrapped.others(), ["meta", "message_hub", "optimizer"]);
    assert_holds(&wrapped.read().unwrap(), &expected);

    let parallel = Checkpoint::open(path("parallel.pyth")).unwrap();
    assert_eq!(parallel.wrappers(), ["model_state"]);
    assert_eq!(parallel.others(), ["cfg"]);
    assert_holds(&parallel.read().unwrap(), &expected);
}

#[test]
fn foreign_objects_are_inert() {
    let checkpoint = Checkpoint::open(path("hostile.pth")).unwrap();
    assert_eq!(checkpoint.others(), ["hostile"]);
    assert_eq!(checkpoint.read().unwrap().len(), 1);
}

#[test]
fn safetensors_keep_element_types_and_values() {
    let mut source = Checkpoint::open(path("stream.pth")).unwrap();
    let mut written = Vec::new();
    source.write_safetensors(&mut written).unwrap();
    let copy = open(&written).unwrap();
    let elements = |tensors: Vec<(&str, &TensorInfo)>| -> Vec<(String, ElementType)> {
        tensors.into_iter().map(|(name, info)| (name.into(), info.element())).collect()
    };
    assert_eq!(elements(copy.tensors().collect()), elements(source.tensors().collect()));
    assert_holds(&copy.read().unwrap(), &expected("plain.json"));

    let tensors = Tensors::read(path("plain.pth")).unwrap();
    let mut written = Vec::new();
    tensors.write_safetensors(&mut written).unwrap();
    let header = u64::from_le_bytes(written[..8].try_into().unwrap());
    assert_eq!(header % 8, 0, "the tensors are aligned");
    assert_eq!(open(&written).unwrap().read().unwrap(), tensors);
}

#[test]
fn take_gives_a_tensor_once() {
    let mut tensors = Tensors::read(path("wrapped.pth")).unwrap();
    let name = "cls_head.fc_cls.bias";
    assert_eq!(TensorSource::take(&mut tensors, name).unwrap().shape(), [2]);
    let again = TensorSource::take(&mut tensors, name);
    assert!(matches!(again, Err(Error::Name { what: "tensor", got, .. }) if got == name));
}

#[test]
fn missing_file() {
    let Err(Error::File { path, reason }) = Tensors::read("/nowhere/at/all.pth") else {
        panic!("a file from nowhere");
    };
    assert_eq!(path, "/nowhere/at/all.pth");
    assert!(!reason.is_empty());
}

#[test]
fn other_files() {
    for start in [&b""[..], b"P", b"# text", b"\x89PNG\r\n\x1a\n", b"PK\x05\x06", &[0; 40]] {
        assert!(refusal(start).starts_with("not a checkpoint: "), "{start:?}");
    }
}

#[test]
fn every_truncation_is_refused() {
    for name in ["plain.pth", "stream.pth", "plain.safetensors", "wrapped.pth"] {
        let whole = bytes(name);
        for length in 0..whole.len() {
            let result = open(&whole[..length]).and_then(Checkpoint::read);
            assert!(
                matches!(result, Err(Error::Checkpoint { .. })),
                "{name} cut to {length} bytes"
            );
        }
    }
}

#[test]
fn a_changed_weight_fails_its_checksum() {
    let mut file = bytes("plain.pth");
    let value = expected("plain.json")["whole"].data()[3].to_le_bytes();
    let place = file.windows(4).position(|window| window == value).unwrap();
    file[place] ^= 1;
    // Reading the whole storage checks the checksum. Reading a single view of it does not.
    let mut checkpoint = open(&file).unwrap();
    let error = checkpoint.tensor("whole").unwrap_err().to_string();
    assert!(error.starts_with("tensor \"whole\": ") && error.contains("checksum"), "{error}");
    assert!(checkpoint.tensor("offset").is_ok());
}

#[test]
fn archives_that_torch_does_not_write() {
    assert!(refusal(bytes("big_endian.pth")).contains("big-endian"));
    let compressed = refusal(bytes("compressed.pth"));
    assert!(compressed.starts_with("zip archive") && compressed.contains("compressed"));
    let traversal = replace(&bytes("plain.pth"), b"plain/version", b"../../version");
    assert!(refusal(traversal).starts_with("zip archive, entry \"../../version\": "));
    let twice = replace(&bytes("plain.pth"), b"plain/data/10", b"plain/data/11");
    assert!(refusal(twice).starts_with("zip archive, entry \"plain/data/11\": "));
    let lost = replace(&bytes("plain.pth"), b"plain/data/10", b"plain/data/xx");
    assert!(refusal(lost).starts_with("storage \"10\": "));
}

/// Replaces every occurrence.
fn replace(bytes: &[u8], from: &[u8], to: &[u8]) -> Vec<u8> {
    assert_eq!(from.len(), to.len());
    let mut result = bytes.to_vec();
    for start in 0..result.len() - from.len() {
        if result[start..].starts_with(from) {
            result[start..start + from.len()].copy_from_slice(to);
        }
    }
    assert_ne!(result, bytes);
    result
}
