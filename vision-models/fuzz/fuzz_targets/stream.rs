//! The older format of `torch.save`: any bytes after the magic number.
#![no_main]

use libfuzzer_sys::fuzz_target;
use vision_models_fuzz::checkpoint;

fuzz_target!(|bytes: &[u8]| {
    checkpoint([b"\x80\x02\x8a\x0a\x6c\xfc\x9c\x46\xf9\x20\x6a\xa8\x50\x19.", bytes].concat());
});
