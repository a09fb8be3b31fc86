//! Complete JPEG files of every kind are read, and missing pixels are never invented.

use std::collections::BTreeMap;

use ndarray::{Array3, s};
use vision_models::{Orientation, decode_image, decode_image_oriented, read_image};

/// Returns the files of `data/jpegs.py`.
fn files() -> BTreeMap<String, Vec<u8>> {
    let hex: BTreeMap<String, String> =
        serde_json::from_str(include_str!("../data/jpegs.json")).unwrap();
    let byte = |pair: &[u8]| u8::from_str_radix(std::str::from_utf8(pair).unwrap(), 16).unwrap();
    let bytes = |hex: String| hex.as_bytes().chunks(2).map(byte).collect();
    hex.into_iter().map(|(name, hex)| (name, bytes(hex))).collect()
}

#[test]
fn truncated_files_are_refused_at_every_length() {
    for (name, whole) in files() {
        let pixels = decode_image(&whole).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert!(pixels.iter().any(|&pixel| pixel != pixels[[0, 0, 0]]), "{name}");
        for length in 0..whole.len() - 1 {
            assert!(decode_image(&whole[..length]).is_err(), "{name} cut to {length}");
        }
        // Bytes after the end do not change the image.
        let more = [whole.as_slice(), b"\xff\xd8\xff trailer"].concat();
        assert_eq!(decode_image(&more).unwrap(), pixels, "{name}");
    }
}

/// Cameras close a file that they could not finish: pixels are missing, but the end marker is
/// there.
#[test]
fn files_closed_too_early_are_refused() {
    for (name, whole) in files() {
        if name.starts_with("progressive") {
            // Each of its scans covers the whole image. A file cut between them is complete, but
            // coarser.
            continue;
        }
        let pixels = decode_image(&whole).unwrap();
        let scan = whole.windows(2).rposition(|marker| marker == [0xff, 0xda]).unwrap();
        let (first, last) = (scan + 20, whole.len() - 6);
        let mut lengths: Vec<usize> = (first..last).collect();
        lengths.retain(|length| whole[length - 1] != 0xff);
        for length in lengths {
            let closed = [&whole[..length], b"\xff\xd9"].concat();
            // The last code may happen to be complete in the remaining bytes.
            if let Ok(decoded) = decode_image(&closed) {
                assert_eq!(decoded, pixels, "{name} closed after {length} of {}", whole.len());
            }
        }
    }
}

#[test]
fn a_photo_cut_at_30_percent_is_refused() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/trunc30.jpg");
    let error = read_image(path).unwrap_err().to_string();
    assert!(error.contains("trunc30.jpg") && error.contains("cut off"), "{error}");
    let closed = [std::fs::read(path).unwrap().as_slice(), b"\xff\xd9"].concat();
    let error = decode_image(&closed).unwrap_err().to_string();
    assert!(error.contains("cut off or corrupted"), "{error}");
}

/// EXIF orientation 6: the camera was turned, and the image must be turned clockwise by a quarter
/// to be upright.
#[test]
fn the_orientation_is_a_choice() {
    let file = &files()["turned"];
    let stored = decode_image(file).unwrap();
    assert_eq!(stored.dim(), (24, 40, 3));
    assert_eq!(decode_image_oriented(file, Orientation::Stored).unwrap(), stored);
    let upright = decode_image_oriented(file, Orientation::Exif).unwrap();
    let mut turned: Array3<u8> = stored.slice(s![..;-1, .., ..]).to_owned();
    turned.swap_axes(0, 1);
    assert_eq!(upright, turned);
    let plain = &files()["baseline"];
    assert_eq!(
        decode_image_oriented(plain, Orientation::Exif).unwrap(),
        decode_image(plain).unwrap()
    );
}
