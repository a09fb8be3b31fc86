//! Options for running a network.

use crate::error::Error;
use crate::kernels::InstructionSet;

use super::threads::ThreadSettings;

/// Options for running a network.
///
/// ```
/// use vision_models::Options;
///
/// let options = Options { threads: 2, ..Options::default() };
/// assert!(!options.instruction_set.name().is_empty());
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Options {
    /// Number of threads that share the work, the caller's included: from 1 to
    /// [`Self::MAX_THREADS`]. The results are the same for any number.
    pub threads: usize,
    /// The instruction set of the kernels.
    pub instruction_set: InstructionSet,
}

impl Options {
    /// Largest number of threads, more than any processor runs at once.
    pub const MAX_THREADS: usize = ThreadSettings::MAX_THREADS;

    /// Checks every setting.
    ///
    /// # Errors
    /// [`Error::Threads`] if there are none or more than [`Self::MAX_THREADS`].
    pub fn validate(&self) -> Result<(), Error> {
        ThreadSettings { threads: self.threads, ..ThreadSettings::default() }.validate()
    }
}

impl Default for Options {
    /// Returns options with one thread and the processor's fastest instruction set.
    fn default() -> Self {
        Self { threads: 1, instruction_set: InstructionSet::detect() }
    }
}
