//! The program that lists and converts checkpoints.

use std::process::{Command, Output};

use vision_models::Tensors;

fn data(name: &str) -> String {
    format!("{}/../vision-models/tests/data/{name}", env!("CARGO_MANIFEST_DIR"))
}

fn convert(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_convert")).args(arguments).output().unwrap()
}

#[test]
fn lists_and_converts() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out.safetensors");
    let out = out.to_str().unwrap();
    let output = convert(&[&data("wrapped.pth"), out]);
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(text.starts_with("PyTorch (zip), under \"state_dict\"\nnot read: meta, "), "{text}");
    assert!(text.contains("backbone.conv1.conv.weight  F32   [4, 3, 1, 2, 2]"), "{text}");
    assert!(text.ends_with("3 tensors, 54 elements\n"), "{text}");
    assert_eq!(Tensors::read(out).unwrap(), Tensors::read(data("wrapped.pth")).unwrap());

    // Not onto itself: it would be lost.
    let before = std::fs::read(out).unwrap();
    assert!(!convert(&[out, out]).status.success());
    assert_eq!(std::fs::read(out).unwrap(), before);
}

#[test]
fn refuses_what_is_no_checkpoint() {
    let output = convert(&[&data("checkpoints.py")]);
    assert!(!output.status.success());
    let text = String::from_utf8(output.stderr).unwrap();
    assert!(text.contains("checkpoints.py") && text.contains("not a checkpoint"), "{text}");
}
