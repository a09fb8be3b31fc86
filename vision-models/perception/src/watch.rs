//! Progress reports of long work.

use std::{
    fmt,
    fmt::Display,
    io,
    ops::ControlFlow,
    sync::mpsc::{RecvTimeoutError, channel},
    thread,
    time::Duration,
};

use crate::error::Error;

/// A report of long work.
#[derive(Clone, Copy)]
pub enum Event<'a> {
    /// Some steps of `all` are done.
    Progress {
        /// Name of the work.
        what: &'a str,
        /// Number of steps that are done.
        done: u64,
        /// Number of all steps.
        all: u64,
    },
    /// A warning that does not end the work.
    Warning(&'a dyn Display),
    /// No news. The call-back only decides whether to continue.
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

/// A call-back of long work. It stops the work by returning [`ControlFlow::Break`].
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

/// Reports a warning.
pub(crate) fn warn(watch: &mut Watch<'_>, text: fmt::Arguments<'_>) {
    // Whether to continue is asked at the next step.
    let _ = watch(Event::Warning(&text));
}

/// Asks whether to continue.
///
/// # Errors
/// [`Error::Stopped`] if not.
pub(crate) fn go_on(watch: &mut Watch<'_>) -> Result<(), Error> {
    if watch(Event::Working).is_break() { Err(Error::Stopped) } else { Ok(()) }
}

/// Interval at which the call-back is asked while the work runs.
const PATIENCE: Duration = Duration::from_millis(20);

/// Runs work that cannot be interrupted, and abandons it if the call-back stops it.
///
/// # Errors
/// [`Error::Stopped`] if it is stopped, [`Error::Unfit`] if no thread can be started.
pub(crate) fn wait_for<T: Send + 'static>(
    work: impl FnOnce() -> T + Send + 'static,
    watch: &mut Watch<'_>,
) -> Result<T, Error> {
    let result = wait_while(work, || watch(Event::Working));
    result.map_err(|error| Error::at("another thread", error))?.ok_or(Error::Stopped)
}

/// Runs work that cannot be interrupted, and asks every 20 ms whether to wait for it. Returns `None` if it was
/// abandoned.
///
/// ```
/// use std::ops::ControlFlow;
///
/// use human_perception::wait_while;
///
/// assert_eq!(wait_while(|| 6 * 7, || ControlFlow::Continue(()))?, Some(42));
/// # Ok::<(), std::io::Error>(())
/// ```
///
/// # Errors
/// The system's, if no thread can be started.
pub fn wait_while<T: Send + 'static>(
    work: impl FnOnce() -> T + Send + 'static,
    mut go_on: impl FnMut() -> ControlFlow<()>,
) -> io::Result<Option<T>> {
    let (sender, receiver) = channel();
    let worker = thread::Builder::new().spawn(move || {
        // The receiver is gone if the work was abandoned.
        let _ = sender.send(work());
    })?;
    loop {
        match receiver.recv_timeout(PATIENCE) {
            Ok(result) => return Ok(Some(result)),
            Err(RecvTimeoutError::Timeout) if go_on().is_continue() => {}
            Err(RecvTimeoutError::Timeout) => return Ok(None),
            Err(RecvTimeoutError::Disconnected) => match worker.join() {
                Err(panic) => std::panic::resume_unwind(panic),
                Ok(()) => return Ok(None),
            },
        }
    }
}
