//! Threads of a library beneath the priority of a loop.

use std::thread;

use anyhow::{Result, anyhow};
use moca_model::whole_body::control_loop::Scheduling;

/// Calls `make` in a thread just below the priority of a loop. The threads that it starts inherit this priority, so that
/// messages do not wait for programs without one, and the loop not for messages.
///
/// # Errors
/// A priority that the system refuses, and a panic of `make`.
pub fn beneath<T: Send>(scheduling: Scheduling, make: impl FnOnce() -> T + Send) -> Result<T> {
    let priority = scheduling.priority.map(|priority| priority.saturating_sub(1).max(1));
    thread::scope(|scope| {
        let made = scope.spawn(|| Scheduling { priority, ..scheduling }.apply().map(|()| make()));
        made.join().map_err(|_| anyhow!("a thread that joins the graph panicked"))
    })?
    .map_err(anyhow::Error::from)
}
