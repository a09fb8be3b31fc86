//! Problems made of a fuzzer's bytes, and the exact arithmetic that judges what the solver makes of them.

mod bytes;
#[expect(dead_code, reason = "the tests ask for more")]
#[path = "../../tests/it/exact.rs"]
mod exact;
mod judge;

pub use bytes::Bytes;
pub use judge::expect_right;
