//! Writes `include/ahqp.h`. Checks instead whether the file is current if `--check` is given.
//!
//! `cargo run --locked --manifest-path moca-model/c/header/Cargo.toml [-- --check]`

use std::error::Error;
use std::path::Path;

fn main() -> Result<(), Box<dyn Error>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let config = cbindgen::Config::from_file(folder.join("cbindgen.toml"))?;
    let mut builder = cbindgen::Builder::new().with_config(config);
    for file in ["failure", "views", "hierarchy", "solver", "model", "ik"] {
        builder = builder.with_src(folder.join(format!("src/{file}.rs")));
    }
    let bindings = builder.generate()?;
    let mut text = Vec::new();
    bindings.write(&mut text);
    // Brackets of units are escaped for rustdoc.
    let text = String::from_utf8(text)?.replace("\\[", "[").replace("\\]", "]");
    let header = folder.join("include/ahqp.h");
    if !std::env::args().any(|argument| argument == "--check") {
        return Ok(std::fs::write(header, text)?);
    }
    if std::fs::read_to_string(header)? == text {
        return Ok(());
    }
    Err("include/ahqp.h is not current; run this without --check and commit what it writes".into())
}
