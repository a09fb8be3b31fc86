//! Ctrl-C and the signal to terminate, as a flag that long work checks.

use std::{
    io,
    ops::ControlFlow,
    sync::{
        Arc,
        atomic::{AtomicBool, AtomicUsize, Ordering},
    },
};

use signal_hook::{
    consts::{SIGINT, SIGTERM},
    flag,
};

use super::ProgramError;

/// A flag that says whether the program should stop. Clones share the flag.
///
/// ```
/// use examples::program::Interrupt;
///
/// let interrupt = Interrupt::default();
/// assert!(!interrupt.requested());
/// assert!(interrupt.check().is_ok());
/// ```
#[derive(Clone, Debug, Default)]
pub struct Interrupt {
    /// The number of the received signal; 0 before.
    signal: Arc<AtomicUsize>,
}

impl Interrupt {
    /// Installs handlers that set the flag at the first Ctrl-C or signal to terminate, and end the process at the
    /// second.
    pub(super) fn install() -> Result<Self, ProgramError> {
        let interrupt = Self::default();
        let again = Arc::new(AtomicBool::new(false));
        let register = |signal| -> io::Result<()> {
            // Handlers run in this order. At the first signal `again` is still false.
            flag::register_conditional_shutdown(signal, 128 + signal, Arc::clone(&again))?;
            flag::register(signal, Arc::clone(&again))?;
            let number = usize::try_from(signal).unwrap_or_default();
            flag::register_usize(signal, Arc::clone(&interrupt.signal), number)?;
            Ok(())
        };
        [SIGINT, SIGTERM]
            .into_iter()
            .try_for_each(register)
            .map_err(|source| ProgramError::Refused { what: "a handler of Ctrl-C", source })?;
        Ok(interrupt)
    }

    /// Returns true if the program should stop and keep what it has.
    pub fn requested(&self) -> bool {
        self.signal.load(Ordering::Relaxed) != 0
    }

    /// The answer to a callback that asks whether to go on.
    pub fn flow(&self) -> ControlFlow<()> {
        if self.requested() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }

    /// Returns an error after an interrupt. Use it for work without partial results.
    ///
    /// # Errors
    /// [`ProgramError::Interrupted`] if the program should stop.
    pub fn check(&self) -> Result<(), ProgramError> {
        if self.requested() { Err(ProgramError::Interrupted) } else { Ok(()) }
    }

    /// Does work that cannot stop half way, and abandons it if an interrupt comes before it is done. The program should
    /// then end.
    ///
    /// ```
    /// use examples::program::Interrupt;
    ///
    /// assert_eq!(Interrupt::default().wait_for(|| 6 * 7)?, 42);
    /// # Ok::<(), examples::program::ProgramError>(())
    /// ```
    ///
    /// # Errors
    /// [`ProgramError::Interrupted`], or [`ProgramError::Refused`] if no thread can be created.
    pub fn wait_for<T: Send + 'static>(
        &self,
        work: impl FnOnce() -> T + Send + 'static,
    ) -> Result<T, ProgramError> {
        human_perception::wait_while(work, || self.flow())
            .map_err(|source| ProgramError::Refused { what: "another thread", source })?
            .ok_or(ProgramError::Interrupted)
    }

    /// The exit status of an interrupted run: 128 and the signal's number, as in shells.
    pub(super) fn status(&self) -> u8 {
        let signal = self.signal.load(Ordering::Relaxed);
        u8::try_from(signal).unwrap_or_default().saturating_add(128)
    }
}
