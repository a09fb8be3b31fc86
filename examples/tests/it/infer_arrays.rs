//! Networks over arrays.

use std::fs;

use ndarray::{Array4, Array5};
use vision_models::{Checkpoint, Options, ResNet, ResNetDepth};

use crate::support::{Runs, read_npy, resnet18, slow_only_r18, write_npy};

/// A folder for the arrays of a test.
struct Arrays(tempfile::TempDir);

impl Arrays {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn path(&self, name: &str) -> String {
        self.0.path().join(name).to_str().unwrap().to_owned()
    }

    /// Writes and returns two images.
    fn images(&self) -> Array4<f32> {
        let images = Array4::from_shape_fn((2, 3, 64, 48), |(image, channel, row, column)| {
            ((image * 7 + channel * 5 + row * 3 + column) % 11) as f32 / 5.0 - 1.0
        });
        write_npy(self.path("images.npy"), &images);
        images
    }

    /// The program with the small network, the array of this name as input and `out.npy` as output.
    fn infer(&self, input: &str) -> Runs {
        self.on(Runs::new("infer"), input)
    }

    fn on(&self, program: Runs, input: &str) -> Runs {
        let (input, output) = (self.path(input), self.path("out.npy"));
        let files = ["--weights", resnet18(), &input, "--output", &output];
        program.with(&["--model=resnet18"]).with(&files)
    }
}

#[test]
fn writes_scores_and_times_of_the_network() {
    let arrays = Arrays::new();
    let images = arrays.images();
    let weights = Checkpoint::open(resnet18()).unwrap();
    let mut network =
        ResNet::load(ResNetDepth::Eighteen, weights, [64, 48], Options::default()).unwrap();
    let operations = 2.0 * network.operations() as f64;
    let scores = network.infer(images.view()).unwrap();
    for (flag, expected, width) in
        [(None, scores.logits, 7_usize), (Some("--features"), scores.features, 512)]
    {
        let more: Vec<&str> =
            flag.into_iter().chain(["--repeat=3", "--threads=2", "--json"]).collect();
        let ran = arrays.infer("images.npy").with(&more).run().done();
        assert_eq!(read_npy(arrays.path("out.npy")), expected.into_dyn());
        let json = ran.json();
        assert_eq!(json["shape"], serde_json::json!([2, width]));
        assert_eq!((&json["network"], &json["runs"]), (&"ResNet-18".into(), &2.into()));
        let [median, minimum, rate] =
            ["median_s", "minimum_s", "gflop_per_s"].map(|key| json[key].as_f64().unwrap());
        assert!(0.0 < minimum && minimum <= median, "{json}");
        assert!((rate - 1e-9 * operations / median).abs() < 1e-6 * rate, "{json}");
        assert!(ran.output.contains(&format!("median {:.3} ms", 1e3 * median)), "{ran:?}");
    }
}

#[test]
fn tensorflow_lite_networks_describe_their_inputs() {
    let arrays = Arrays::new();
    let weights =
        concat!(env!("CARGO_MANIFEST_DIR"), "/../vision-models/tests/data/operators.tflite");
    let image = Array4::from_elem((1, 3, 13, 18), 0.5_f32);
    write_npy(arrays.path("image.npy"), &image);
    let (input, output) = (arrays.path("image.npy"), arrays.path("out.npy"));
    let infer = || Runs::new("infer").with(&["--weights", weights, &input, "--output", &output]);
    let json = infer().with(&["--json"]).run().done().json();
    assert_eq!(json["shape"], serde_json::json!([1, 2, 1, 180]));
    assert_eq!(json["network"], "TensorFlow Lite");
    infer().with(&["--map=2"]).run().done();
    assert_eq!(read_npy(arrays.path("out.npy")).shape(), [1, 24, 7, 10]);
    infer().with(&["--map=3"]).run().failed(1, "outputs: there are 3");
    arrays.images();
    let infer = Runs::new("infer").with(&["--weights", weights, "--output", &output]);
    infer.with(&[&arrays.path("images.npy")]).run().failed(1, "but the network takes [3, 13, 18]");
}

/// An array file with this header and this number of data bytes.
fn npy(header: &str, data: usize) -> Vec<u8> {
    let length = u16::try_from(header.len()).unwrap();
    [b"\x93NUMPY\x01\x00", &length.to_le_bytes()[..], header.as_bytes(), &vec![0; data]].concat()
}

