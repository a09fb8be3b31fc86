//! Depth images, within 512 MiB of memory.
#![no_main]

use libfuzzer_sys::fuzz_target;
use vision_models::decode_depth;
use vision_models_fuzz::within;

fuzz_target!(|bytes: &[u8]| {
    within(512 << 20, || {
        if let Ok(image) = decode_depth(bytes, 0.001) {
            let [width, height] = image.size();
            assert_eq!(image.depths().len(), width * height);
            assert!(image.depths().iter().all(|depth| depth.is_finite() && *depth >= 0.0));
        }
    });
});
