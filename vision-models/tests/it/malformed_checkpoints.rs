//! Checkpoints written by hand to mislead the reader. Pickles are put into the older format, whose
//! parts simply follow each other.

use std::{fs, io::Cursor};

use proptest::prelude::*;
use vision_models::{Checkpoint, Error, Tensor, Tensors};

fn read(file: Vec<u8>) -> Result<Tensors, Error> {
    Checkpoint::from_reader(Cursor::new(file)).and_then(Checkpoint::read)
}

/// Returns the error message of a rejected file.
fn refusal(file: Vec<u8>) -> String {
    match read(file) {
        Err(error @ Error::Checkpoint { .. }) => error.to_string(),
        other => panic!("expected a refusal, got {other:?}"),
    }
}

/// Returns the error message of a pickle, without its position.
fn pickle_problem(pickle: Vec<u8>) -> String {
    let error = refusal(stream(&pickle));
    match error.strip_prefix("pickle, byte ").and_then(|error| error.split_once(": ")) {
        Some((place, problem)) if place.parse::<u64>().is_ok() => problem.to_owned(),
        _ => panic!("expected a problem of the pickle, got {error}"),
    }
}

/// Part of the error message if a limit is exceeded.
const LIMIT: &str = "that are accepted";

const NO_STATE_DICT: &str = "no state dict: the file holds";

/// Returns a file around a pickle, with the storage `s` of the f32 0, 1, 2, 3.
fn stream(pickle: &[u8]) -> Vec<u8> {
    let storage = [0.0_f32, 1.0, 2.0, 3.0].map(f32::to_le_bytes).concat();
    [
        b"\x80\x02\x8a\x0a\x6c\xfc\x9c\x46\xf9\x20\x6a\xa8\x50\x19.".to_vec(),
        b"\x80\x02M\xe9\x03.".to_vec(),
        [b"\x80\x02}".to_vec(), text("little_endian"), b"\x88s.".to_vec()].concat(),
        [b"\x80\x02", pickle, b"."].concat(),
        [b"\x80\x02]".to_vec(), text("s"), b"a.".to_vec()].concat(),
        4_u64.to_le_bytes().to_vec(),
        storage,
    ]
    .concat()
}

fn text(text: &str) -> Vec<u8> {
    [b"X", &u32::try_from(text.len()).unwrap().to_le_bytes()[..], text.as_bytes()].concat()
}

fn int(value: i64) -> Vec<u8> {
    [&b"\x8a\x08"[..], &value.to_le_bytes()].concat()
}

fn tuple(items: &[Vec<u8>]) -> Vec<u8> {
    [b"(".to_vec(), items.concat(), b"t".to_vec()].concat()
}

fn ints(values: &[i64]) -> Vec<u8> {
    tuple(&values.iter().map(|&value| int(value)).collect::<Vec<_>>())
}

fn dict(entries: &[(&str, Vec<u8>)]) -> Vec<u8> {
    let entries = entries.iter().map(|(name, value)| [text(name), value.clone()].concat());
    [b"}(".to_vec(), entries.collect::<Vec<_>>().concat(), b"u".to_vec()].concat()
}

fn call(global: &str, arguments: Vec<u8>) -> Vec<u8> {
    let (module, name) = global.rsplit_once('.').unwrap();
    [format!("c{module}\n{name}\n").into_bytes(), arguments, b"R".to_vec()].concat()
}

fn storage(elements: i64) -> Vec<u8> {
    let class = b"ctorch\nFloatStorage\n".to_vec();
    let id = tuple(&[text("storage"), class, text("s"), text("cpu"), int(elements)]);
    [id, b"Q".to_vec()].concat()
}

fn view(offset: i64, shape: &[i64], strides: &[i64]) -> Vec<u8> {
    let arguments = [storage(4), int(offset), ints(shape), ints(strides), b"\x89N".to_vec()];
    call("torch._utils._rebuild_tensor_v2", tuple(&arguments))
}

#[test]
fn a_view_is_read_with_its_strides() {
    let file = stream(&dict(&[("t", view(1, &[2, 2], &[1, 1]))]));
    let tensors = read(file).unwrap();
    assert_eq!(tensors.get("t").unwrap().data(), [1.0, 2.0, 2.0, 3.0]);
}

