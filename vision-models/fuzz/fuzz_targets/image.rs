//! Image files, within the memory that the book promises. Images that are not large are also
//! resized.
#![no_main]

use libfuzzer_sys::fuzz_target;
use vision_models::{decode_image, resize_opencv, resize_pillow};
use vision_models_fuzz::within;

fuzz_target!(|bytes: &[u8]| {
    let most = if bytes.starts_with(b"\xff\xd8") { 1 << 30 } else { 512 << 20 };
    within(most, || {
        if let Ok(frame) = decode_image(bytes)
            && frame.len() < 10_000
        {
            assert!(resize_pillow(frame.view(), 7, 5).is_ok());
            assert!(resize_opencv(frame.view(), 5, 7).is_ok());
        }
    });
});
