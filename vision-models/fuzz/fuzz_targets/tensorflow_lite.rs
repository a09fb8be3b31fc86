//! Files of TensorFlow Lite: read in bounded memory, and then loaded.
#![no_main]

use libfuzzer_sys::fuzz_target;
use vision_models::{Options, TensorFlowLite};
use vision_models_fuzz::within;

fuzz_target!(|bytes: &[u8]| {
    let (file, mut network) = (bytes.to_vec(), None);
    within(6 * bytes.len() + (256 << 10), || network = TensorFlowLite::from_bytes(file).ok());
    if let Some(network) = network {
        drop(network.load(Options::default()));
    }
});