#[test]
fn views_beyond_their_storage() {
    for (offset, shape, strides) in [
        (0, &[5][..], &[1][..]),
        (1, &[4], &[1]),
        (4, &[1], &[1]),
        (5, &[0], &[1]),
        (0, &[2, 2], &[3, 1]),
        (0, &[2], &[4]),
        (0, &[2], &[i64::MAX]),
        (i64::MAX, &[2], &[i64::MAX]),
        (0, &[i64::MAX, i64::MAX], &[0, 0]),
        (0, &[i64::MAX, 4, 2], &[0, 0, 0]),
        // Empty, but larger than any memory.
        (0, &[0, 1 << 62, 8], &[1, 1, 1]),
        (0, &[1 << 62, 8, 0], &[1, 1, 1]),
    ] {
        let error = refusal(stream(&dict(&[("t", view(offset, shape, strides))])));
        let whole = error.starts_with("tensor \"t\": of shape")
            && error.ends_with("does not lie within its storage of 4 elements");
        assert!(whole, "{error} for {offset} {shape:?} {strides:?}");
    }
}

/// A view with gaps is read piece by piece, whatever its axes.
#[test]
fn views_with_gaps() {
    for (offset, shape, strides, expected) in [
        (0, &[2][..], &[3][..], &[0.0, 3.0][..]),
        (0, &[2, 2], &[2, 1], &[0.0, 1.0, 2.0, 3.0]),
        (0, &[2, 2], &[1, 2], &[0.0, 2.0, 1.0, 3.0]),
        (1, &[1, 2], &[7, 1], &[1.0, 2.0]),
        (1, &[3], &[0], &[1.0, 1.0, 1.0]),
        (0, &[2, 0], &[1, 1], &[]),
        (3, &[], &[], &[3.0]),
    ] {
        let tensors = read(stream(&dict(&[("t", view(offset, shape, strides))]))).unwrap();
        assert_eq!(tensors.get("t").unwrap().data(), expected, "{shape:?} {strides:?}");
    }
}

#[test]
fn invalid_sizes_are_refused() {
    for view in [view(-1, &[1], &[1]), view(0, &[-4], &[1]), view(0, &[4], &[-1])] {
        let problem = pickle_problem(dict(&[("t", view)]));
        assert_eq!(problem, "expected a size, zero or more");
    }
    let problem = pickle_problem(dict(&[("t", view(0, &[2, 2], &[1]))]));
    assert_eq!(problem, "expected as many strides as axes");
    let problem = pickle_problem(dict(&[("t", view(0, &[1; 9], &[1; 9]))]));
    assert_eq!(problem, "expected a tuple of at most eight sizes");
}

#[test]
fn an_axis_without_stride_cannot_inflate_the_file() {
    let error = refusal(stream(&dict(&[("t", view(0, &[1_000_000_000_000], &[0]))])));
    assert!(error.contains("they have 1000000000000 elements together"), "{error}");
    // Many small ones cannot either.
    let names: Vec<_> = (0..1000).map(|index| index.to_string()).collect();
    let many: Vec<_> = names.iter().map(|name| (name.as_str(), view(0, &[1000], &[0]))).collect();
    assert!(refusal(stream(&dict(&many))).contains("elements together"));
}

#[test]
fn storages_that_lie_about_their_size() {
    let tensor = |elements| {
        let arguments = [storage(elements), int(0), ints(&[1]), ints(&[1])];
        stream(&dict(&[("t", call("torch._utils._rebuild_tensor", tuple(&arguments)))]))
    };
    assert!(read(tensor(4)).is_ok());
    for elements in [0, 1, 5, i64::MAX] {
        assert!(refusal(tensor(elements)).starts_with("storage \"s\": "));
    }
}

#[test]
fn two_tensors_of_one_name() {
    let tensor = || view(0, &[1], &[1]);
    let error = refusal(stream(&dict(&[("t", tensor()), ("t", tensor())])));
    assert_eq!(error, "tensor \"t\": two tensors have this name");
}

#[test]
fn no_state_dict() {
    for pickle in [
        b"N".to_vec(),
        b"K\x01".to_vec(),
        b"]".to_vec(),
        b"}".to_vec(),
        dict(&[("epoch", int(3)), ("weights", dict(&[("t", view(0, &[1], &[1]))]))]),
        view(0, &[1], &[1]),
        call("os.system", tuple(&[text("echo this must never be printed")])),
    ] {
        assert!(refusal(stream(&pickle)).starts_with(NO_STATE_DICT));
    }
}

#[test]
fn a_wrapper_within_itself_ends() {
    // d = {}; d["state_dict"] = d
    let pickle = [b"}q\x00".to_vec(), text("state_dict"), b"h\x00s".to_vec()].concat();
    assert!(refusal(stream(&pickle)).starts_with(NO_STATE_DICT));
}

