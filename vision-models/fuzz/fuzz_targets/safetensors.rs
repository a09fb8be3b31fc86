//! safetensors: any bytes as a header, before eight bytes of data.
#![no_main]

use libfuzzer_sys::fuzz_target;
use vision_models::Checkpoint;

fuzz_target!(|bytes: &[u8]| {
    let file = [&(bytes.len() as u64).to_le_bytes(), bytes, &[0; 8]].concat();
    let _ = Checkpoint::from_reader(std::io::Cursor::new(file)).and_then(Checkpoint::read);
});
