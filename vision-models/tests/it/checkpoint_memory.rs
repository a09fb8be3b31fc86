//! Reading takes memory and time in proportion to the file's size, whatever its contents.

use std::{
    fmt::Write as _,
    fs,
    io::{self, Cursor, Read, Seek, SeekFrom},
};

use proptest::prelude::*;
use vision_models::{Checkpoint, Error};

const MEBIBYTE: u64 = 1 << 20;

/// Returns the peak memory of opening a file and reading all of it, not counting the file itself
/// (bytes).
fn peak(file: Vec<u8>) -> u64 {
    let read = || drop(Checkpoint::from_reader(Cursor::new(file)).and_then(Checkpoint::read));
    allocation_counter::measure(read).bytes_max
}

/// Checks that a file is read or rejected within the memory that the documentation of `Checkpoint`
/// promises.
fn keeps_the_promise(file: Vec<u8>) -> Result<(), String> {
    let promised = 4 * file.len() as u64 + 16 * MEBIBYTE;
    let (length, held) = (file.len(), peak(file));
    if held <= promised { Ok(()) } else { Err(format!("{held} bytes for a file of {length}")) }
}

fn stream(pickle: &[u8]) -> Vec<u8> {
    let head = b"\x80\x02\x8a\x0a\x6c\xfc\x9c\x46\xf9\x20\x6a\xa8\x50\x19.\x80\x02M\xe9\x03.\
        \x80\x02}X\x0d\x00\x00\x00little_endian\x88s.";
    [&head[..], pickle, b".\x80\x02]."].concat()
}

#[test]
fn bombs_stay_small() {
    // Millions of values, one byte each.
    for opcode in [&b"N"[..], b"}", b"]", b")", b"(", b"K\x01", b"N\x94"] {
        let kept = keeps_the_promise(stream(&opcode.repeat((8 << 20) / opcode.len())));
        assert_eq!(kept, Ok(()), "{opcode:?}");
    }
    // A list of a million values, converted to a dict or inserted many times.
    let list = [&b"]("[..], &b"N".repeat(1 << 20), b"eq\x00"].concat();
    for again in [&b"ccollections\nOrderedDict\nh\x00\x85R"[..], b"h\x00", b"h\x00\x85"] {
        let kept = keeps_the_promise(stream(&[&list[..], &again.repeat(100_000)].concat()));
        assert_eq!(kept, Ok(()), "{again:?}");
    }
    // Lengths beyond the end of the file.
    for pickle in
        [&b"X\xff\xff\xff\x7f"[..], b"\x8d\xff\xff\xff\xff\xff\xff\xff\x7f", b"B\xff\xff\xff\x7f"]
    {
        assert!(peak(stream(pickle)) < MEBIBYTE);
    }
    // A header of 16 EiB, and a tensor of the same size.
    let mut header = u64::MAX.to_le_bytes().to_vec();
    header.extend(b"{}");
    assert!(peak(header) < MEBIBYTE);
    let record = br#"{"t":{"dtype":"U8","shape":[9223372036854775807],"data_offsets":[0,9223372036854775807]}}"#;
    let file = [&(record.len() as u64).to_le_bytes()[..], record].concat();
    assert!(peak(file) < MEBIBYTE);
}

/// Returns a pickle's dict of `count` names, all for the view that `view` puts into memo 0.
fn names_of_one_view(view: &[u8], count: usize) -> Vec<u8> {
    let mut pickle = [view, b"q\x000}("].concat();
    for index in 0..count {
        let name = format!("{index:06x}");
        pickle.extend([b"\x8c\x06", name.as_bytes(), b"h\x00"].concat());
    }
    pickle.push(b'u');
    pickle
}

/// Returns the storage `s` of this many elements, viewed with this shape and strides.
fn view(elements: u32, shape: [u32; 1], strides: [u32; 1]) -> Vec<u8> {
    let int = |value: u32| [b"J", &value.to_le_bytes()[..]].concat();
    [
        &b"ctorch._utils\n_rebuild_tensor\n((X\x07\x00\x00\x00storagectorch\nByteStorage\n"[..],
        b"X\x01\x00\x00\x00sX\x03\x00\x00\x00cpu",
        &int(elements),
        b"tQK\x00(",
        &int(shape[0]),
        b"t(",
        &int(strides[0]),
        b"ttR",
    ]
    .concat()
}

fn with_storage(pickle: &[u8], elements: usize) -> Vec<u8> {
    let head = stream(pickle);
    let keys = b"\x80\x02]X\x01\x00\x00\x00sa.";
    let head = head.strip_suffix(b"\x80\x02].").unwrap();
    let storage = vec![1; elements];
    [head, keys, &(elements as u64).to_le_bytes(), &storage].concat()
}

