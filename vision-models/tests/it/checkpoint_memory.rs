//! Reading takes memory in proportion to the file, whatever the file says.

use std::io::Cursor;

use vision_models::Checkpoint;

/// The most memory that reading a file takes beyond the file itself (bytes).
fn peak(file: Vec<u8>) -> u64 {
    let read = || drop(Checkpoint::from_reader(Cursor::new(file)).and_then(Checkpoint::read));
    allocation_counter::measure(read).bytes_max
}

fn stream(pickle: &[u8]) -> Vec<u8> {
    let head = b"\x80\x02\x8a\x0a\x6c\xfc\x9c\x46\xf9\x20\x6a\xa8\x50\x19.\x80\x02M\xe9\x03.\
        \x80\x02}X\x0d\x00\x00\x00little_endian\x88s.";
    [&head[..], pickle, b".\x80\x02]."].concat()
}

#[test]
fn bombs_stay_small() {
    const MEBIBYTE: u64 = 1 << 20;
    // Values by the million, one byte each.
    for opcode in [&b"N"[..], b"}", b"]", b")", b"(", b"K\x01", b"N\x94"] {
        let held = peak(stream(&opcode.repeat(8 << 20)));
        assert!(held < 300 * MEBIBYTE, "{opcode:?} took {} MiB", held / MEBIBYTE);
    }
    // A list of a million values, made into a dict or pasted again and again.
    let list = [&b"]("[..], &b"N".repeat(1 << 20), b"eq\x00"].concat();
    for again in [&b"ccollections\nOrderedDict\nh\x00\x85R"[..], b"h\x00", b"h\x00\x85"] {
        let held = peak(stream(&[&list[..], &again.repeat(100_000)].concat()));
        assert!(held < 300 * MEBIBYTE, "{again:?} took {} MiB", held / MEBIBYTE);
    }
    // Lengths that are not there.
    for pickle in
        [&b"X\xff\xff\xff\x7f"[..], b"\x8d\xff\xff\xff\xff\xff\xff\xff\x7f", b"B\xff\xff\xff\x7f"]
    {
        assert!(peak(stream(pickle)) < MEBIBYTE);
    }
    // A header of 16 EiB, and a tensor of as much.
    let mut header = u64::MAX.to_le_bytes().to_vec();
    header.extend(b"{}");
    assert!(peak(header) < MEBIBYTE);
    let record = br#"{"t":{"dtype":"U8","shape":[9223372036854775807],"data_offsets":[0,9223372036854775807]}}"#;
    let file = [&(record.len() as u64).to_le_bytes()[..], record].concat();
    assert!(peak(file) < MEBIBYTE);
}
