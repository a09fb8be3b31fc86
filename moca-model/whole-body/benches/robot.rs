//! Time of one call.
#![allow(missing_docs)]
fn main() {
    divan::main();
}
