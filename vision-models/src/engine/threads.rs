//! Threads that several networks share.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use crate::error::Error;
use crate::kernels::{Pool, Waiting};

/// Settings of threads: their number, their cores, and how they wait.
///
/// ```
/// use vision_models::engine::{ThreadSettings, Waiting};
///
/// // Beside a control loop: two threads that leave its core alone, and cores to others while they wait.
/// let settings = ThreadSettings { threads: 2, cores: vec![1], waiting: Waiting::Parking };
/// settings.validate()?;
/// # Ok::<(), vision_models::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ThreadSettings {
    /// Number of threads that share the work, the caller's included: from 1 to
    /// [`Self::MAX_THREADS`].
    pub threads: usize,
    /// The cores that the workers may run on, as numbered by the operating system. All cores if
    /// empty. The caller's thread is not moved. Linux only; elsewhere cores are an error.
    pub cores: Vec<usize>,
    /// Behaviour between the layers of a network.
    pub waiting: Waiting,
}

impl Default for ThreadSettings {
    /// Returns settings with one thread, on any core, that spins.
    fn default() -> Self {
        Self { threads: 1, cores: Vec::new(), waiting: Waiting::Spinning }
    }
}

impl ThreadSettings {
    /// Largest number of threads, more than any processor runs at once.
    pub const MAX_THREADS: usize = 1024;

    /// Checks every setting.
    ///
    /// # Errors
    /// [`Error::Threads`] if there are none or more than [`Self::MAX_THREADS`].
    pub fn validate(&self) -> Result<(), Error> {
        if (1..=Self::MAX_THREADS).contains(&self.threads) {
            return Ok(());
        }
        let reason = format!("give from 1 to {}", Self::MAX_THREADS);
        Err(Error::Threads { threads: self.threads, reason })
    }
}

/// Threads that several networks share. Clones refer to the same threads, which end with the last
/// clone.
///
/// Only one network at a time runs on them. Another network's inference waits for it.
///
/// ```
/// use vision_models::engine::{ThreadSettings, Threads};
///
/// let threads = Threads::new(&ThreadSettings { threads: 2, ..ThreadSettings::default() })?;
/// assert_eq!(threads.clone().count(), 2);
/// # Ok::<(), vision_models::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Threads {
    pool: Arc<Mutex<Pool>>,
    count: usize,
}

impl Threads {
    /// Starts the threads.
    ///
    /// # Errors
    /// [`Error::Threads`] if the threads cannot be started or a core does not exist.
    pub fn new(settings: &ThreadSettings) -> Result<Self, Error> {
        settings.validate()?;
        let ThreadSettings { threads, cores, waiting } = settings;
        let pool = Pool::new(*threads, cores, *waiting)
            .map_err(|error| Error::Threads { threads: *threads, reason: error.to_string() })?;
        Ok(Self { pool: Arc::new(Mutex::new(pool)), count: *threads })
    }

    /// Returns the number of threads that share the work, the caller's included.
    pub fn count(&self) -> usize {
        self.count
    }

    /// Returns the threads as soon as no other network runs on them. After a panic in a kernel the
    /// pool itself refuses to run.
    pub(crate) fn lock(&self) -> MutexGuard<'_, Pool> {
        self.pool.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