#[test]
fn broken_pickles_are_refused() {
    for (pickle, problem) in [
        (&b"0"[..], "the stack is empty"),
        (b"N(0", "the stack is empty"),
        (b"R", "the stack is empty"),
        (b"t", "there is no mark on the stack"),
        (b"h\x07", "memo 7 is empty"),
        (b"\xff", "0xff is no opcode of pickle protocols 1 to 5"),
        (b"I1\n", "0x49 is no opcode of pickle protocols 1 to 5"),
        (b"\x80\x09", "pickle protocol 9: only 0 to 5 exist"),
        (b"X\x01\x00\x00\x00\xff", "text that is not UTF-8"),
        (b"K\x01K\x02a", "expected a list to append to"),
        (b"}(Nu", "expected a dict, keys and values"),
        (b"K\x01Q", "expected (\"storage\", class, key, device, elements)"),
    ] {
        assert_eq!(pickle_problem(pickle.to_vec()), problem, "{pickle:?}");
    }
}

#[test]
fn a_billion_laughs_stay_one() {
    // Each list contains the previous one ten times.
    let mut pickle = b"](K\x01K\x01eq\x00".to_vec();
    for level in 1..100 {
        let before = [b'h', level - 1].repeat(10);
        pickle.extend([b"](", &before[..], b"eq", &[level]].concat());
    }
    assert!(refusal(stream(&pickle)).starts_with(NO_STATE_DICT));
}

#[test]
fn deep_nesting_ends() {
    let pickle = b"(".repeat(1 << 20);
    let lists = |depth: usize| [b"]".repeat(depth), b"a".repeat(depth - 1)].concat();
    assert_eq!(pickle_problem(pickle), "the stack is empty");
    assert!(refusal(stream(&lists(1 << 16))).starts_with(NO_STATE_DICT));
    assert!(refusal(stream(&lists(1 << 20))).contains(LIMIT));
}

#[test]
fn more_values_than_any_checkpoint_has() {
    for opcode in [&b"N"[..], b"}", b"("] {
        let error = refusal(stream(&opcode.repeat(3 << 20)));
        assert!(error.contains(LIMIT), "{error}");
    }
    // A list of 1000 pairs, converted to a dict many times.
    let pairs = ["](".to_owned().into_bytes(), b"](NNe".repeat(1000), b"eq\x00".to_vec()].concat();
    let again = b"ccollections\nOrderedDict\nh\x00\x85R".repeat(4000);
    let error = refusal(stream(&[pairs, again].concat()));
    assert!(error.contains(LIMIT), "{error}");
}

#[test]
fn lengths_beyond_the_file() {
    for pickle in [
        &b"X\xff\xff\xff\xff"[..],
        b"\x8d\xff\xff\xff\xff\xff\xff\xff\x7f",
        b"B\xff\xff\xff\xff",
        b"\x8b\xff\xff\xff\x7f",
        b"\x8e\xff\xff\xff\xff\xff\xff\xff\xff",
        b"\x95\x00",
        b"cos",
    ] {
        // The file ends within the pickle.
        let file = stream(pickle);
        let cut = file.windows(pickle.len()).position(|window| window == pickle).unwrap();
        let error = refusal(file[..cut + pickle.len()].to_vec());
        assert!(error.ends_with("the file is cut off or corrupted"), "{error} for {pickle:?}");
    }
}

/// Returns a safetensors file with this header and eight bytes of data.
fn safetensors(header: &str) -> Vec<u8> {
    [&(header.len() as u64).to_le_bytes()[..], header.as_bytes(), &[0; 8]].concat()
}

