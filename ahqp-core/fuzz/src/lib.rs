//! Problems made from a fuzzer's bytes, and exact arithmetic that judges the solver's answers.

mod bytes;
#[expect(dead_code, reason = "the tests ask for more")]
#[path = "../../tests/it/exact.rs"]
mod exact;
mod judge;

pub use bytes::Bytes;
pub use judge::expect_right;
