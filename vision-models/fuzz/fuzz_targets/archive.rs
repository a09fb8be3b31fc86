//! The zip format of `torch.save`: any bytes as a file.
#![no_main]

use libfuzzer_sys::fuzz_target;
use vision_models::Checkpoint;

fuzz_target!(|bytes: &[u8]| {
    let _ = Checkpoint::from_reader(std::io::Cursor::new(bytes)).and_then(Checkpoint::read);
});
