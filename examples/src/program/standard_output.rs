//! Standard output that never panics.

use std::io::{self, Stdout, Write, stdout};

use super::shown::escaped;

/// Standard output by lines. It remembers the first failure, which determines the program's exit status wherever the
/// error goes.
#[derive(Debug)]
pub struct StandardOutput {
    inner: Stdout,
    failure: Option<Failure>,
}

/// The reason why standard output cannot be written.
#[derive(Clone, Debug)]
pub(super) struct Failure {
    pub(super) kind: io::ErrorKind,
    pub(super) message: String,
}

impl StandardOutput {
    pub(super) fn new() -> Self {
        Self { inner: stdout(), failure: None }
    }

    /// The reason why it cannot be written, if it failed.
    pub(super) fn failure(&self) -> Option<&Failure> {
        self.failure.as_ref()
    }

    /// Notes a failure of other code that wrote to standard output.
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
        // External names must not control the terminal.
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