#[test]
fn arrays_that_claim_too_much_are_refused() {
    let arrays = Arrays::new();
    let header = |kind: &str, shape: &str| {
        format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': {shape}, }}\n")
    };
    let long = format!("{}\n", " ".repeat(5000));
    let nested = format!("{}{}\n", "(".repeat(2000), ")".repeat(2000));
    for (file, says) in [
        // The array would take 120 GB.
        (npy(&header("<f4", "(30000000000,)"), 64), "takes 120000000000 bytes, but it has 64"),
        (npy(&header("<f4", "(200000, 3, 224, 224)"), 64), "it is cut off"),
        (npy(&header("<f4", "(1, 3, 64, 64)"), 49_151), "takes 49152 bytes, but it has 49151"),
        (npy(&header("<f4", "(4294967296, 4294967296)"), 64), "is beyond all bounds"),
        (npy(&header("<f4", "(18446744073709551616,)"), 64), "shape"),
        (npy(&header("<f8", "(1, 3, 64, 64)"), 98_304), "'<f8', not f32"),
        (npy(&long, 0), "its header has 5001 bytes"),
        (npy(&nested, 0), "its header is no dictionary"),
        (npy("no dict\n", 0), "header"),
        (b"\x93NUMPY\x02\x00\xff\xff\xff\xff".to_vec(), "its header has 4294967295 bytes"),
        (b"\x93NUMPY\x01\x00\x40\x00{'descr'".to_vec(), "its header is cut off"),
        (b"\x89PNG\r\n\x1a\n0123456".to_vec(), "it is no .npy file"),
        (Vec::new(), "it is no .npy file"),
    ] {
        fs::write(arrays.path("a.npy"), &file).unwrap();
        let ran = arrays.on(Runs::within("infer", 256), "a.npy").run();
        let ran = ran.failed(1, says);
        let named = format!("cannot read {} as an f32 array", arrays.path("a.npy"));
        assert!(ran.errors.contains(&named) && ran.errors.lines().count() == 1, "{ran:?}");
    }
    // A sparse file can be as large as it claims.
    let file = npy(&header("<f4", "(30000000000,)"), 0);
    fs::write(arrays.path("a.npy"), &file).unwrap();
    let holes = fs::File::options().write(true).open(arrays.path("a.npy")).unwrap();
    if holes.set_len(file.len() as u64 + 120_000_000_000).is_ok() {
        let ran = arrays.on(Runs::within("infer", 256), "a.npy").run();
        ran.failed(1, "takes more memory than there is");
    }
    assert!(!fs::exists(arrays.path("out.npy")).unwrap());
}

#[test]
fn big_endian_and_piped_arrays_are_read() {
    let arrays = Arrays::new();
    let images = arrays.images();
    arrays.infer("images.npy").run().done();
    let expected = read_npy(arrays.path("out.npy"));
    let header = "{'descr': '>f4', 'fortran_order': False, 'shape': (2, 3, 64, 48), }\n";
    let mut file = npy(header, 0);
    file.extend(images.iter().flat_map(|value| value.to_be_bytes()));
    fs::write(arrays.path("big.npy"), file).unwrap();
    arrays.infer("big.npy").run().done();
    assert_eq!(read_npy(arrays.path("out.npy")), expected);

    let script = format!(
        "cat {} | {} --model=resnet18 --weights {} /dev/stdin --output {}",
        arrays.path("big.npy"),
        env!("CARGO_BIN_EXE_infer"),
        resnet18(),
        arrays.path("piped.npy")
    );
    let piped = std::process::Command::new("sh").args(["-c", &script]).output().unwrap();
    assert!(piped.status.success(), "{piped:?}");
    assert_eq!(read_npy(arrays.path("piped.npy")), expected);
}

#[test]
fn outputs_are_checked_before_the_work() {
    let infer = Runs::new("infer").with(&["--model=resnet18", "--weights=/nope/w.pth"]);
    let infer = infer.with(&["/nope/in.npy", "--output=/nope/out.npy"]);
    infer.run().failed(1, "cannot write /nope/out.npy: there is no folder /nope");
}

#[test]
fn wrong_network_or_array_takes_one_line() {
    let arrays = Arrays::new();
    arrays.images();
    write_npy(arrays.path("clips.npy"), &Array5::<f32>::zeros((1, 3, 2, 40, 40)));
    let (images, clips, output) =
        (arrays.path("images.npy"), arrays.path("clips.npy"), arrays.path("out.npy"));
    for (model, weights, input, says) in [
        ("resnet50", resnet18(), &images, "this is a ResNet-18: try --model resnet18"),
        ("slowonly_mm", resnet18(), &clips, "this is a ResNet-18: try --model resnet18"),
        (
            "resnet18",
            slow_only_r18(),
            &images,
            "this is a SlowOnly-R18 of mmaction2: try --model slowonly_r18_mm",
        ),
        (
            "resnet18",
            resnet18(),
            &clips,
            "of shape [1, 3, 2, 40, 40], but images are N × 3 × H × W",
        ),
        ("slowonly_ptv", resnet18(), &images, "but clips are N × 3 × T × H × W"),
    ] {
        let model = format!("--model={model}");
        let infer = Runs::new("infer").with(&[&model, "--weights", weights]);
        let ran = infer.with(&[input, "--output", &output]).run().failed(1, says);
        assert_eq!(ran.errors.lines().count(), 1, "{ran:?}");
    }
    assert!(!fs::exists(output).unwrap());
}

#[test]
fn threads_and_repetitions_are_checked() {
    for (option, says) in [
        ("--threads=0", "1..=1024"),
        ("--threads=100000", "1..=1024"),
        ("--repeat=0", "--repeat"),
        ("--model=resnet19", "resnet18"),
    ] {
        let infer = Runs::new("infer").with(&["--weights=w", "i", "--output=o", option]);
        let infer =
            if option.starts_with("--model") { infer } else { infer.with(&["--model=resnet18"]) };
        infer.run().failed(2, says);
    }
}

#[test]
fn interrupt_keeps_scores_and_times_so_far() {
    let arrays = Arrays::new();
    arrays.images();
    let infer = arrays.infer("images.npy").with(&["--repeat=1000000", "--json"]);
    let ran = infer.interrupt_at("runs: ", "INT");
    assert_eq!(ran.code(), Some(130), "{ran:?}");
    let json = ran.json();
    assert!(json["partial"] == true && json["runs"].as_u64().unwrap() > 0, "{json}");
    assert_eq!(read_npy(arrays.path("out.npy")).shape(), [2, 7]);
}