#[test]
fn safetensors_headers() {
    let record = |name: &str, kind: &str, shape: &str, begin: u64, end: u64| {
        format!(r#""{name}":{{"dtype":"{kind}","shape":{shape},"data_offsets":[{begin},{end}]}}"#)
    };
    let whole = record("t", "F32", "[2]", 0, 8);
    assert!(read(safetensors(&format!("{{{whole}}}"))).is_ok());
    for header in [
        "{".to_owned(),
        "{}".to_owned(),
        "{\"t\":1}".to_owned(),
        format!("{{{whole},{whole}}}"),
        format!("{{{}}}", record("t", "F32", "[1]", 0, 4)),
        format!("{{{}}}", record("t", "F32", "[3]", 0, 12)),
        format!("{{{}}}", record("t", "F32", "[2]", 8, 0)),
        format!("{{{}}}", record("t", "F32", "[2]", 4, 12)),
        format!("{{{}}}", record("t", "F4", "[2]", 0, 8)),
        format!("{{{}}}", record("t", "F32", "[-2]", 0, 8)),
        format!("{{{}}}", record("t", "F32", "[4294967296,4294967296]", 0, 0)),
        format!("{{{}}}", record("t", "F32", "[0,18446744073709551615,3]", 0, 0)),
        format!("{{{whole},{}}}", record("u", "F32", "[0,4611686018427387904,8]", 8, 8)),
        format!("{{{}}}", record("t", "F32", "[1,1,1,1,1,1,1,1,2]", 0, 8)),
        format!("{{{whole},{}}}", record("u", "F32", "[2]", 0, 8)),
        format!("{{{whole},{}}}", record("u", "F32", "[1]", u64::MAX - 3, u64::MAX)),
        format!("{{\"__metadata__\":{{\"a\":1}},{whole}}}"),
        format!("{{\"__metadata__\":{}1{}}}", "[".repeat(10_000), "]".repeat(10_000)),
    ] {
        let error = refusal(safetensors(&header));
        assert!(error.starts_with("safetensors header: "), "{error} for {header}");
    }
    let mut long = safetensors("{}");
    long[..8].copy_from_slice(&u64::MAX.to_le_bytes());
    assert!(refusal(long).contains(LIMIT));
}

/// Every file that is written can be read. Tensors that could not be read are rejected before the
/// first byte.
#[test]
fn nothing_is_written_that_would_not_be_read() {
    let refused = |name: &str, shape: Vec<usize>| {
        let mut tensors = Tensors::new();
        let elements = vec![0.0; shape.iter().product()];
        tensors.insert(name, Tensor::new(shape, elements).unwrap()).unwrap();
        let mut file = Vec::new();
        let error = tensors.write_safetensors(&mut file).unwrap_err();
        assert!(file.is_empty());
        error.to_string()
    };
    assert!(refused("__metadata__", vec![1]).contains("cannot be named"));
    assert!(refused("t", vec![1; 9]).contains("9 axes: give at most 8"));
    assert!(refused(&"n".repeat(17 << 20), vec![1]).contains("bytes of the safetensors header"));
    assert!(Tensor::new(vec![0, 1 << 62, 8], Vec::new()).is_err());

    let mut many = Tensors::new();
    for index in 0..120_000 {
        many.insert(index.to_string(), Tensor::new(vec![0], Vec::new()).unwrap()).unwrap();
    }
    let mut file = Vec::new();
    assert!(many.write_safetensors(&mut file).is_err() && file.is_empty());
}

/// The end of a zip archive holds the position of its directory. No change of it may look like a
/// disk failure.
#[test]
fn a_changed_archive_end_is_a_typed_error() {
    let file = fs::read(format!("{}/tests/data/wrapped.pth", env!("CARGO_MANIFEST_DIR"))).unwrap();
    let mut refused = 0;
    for place in file.len() - 120..file.len() {
        for byte in [0, 1, 0x7f, 0xff] {
            let mut changed = file.clone();
            changed[place] = byte;
            if let Err(error) = read(changed) {
                assert!(matches!(error, Error::Checkpoint { .. }), "{place}: {error}");
                refused += 1;
            }
        }
    }
    assert!(refused > 100, "{refused}");
}

proptest! {
    #[test]
    fn what_is_written_is_read(
        named in prop::collection::btree_map(".{0,20}", prop::collection::vec(0..4_usize, 0..6), 0..6),
    ) {
        let mut tensors = Tensors::new();
        for (name, shape) in named {
            let elements = vec![0.5; shape.iter().product()];
            tensors.insert(name, Tensor::new(shape, elements).unwrap()).unwrap();
        }
        let mut file = Vec::new();
        tensors.write_safetensors(&mut file).unwrap();
        prop_assert_eq!(read(file).unwrap(), tensors);
    }

    /// Reading any file ends with tensors or a typed error.
    #[test]
    fn changed_files_never_panic(
        file in prop::sample::select(vec![
            "plain.pth", "stream.pth", "wrapped.pth", "protocol5.pth", "plain.safetensors",
        ]),
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..8),
        cut in prop::option::weighted(0.2, any::<prop::sample::Index>()),
    ) {
        let mut bytes =
            fs::read(format!("{}/tests/data/{file}", env!("CARGO_MANIFEST_DIR"))).unwrap();
        for (place, byte) in changes {
            let place = place.index(bytes.len());
            bytes[place] = byte;
        }
        if let Some(cut) = cut {
            bytes.truncate(cut.index(bytes.len()));
        }
        if let Err(error) = read(bytes) {
            prop_assert!(matches!(error, Error::Checkpoint { .. }), "{error}");
        }
    }

    /// The same for pickles of random opcodes.
    #[test]
    fn random_pickles_never_panic(
        pickle in prop::collection::vec(
            prop::sample::select(b"N\x88K\x01J]}()\x85\x86\x87tlaesud012hqR\x81bQXU\x00\x94\x93o".to_vec()),
            0..60,
        ),
    ) {
        if let Err(error) = read(stream(&pickle)) {
            prop_assert!(matches!(error, Error::Checkpoint { .. }), "{error}");
        }
    }
}
