//! What long work tells who waits for it.

use std::{
    fmt,
    fmt::Display,
    ops::ControlFlow,
    sync::mpsc::{RecvTimeoutError, channel},
    thread,
    time::Duration,
};

use crate::error::Error;

/// What long work tells who waits for it.
#[derive(Clone, Copy)]
pub enum Event<'a> {
    /// So many steps of `all` are done.
    Progress {
        /// What is being done.
        what: &'a str,
        /// Steps that are done.
        done: u64,
        /// All steps.
        all: u64,
    },
    /// What should be known, and does not end the work.
    Warning(&'a dyn Display),
    /// Nothing new: asks only whether to go on.
    Working,
}

impl fmt::Debug for Event<'_> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Progress { what, done, all } => write!(formatter, "{what}: {done} of {all}"),
            Self::Warning(text) => write!(formatter, "{text}"),
            Self::Working => formatter.write_str("working"),
        }
    }
}

/// A call-back of long work, which ends when it returns [`ControlFlow::Break`].
///
/// ```
/// use std::ops::ControlFlow;
///
/// use human_perception::{Event, Watch};
///
/// let watch: &mut Watch<'_> = &mut |_: Event<'_>| ControlFlow::Continue(());
/// assert!(watch(Event::Working).is_continue());
/// ```
pub type Watch<'a> = dyn FnMut(Event<'_>) -> ControlFlow<()> + 'a;

/// Says what should be known.
pub(crate) fn warn(watch: &mut Watch<'_>, text: fmt::Arguments<'_>) {
    // Whether to go on is asked at the next step.
    let _ = watch(Event::Warning(&text));
}

/// Asks whether to go on.
///
/// # Errors
/// [`Error::Stopped`] if not.
pub(crate) fn go_on(watch: &mut Watch<'_>) -> Result<(), Error> {
    if watch(Event::Working).is_break() { Err(Error::Stopped) } else { Ok(()) }
}

/// How soon work that is waited for is left where the call-back ends it.
const PATIENCE: Duration = Duration::from_millis(20);

/// Does work that cannot stop half way, and leaves it behind where the call-back ends it.
///
/// # Errors
/// [`Error::Stopped`]; [`Error::Unfit`] if there is no thread to be had.
pub(crate) fn wait_for<T: Send + 'static>(
    work: impl FnOnce() -> T + Send + 'static,
    watch: &mut Watch<'_>,
) -> Result<T, Error> {
    let (sender, receiver) = channel();
    let worker = thread::Builder::new()
        .spawn(move || {
            // Nobody listens once the work has been left behind.
            let _ = sender.send(work());
        })
        .map_err(|error| Error::at("another thread", error))?;
    loop {
        match receiver.recv_timeout(PATIENCE) {
            Ok(result) => return Ok(result),
            Err(RecvTimeoutError::Timeout) => go_on(watch)?,
            Err(RecvTimeoutError::Disconnected) => match worker.join() {
                Err(panic) => std::panic::resume_unwind(panic),
                Ok(()) => return Err(Error::Stopped),
            },
        }
    }
}
