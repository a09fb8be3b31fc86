//! JSON of joints, in thirty times its size and 128 KiB.
#![no_main]

use libfuzzer_sys::fuzz_target;
use vision_models::JointFrame;
use vision_models_fuzz::within;

fuzz_target!(|bytes: &[u8]| {
    within(30 * bytes.len() + (128 << 10), || {
        let frames = JointFrame::from_json(bytes, Some([640, 480])).unwrap_or_default();
        for person in frames.iter().flat_map(|frame| &frame.people) {
            let mut seen = person.image.iter();
            assert!(seen.all(|(_, seen)| seen.position.iter().all(|x| x.is_finite())));
        }
    });
});
