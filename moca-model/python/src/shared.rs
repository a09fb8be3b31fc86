//! Objects that several Python threads may hold.

use std::sync::{Mutex, MutexGuard, TryLockError};

use crate::failure::{Failure, Result};

/// An object that one thread uses at a time. A second thread gets an error instead of waiting. Waiting could last for
/// ever, since the other thread may need the interpreter that this one holds.
#[derive(Debug)]
pub(crate) struct Shared<T> {
    value: Mutex<T>,
    /// Name in errors.
    name: &'static str,
}

impl<T> Shared<T> {
    pub(crate) fn new(name: &'static str, value: T) -> Self {
        Self { value: Mutex::new(value), name }
    }

    pub(crate) fn lock(&self) -> Result<MutexGuard<'_, T>> {
        match self.value.try_lock() {
            Ok(guard) => Ok(guard),
            // The thread that panicked has raised an exception; the value is a solver's memory or a problem.
            Err(TryLockError::Poisoned(poisoned)) => Ok(poisoned.into_inner()),
            Err(TryLockError::WouldBlock) => Err(Failure::runtime(format!(
                "another thread is using this {}; give each thread one of its own (copy.copy makes one)",
                self.name
            ))),
        }
    }
}
