//! Files of TensorFlow Lite: comparison of every operator with TensorFlow Lite's own kernels, and
//! rejected files.

use std::{fs, sync::LazyLock};

use ndarray::Array5;
use proptest::{prelude::*, test_runner::RngSeed};
use serde_json::Value;
use vision_models::{Error, InstructionSet, Options, TensorFlowLite};

/// Tolerance for sums in another order (absolute; outputs are about one).
const CLOSE: f64 = 5e-6;

fn data(name: &str) -> Vec<u8> {
    fs::read(format!("{}/tests/data/{name}", env!("CARGO_MANIFEST_DIR"))).unwrap()
}

fn json(name: &str) -> Value {
    serde_json::from_slice(&data(name)).unwrap()
}

/// Returns the numbers that `operators.py` gives to its network.
fn image([channels, rows, columns]: [usize; 3]) -> Array5<f32> {
    Array5::from_shape_fn((1, channels, 1, rows, columns), |(_, channel, _, row, column)| {
        let index = (row * columns + column) * channels + channel;
        let value = (index * 37 % 101) as f64 / 50.0 - 1.0;
        #[expect(clippy::cast_possible_truncation, reason = "the network's numbers are f32")]
        let value = value as f32;
        value
    })
}

/// Returns the outputs of a file, each with its channels last.
fn outputs(network: TensorFlowLite, options: Options) -> Vec<Vec<f32>> {
    let image = image(network.input());
    let count = network.outputs().count();
    let mut network = network.load(options).unwrap();
    let inference = network.infer(image.view()).unwrap();
    let map = |index| inference.map(index).unwrap().permuted_axes([0, 2, 3, 4, 1]);
    (0..count).map(|index| map(index).iter().copied().collect()).collect()
}

#[test]
fn every_operator_is_tensorflow_lites() {
    let golden = json("operators.json");
    for instruction_set in InstructionSet::available() {
        for threads in [1, 3] {
            let network = TensorFlowLite::from_bytes(data("operators.tflite")).unwrap();
            let outputs = outputs(network, Options { threads, instruction_set });
            assert_eq!(outputs.len(), golden.as_array().unwrap().len());
            for (output, golden) in outputs.iter().zip(golden.as_array().unwrap()) {
                let golden = golden["values"].as_array().unwrap();
                assert_eq!(output.len(), golden.len());
                for (&value, golden) in output.iter().zip(golden) {
                    let golden = golden.as_f64().unwrap();
                    assert!((f64::from(value) - golden).abs() < CLOSE, "{value}, not {golden}");
                }
            }
        }
    }
}

#[test]
fn kept_outputs_are_unchanged() {
    let open = || TensorFlowLite::from_bytes(data("operators.tflite")).unwrap();
    let all = outputs(open(), Options::default());
    let some = outputs(open().keep(&[2, 0]).unwrap(), Options::default());
    assert_eq!(some, [all[2].clone(), all[0].clone()]);
    let last = open().keep(&[2]).unwrap().load(Options::default()).unwrap();
    let whole = open().load(Options::default()).unwrap();
    assert!(last.operations() < whole.operations());
    assert!(open().keep(&[3]).unwrap_err().to_string().contains("there are 3"));
}

#[test]
fn what_is_refused_says_why() {
    for case in json("broken_operators.json").as_array().unwrap() {
        let (reason, file) = (case[0].as_str().unwrap(), case[1].as_str().unwrap());
        let byte = |at| u8::from_str_radix(&file[at..at + 2], 16).unwrap();
        let file = (0..file.len()).step_by(2).map(byte).collect();
        let network = TensorFlowLite::from_bytes(file);
        let error = network.and_then(|network| network.load(Options::default())).unwrap_err();
        assert!(
            matches!(error, Error::Checkpoint { .. } | Error::Layer { .. }),
            "{reason}: {error}"
        );
        assert!(error.to_string().contains(reason), "{reason}: {error}");
    }
    let error = TensorFlowLite::from_bytes(data("plain.pth")).unwrap_err();
    assert!(error.to_string().contains("not a file of TensorFlow Lite"), "{error}");
}

#[test]
fn truncated_files_are_refused() {
    let file = data("operators.tflite");
    for length in (0..file.len()).step_by(61).chain(0..200) {
        let error = TensorFlowLite::from_bytes(file[..length].to_vec()).unwrap_err();
        assert!(matches!(error, Error::Checkpoint { .. }), "{length}: {error}");
    }
}

/// Reads a file, loads the network, and checks the promised memory of reading.
fn is_harmless(file: Vec<u8>) -> Result<(), TestCaseError> {
    let promised = 4 * file.len() as u64 + (256 << 10);
    let mut read = None;
    let held = allocation_counter::measure(|| read = Some(TensorFlowLite::from_bytes(file)));
    prop_assert!(held.bytes_max <= promised, "{} bytes", held.bytes_max);
    match read {
        Some(Ok(network)) => {
            let image = image(network.input());
            if let Ok(mut network) = network.load(Options::default()) {
                let _ = network.infer(image.view());
            }
        }
        Some(Err(error)) => {
            prop_assert!(matches!(error, Error::Checkpoint { .. }), "{error}");
        }
        None => {}
    }
    Ok(())
}

