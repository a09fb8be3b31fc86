#![allow(dead_code, unused_imports, missing_docs, clippy::all)]
mod support;
mod lib;
fn main() { lib::main() }
