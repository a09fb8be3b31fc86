//! The library that Python imports.

/// Python looks for this function in the file of a module `_ahqp`.
#[test]
fn library_is_a_module_of_python() {
    let tests = std::env::current_exe().unwrap();
    let name = format!("{}_ahqp{}", std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX);
    let library = std::fs::read(tests.with_file_name(name)).unwrap();
    let entry = b"PyInit__ahqp";
    assert!(library.windows(entry.len()).any(|name| name == entry));
}