#[test]
fn repeated_tables_need_little_memory() {
    let file = data("operators.tflite");
    let word = |place: usize| {
        let bytes = file.get(place..place + 4)?.try_into().ok()?;
        usize::try_from(u32::from_le_bytes(bytes)).ok()
    };
    // The place of an offset to a vector, and the first table of that vector if it holds tables.
    let vector = |place: usize| {
        let start = place + word(place)?;
        let first = start + 4 + word(start + 4)?;
        (first < file.len() && word(start)? > 0).then_some((place, first))
    };
    let mut read = 0;
    for count in [1 << 20, 1 << 17, 120_000, 1 << 14] {
        for (place, table) in (4..file.len().min(4096)).step_by(4).filter_map(vector) {
            let changed = with_vector(file.clone(), place, count, table);
            let promised = 4 * changed.len() as u64 + (256 << 10);
            let open = || read += usize::from(TensorFlowLite::from_bytes(changed).is_ok());
            let held = allocation_counter::measure(open).bytes_max;
            assert!(held <= promised, "{held} bytes, {count} offsets at {place}");
        }
    }
    assert!(read > 0, "long lists of tensors are read");
}

/// Replaces the vector of an offset by one of many offsets to the same table.
fn with_vector(mut file: Vec<u8>, place: usize, count: u32, table: usize) -> Vec<u8> {
    let at = file.len();
    let ahead = |from: usize, to: usize| {
        u32::try_from(to.wrapping_sub(from) & 0xffff_ffff).unwrap().to_le_bytes()
    };
    file[place..place + 4].copy_from_slice(&ahead(place, at));
    file.extend(count.to_le_bytes());
    for index in 0..count as usize {
        file.extend(ahead(at + 4 + 4 * index, table));
    }
    file
}

/// As many files as `AHQP_CASES` says, the same on every run unless `PROPTEST_RNG_SEED` says otherwise.
fn many() -> ProptestConfig {
    let number = |name: &str| std::env::var(name).ok().and_then(|value| value.parse::<u32>().ok());
    let seed = RngSeed::Fixed(number("PROPTEST_RNG_SEED").unwrap_or(1).into());
    let cases = number("AHQP_CASES").unwrap_or(512);
    ProptestConfig { rng_seed: seed, cases, failure_persistence: None, ..ProptestConfig::default() }
}

/// Whole files, and a small one of a few tables.
static SEEDS: LazyLock<[Vec<u8>; 4]> = LazyLock::new(|| {
    let case = json("broken_operators.json")[5][1].as_str().unwrap().to_owned();
    let byte = |at| u8::from_str_radix(&case[at..at + 2], 16).unwrap();
    let small = (0..case.len()).step_by(2).map(byte).collect();
    let [operators, detector, landmarks] = ["operators", "blaze_detector", "blaze_landmarks"]
        .map(|name| data(&format!("{name}.tflite")));
    [operators, detector, landmarks, small]
});

/// Words as offsets, counts and sizes should not be.
fn word() -> impl Strategy<Value = u32> {
    prop_oneof![
        any::<u32>(),
        0..64_u32,
        prop::sample::select(vec![0, 1, 0x7fff_ffff, 0x8000_0000, 0xffff_fff0, u32::MAX]),
    ]
}

proptest! {
    #![proptest_config(many())]

    /// Files with changed bytes and words, cut, and with parts copied elsewhere.
    #[test]
    fn changed_files_are_harmless(
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 0..8),
        words in prop::collection::vec((any::<prop::sample::Index>(), word()), 0..3),
        copied in prop::option::of((any::<[prop::sample::Index; 2]>(), 1..200_usize)),
        cut in prop::option::weighted(0.05, any::<prop::sample::Index>()),
        which in 0..SEEDS.len(),
    ) {
        let mut bytes = SEEDS[which].clone();
        for (place, byte) in changes {
            let place = place.index(bytes.len());
            bytes[place] = byte;
        }
        for (place, word) in words {
            let place = 4 * place.index(bytes.len() / 4);
            bytes[place..place + 4].copy_from_slice(&word.to_le_bytes());
        }
        if let Some((places, length)) = copied {
            let [from, to] = places.map(|place| place.index(bytes.len()));
            let length = length.min(bytes.len() - from.max(to));
            bytes.copy_within(from..from + length, to);
        }
        if let Some(length) = cut {
            bytes.truncate(length.index(bytes.len()));
        }
        is_harmless(bytes)?;
    }
}
