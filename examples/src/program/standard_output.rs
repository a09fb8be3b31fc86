//! Standard output that never panics.

use std::io::{self, Stdout, Write, stdout};

use super::shown::escaped;

/// Standard output, by lines. It remembers the first failure, by which the program's end is judged
/// however the error travels.
#[derive(Debug)]
pub struct StandardOutput {
    inner: Stdout,
    failure: Option<Failure>,
}

/// Why it cannot be written.
#[derive(Clone, Debug)]
pub(super) struct Failure {
    pub(super) kind: io::ErrorKind,
    pub(super) message: String,
}

impl StandardOutput {
    pub(super) fn new() -> Self {
        Self { inner: stdout(), failure: None }
    }

    /// Why it cannot be written, if it failed.
    pub(super) fn failure(&self) -> Option<&Failure> {
        self.failure.as_ref()
    }

    /// Notes a failure of something else that wrote to standard output.
    pub(super) fn noted<T>(&mut self, result: io::Result<T>) -> io::Result<T> {
        if let Err(error) = &result
            && error.kind() != io::ErrorKind::Interrupted
        {
            let failure = || Failure { kind: error.kind(), message: error.to_string() };
            self.failure.get_or_insert_with(failure);
        }
        result
    }
}

impl Write for StandardOutput {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        // Names from outside steer no terminal.
        let result = match escaped(bytes) {
            None => self.inner.write(bytes),
            Some(escaped) => self.inner.write_all(&escaped).map(|()| bytes.len()),
        };
        self.noted(result)
    }

    fn flush(&mut self) -> io::Result<()> {
        let result = self.inner.flush();
        self.noted(result)
    }
}
