//! The pickle of a state dict: any bytes in place of the saved object, before one storage.
#![no_main]

use libfuzzer_sys::fuzz_target;
use vision_models_fuzz::checkpoint;

fuzz_target!(|bytes: &[u8]| {
    let file = [
        b"\x80\x02\x8a\x0a\x6c\xfc\x9c\x46\xf9\x20\x6a\xa8\x50\x19.",
        &b"\x80\x02M\xe9\x03.\x80\x02}X\x0d\x00\x00\x00little_endian\x88s."[..],
        bytes,
        b".\x80\x02]X\x01\x00\x00\x000a.",
        &4_u64.to_le_bytes(),
        &[0; 16],
    ]
    .concat();
    checkpoint(file);
});
