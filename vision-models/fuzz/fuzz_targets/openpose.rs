//! OpenPose's JSON.
#![no_main]

use libfuzzer_sys::fuzz_target;
use vision_models::ImageBody;

fuzz_target!(|bytes: &[u8]| {
    for body in ImageBody::from_openpose(bytes).unwrap_or_default() {
        assert!(body.iter().all(|(_, seen)| seen.position.iter().all(|x| x.is_finite())));
    }
});
