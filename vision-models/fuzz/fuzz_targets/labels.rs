//! Label files: class lists, and clips with their classes.
#![no_main]

use libfuzzer_sys::fuzz_target;
use vision_models::ClassNames;

fuzz_target!(|text: &str| {
    if let Ok(names) = text.parse::<ClassNames>() {
        for name in names.names() {
            assert!(names.index(name).is_some());
        }
        let _ = names.actions();
        let _ = names.clips(text);
    }
    let _ = ClassNames::hri30().clips(text);
});
