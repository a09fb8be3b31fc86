//! OpenPose's JSON, within five times its size and 64 KiB of memory.
#![no_main]

use libfuzzer_sys::fuzz_target;
use vision_models::ImageBody;
use vision_models_fuzz::within;

fuzz_target!(|bytes: &[u8]| {
    within(5 * bytes.len() + (64 << 10), || {
        for body in ImageBody::from_openpose(bytes).unwrap_or_default() {
            assert!(body.iter().all(|(_, seen)| seen.position.iter().all(|x| x.is_finite())));
        }
    });
});
