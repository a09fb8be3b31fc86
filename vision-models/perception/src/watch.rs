//! What long work tells who waits for it.

use std::{fmt, fmt::Display, ops::ControlFlow};

use crate::Error;

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

/// Asks whether to go on.
///
/// # Errors
/// [`Error::Stopped`] if not.
pub(crate) fn go_on(watch: &mut Watch<'_>) -> Result<(), Error> {
    if watch(Event::Working).is_break() { Err(Error::Stopped) } else { Ok(()) }
}
