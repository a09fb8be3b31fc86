//! safetensors: any bytes as a header, before eight bytes of data.
#![no_main]

use libfuzzer_sys::fuzz_target;
use vision_models_fuzz::checkpoint;

fuzz_target!(|bytes: &[u8]| {
    checkpoint([&(bytes.len() as u64).to_le_bytes(), bytes, &[0; 8]].concat());
});
