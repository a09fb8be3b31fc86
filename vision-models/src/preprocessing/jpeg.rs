//! JPEG without guesses: what a file does not say is not invented.

use image::{ColorType, DynamicImage, GrayImage, RgbImage};
use zune_jpeg::{
    JpegDecoder,
    zune_core::{bytestream::ZCursor, colorspace::ColorSpace, options::DecoderOptions},
};

/// Code bits that no Huffman table of a JPEG has a code for: ones alone (ITU-T T.81, C). They stand where the codes of
/// a whole image are over, so that whoever reads on for further pixels fails.
const NO_CODE: [u8; 32] = {
    let mut bytes = [0xff; 32];
    let mut at = 1;
    while at < bytes.len() {
        // A byte of ones is followed by a zero, or it would begin a marker.
        bytes[at] = 0;
        at += 2;
    }
    bytes
};

/// Decodes a file whose header promises so many pixels of this colour; else gives the reason.
///
/// A file that is cut off, has fewer pixels than it promises or codes that no encoder writes is refused.
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

/// Where the marker of the image's end is: behind all segments and codes, not in one of them.
///
/// ITU-T T.81, B.1.1: a marker is 0xFF and a byte that is neither 0 nor 0xFF; those of restarts stand within the
/// codes, and all others but start and end are followed by the length of their segment.
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
