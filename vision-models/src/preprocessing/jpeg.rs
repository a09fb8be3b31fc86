//! Strict JPEG decoding: missing data are never invented.

use image::{ColorType, DynamicImage, GrayImage, RgbImage};
use zune_jpeg::{
    JpegDecoder,
    zune_core::{bytestream::ZCursor, colorspace::ColorSpace, options::DecoderOptions},
};

/// Bits for which no Huffman table of a JPEG has a code: all ones (ITU-T T.81, C). They are
/// inserted where the codes of a complete image end, so that a decoder that reads further pixels
/// fails.
const NO_CODE: [u8; 32] = {
    let mut bytes = [0xff; 32];
    let mut at = 1;
    while at < bytes.len() {
        // A byte of ones is followed by a zero, since it would otherwise begin a marker.
        bytes[at] = 0;
        at += 2;
    }
    bytes
};

/// Decodes a file whose header has this size and colour, or returns the reason for rejecting it.
///
/// A file is rejected if it is truncated, has fewer pixels than its header says, or has codes that
/// no encoder writes.
pub(super) fn decode(
    bytes: &[u8],
    (width, height): (u32, u32),
    colour: ColorType,
) -> Result<DynamicImage, String> {
    let Some((codes, end)) = end(bytes).and_then(|end| bytes.split_at_checked(end)) else {
        return Err("it is cut off: the marker of a JPEG's end is missing".to_owned());
    };
    let guarded = [codes, &NO_CODE, end].concat();
    let space = if colour == ColorType::L8 { ColorSpace::Luma } else { ColorSpace::RGB };
    let options = DecoderOptions::default()
        .set_strict_mode(true)
        .jpeg_set_out_colorspace(space)
        .set_max_width(width as usize)
        .set_max_height(height as usize);
    let mut decoder = JpegDecoder::new_with_options(ZCursor::new(&*guarded), options);
    let pixels =
        decoder.decode().map_err(|error| format!("it is cut off or corrupted: {error}"))?;
    let image = match space {
        ColorSpace::Luma => GrayImage::from_raw(width, height, pixels).map(Into::into),
        _ => RgbImage::from_raw(width, height, pixels).map(Into::into),
    };
    image.ok_or_else(|| "its pixels are not as many as its header says".to_owned())
}

/// Returns the position of the marker at the image's end, after all segments and codes.
///
/// ITU-T T.81, B.1.1: a marker is 0xFF and a byte that is neither 0 nor 0xFF. Restart markers are
/// within the codes. All others except start and end are followed by the length of their segment.
fn end(bytes: &[u8]) -> Option<usize> {
    let mut at = 2;
    while let Some(&[first, second]) = bytes.get(at..at + 2) {
        match (first, second) {
            (0xff, 0xd9) => return Some(at),
            (0xff, 0x02..=0xcf | 0xda..=0xfe) => {
                let &[high, low] = bytes.get(at + 2..at + 4)? else { return None };
                at += 2 + usize::from(u16::from_be_bytes([high, low])).max(2);
            }
            _ => at += 1,
        }
    }
    None
}
