//! The file of a linear SVM. A machine that is read, written and read again must be the same.
#![no_main]

use libfuzzer_sys::fuzz_target;
use vision_models::LinearSvm;

fuzz_target!(|text: &str| {
    if let Ok(svm) = text.parse::<LinearSvm>() {
        assert_eq!(svm.to_string().parse::<LinearSvm>().as_ref(), Ok(&svm));
    }
});
