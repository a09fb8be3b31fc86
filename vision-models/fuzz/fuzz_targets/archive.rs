//! The zip format of `torch.save`, with any bytes as a file.
#![no_main]

use libfuzzer_sys::fuzz_target;
use vision_models_fuzz::checkpoint;

fuzz_target!(|bytes: &[u8]| checkpoint(bytes.to_vec()));