#[test]
fn a_name_takes_no_more_than_its_share() {
    for count in [1000, 20_000, 400_000] {
        let file = with_storage(&names_of_one_view(&view(1, [0], [1]), count), 1);
        let read = Checkpoint::from_reader(Cursor::new(&file)).and_then(Checkpoint::read);
        if count == 400_000 {
            let error = read.unwrap_err();
            assert!(matches!(error, Error::Checkpoint { .. }), "{error}");
            assert!(error.to_string().contains("that are accepted"), "{error}");
        } else if count == 1000 {
            assert_eq!(read.unwrap().len(), count);
        }
        assert_eq!(keeps_the_promise(file), Ok(()), "{count} names");
    }
    // The same in the other formats.
    let mut header = String::from("{");
    for index in 0..200_000 {
        let comma = if index > 0 { "," } else { "" };
        let record = r#"{"dtype":"U8","shape":[0],"data_offsets":[0,0]}"#;
        write!(header, "{comma}\"{index:x}\":{record}").unwrap();
    }
    assert_eq!(keeps_the_promise(safetensors(&(header + "}"))), Ok(()));
    let ones = "1,".repeat(4 << 20);
    let axes = format!(r#"{{"t":{{"dtype":"U8","shape":[{ones}1],"data_offsets":[0,1]}}}}"#);
    assert_eq!(keeps_the_promise(safetensors(&axes)), Ok(()));
    let mut metadata = String::from(r#"{"__metadata__":{"#);
    for index in 0..600_000 {
        write!(metadata, "\"{index:x}\":\"\",").unwrap();
    }
    metadata.push_str(r#"":""}}"#);
    assert_eq!(keeps_the_promise(safetensors(&metadata)), Ok(()));
    assert_eq!(keeps_the_promise(directory(100_000)), Ok(()));
}

fn safetensors(header: &str) -> Vec<u8> {
    [&(header.len() as u64).to_le_bytes()[..], header.as_bytes()].concat()
}

/// Returns a zip archive that contains only names.
fn directory(count: u32) -> Vec<u8> {
    let mut file = b"PK\x03\x04".to_vec();
    for index in 0..count {
        let name = format!("{index:08x}");
        file.extend([&b"PK\x01\x02"[..], &[0; 24], &[8, 0], &[0; 16], name.as_bytes()].concat());
    }
    let size = u32::try_from(file.len()).unwrap() - 4;
    // Counts of 65,535 and more are in the zip64 end record.
    let zip64 = file.len() as u64;
    file.extend([&b"PK\x06\x06"[..], &[0; 28], &u64::from(count).to_le_bytes()].concat());
    file.extend([&u64::from(size).to_le_bytes()[..], &4_u64.to_le_bytes()].concat());
    file.extend([&b"PK\x06\x07"[..], &[0; 4], &zip64.to_le_bytes(), &[0; 4]].concat());
    file.extend([&b"PK\x05\x06"[..], &[0; 6], &[255; 10], &[0; 2]].concat());
    file
}

/// A file that counts the bytes that are read from it.
struct Counted {
    file: Cursor<Vec<u8>>,
    bytes: std::rc::Rc<std::cell::Cell<u64>>,
}

impl Read for Counted {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.file.read(buffer)?;
        self.bytes.set(self.bytes.get() + count as u64);
        Ok(count)
    }
}

impl Seek for Counted {
    fn seek(&mut self, place: SeekFrom) -> io::Result<u64> {
        self.file.seek(place)
    }
}

#[test]
fn many_names_of_one_view_are_read_quickly() {
    let (storage, names) = (4_u32 << 20, 10_000);
    let ends = view(storage, [2], [storage - 1]);
    let file = with_storage(&names_of_one_view(&ends, names), storage as usize);
    let (bytes, length) = (std::rc::Rc::default(), file.len() as u64);
    let source = Counted { file: Cursor::new(file), bytes: std::rc::Rc::clone(&bytes) };
    let tensors = Checkpoint::from_reader(source).and_then(Checkpoint::read).unwrap();
    assert_eq!(tensors.len(), names);
    assert_eq!(tensors.get("00ffff").or(tensors.get("00000a")).unwrap().data(), [1.0, 1.0]);
    assert!(bytes.get() < 2 * length, "{} bytes read of {length}", bytes.get());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    #[test]
    fn changed_files_keep_the_promise(
        file in prop::sample::select(vec!["plain.pth", "stream.pth", "plain.safetensors"]),
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 0..8),
    ) {
        let path = format!("{}/tests/data/{file}", env!("CARGO_MANIFEST_DIR"));
        let mut bytes = fs::read(path).unwrap();
        for (place, byte) in changes {
            let place = place.index(bytes.len());
            bytes[place] = byte;
        }
        prop_assert_eq!(keeps_the_promise(bytes), Ok(()));
    }
}
