//! The program that lists and converts checkpoints.

use std::{fs, io::Read};

use vision_models::{Tensor, Tensors};

use crate::support::{Ran, Runs, SmallDisk, resnet18, signal};

fn data(name: &str) -> String {
    format!("{}/../vision-models/tests/data/{name}", env!("CARGO_MANIFEST_DIR"))
}

fn convert(arguments: &[&str]) -> Ran {
    Runs::new("convert").with(arguments).run()
}

#[test]
fn lists_and_converts() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let out = path("out.safetensors");
    let ran = convert(&[&data("wrapped.pth"), &out]).done();
    let text = &ran.output;
    assert!(text.starts_with("PyTorch (zip), under \"state_dict\"\nnot read: meta, "), "{text}");
    assert!(text.contains("backbone.conv1.conv.weight  F32   [4, 3, 1, 2, 2]"), "{text}");
    assert!(text.ends_with("3 tensors, 54 elements\n"), "{text}");
    assert_eq!(Tensors::read(&out).unwrap(), Tensors::read(data("wrapped.pth")).unwrap());

    // The option that all programs have gives the same.
    let again = path("again.safetensors");
    let ran = convert(&[&data("wrapped.pth"), "--output", &again, "--json"]).done();
    assert_eq!(fs::read(&again).unwrap(), fs::read(&out).unwrap());
    let json = ran.json();
    assert_eq!((&json["tensors"], &json["elements"]), (&3.into(), &54.into()));
    assert_eq!((&json["network"], &json["output"]), (&().into(), &again.as_str().into()));

    // The output must not be the input, which would be lost.
    let before = fs::read(&out).unwrap();
    convert(&[&out, &out]).failed(1, "out.safetensors would be overwritten while it is read");
    assert_eq!(fs::read(&out).unwrap(), before);
}

#[test]
fn says_which_network_it_is() {
    let ran = convert(&[resnet18(), "--json"]).done();
    assert!(ran.output.starts_with("safetensors\na ResNet-18\n"), "{}", &ran.output[..200]);
    assert_eq!(ran.json()["network"], "ResNet-18");
}

#[test]
fn refuses_what_is_no_checkpoint() {
    convert(&[&data("checkpoints.py")]).failed(1, "checkpoints.py: not a checkpoint");
}

/// A name is external data. It must not start a line of its own or send codes to the terminal.
#[test]
fn names_are_shown_escaped() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("in.safetensors");
    let mut tensors = Tensors::new();
    let long = "n".repeat(5000);
    for name in ["fc\n3 tensors, 54 elements", "\u{1b}]0;title\u{7}", "\u{202e}abc", &long] {
        tensors.insert(name, Tensor::new(vec![1], vec![0.5]).unwrap()).unwrap();
    }
    tensors.write_safetensors(fs::File::create(&path).unwrap()).unwrap();
    let output = convert(&[path.to_str().unwrap()]).done().output;
    assert_eq!(output.lines().count(), 7, "{output}");
    assert!(output.lines().all(|line| line.chars().count() < 150), "{output}");
    assert!(!output.contains(['\u{1b}', '\u{7}', '\u{202e}']), "{output}");
    assert!(output.contains("\\u{1b}]0;title\\u{7}"));
    assert!(output.contains("fc\\n3 tensors"), "{output}");
}

#[test]
fn outputs_are_checked_before_the_work() {
    let says = "cannot write /nope/out: there is no folder /nope";
    convert(&["/nope/in.pth", "/nope/out"]).failed(1, says);
}

#[test]
fn a_full_disk_leaves_what_was_there() {
    let Some(disk) = SmallDisk::new(256) else { return };
    let out = disk.path().join("out.safetensors");
    fs::write(&out, "as it was").unwrap();
    let ran = convert(&[resnet18(), out.to_str().unwrap()]);
    let says = format!("error: cannot write {}: No space left on device", out.display());
    ran.failed(1, &says);
    assert_eq!(fs::read_to_string(&out).unwrap(), "as it was");
    assert_eq!(fs::read_dir(disk.path()).unwrap().count(), 1);
}

#[test]
fn an_interrupted_conversion_leaves_no_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let mut tensors = Tensors::new();
    for index in 0..5000 {
        let name = format!("{index}.{}", "name".repeat(20));
        tensors.insert(name, Tensor::new(vec![1], vec![0.5]).unwrap()).unwrap();
    }
    tensors.write_safetensors(fs::File::create(path("in.safetensors")).unwrap()).unwrap();

    // The list is longer than the buffer of a pipe, so that the program cannot write the file before the list is read.
    // Its first byte shows that the signal handler is installed.
    let convert = Runs::new("convert").with(&[path("in.safetensors"), path("out.safetensors")]);
    let mut child = convert.start();
    child.stdout.as_mut().unwrap().read_exact(&mut [0]).unwrap();
    signal(&child, "INT");
    let ran = Ran::of(child);
    assert_eq!(ran.code(), Some(130), "{ran:?}");
    assert!(ran.errors.contains("interrupted, and nothing is kept"), "{}", ran.errors);
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
}
