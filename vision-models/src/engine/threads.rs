//! Threads that several networks share.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use crate::error::Error;
use crate::kernels::{Pool, Waiting};

/// How many threads there are, where they run, and how they wait.
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
    /// Threads that share the work, the caller's included: from 1 to [`Self::MAX_THREADS`].
    pub threads: usize,
    /// The cores that the workers may run on, as the operating system numbers them; all if there are none.
    /// The caller's thread stays where it is. On Linux only; elsewhere an error.
    pub cores: Vec<usize>,
    /// What threads do between the layers of a network.
    pub waiting: Waiting,
}

impl Default for ThreadSettings {
    /// One thread on any core, spinning.
    fn default() -> Self {
        Self { threads: 1, cores: Vec::new(), waiting: Waiting::Spinning }
    }
}

impl ThreadSettings {
    /// The most threads, more than any processor runs at once.
    pub const MAX_THREADS: usize = 1024;

    /// Checks every setting.
    ///
    /// # Errors
    /// [`Error::Threads`] for none or more than [`Self::MAX_THREADS`].
    pub fn validate(&self) -> Result<(), Error> {
        if (1..=Self::MAX_THREADS).contains(&self.threads) {
            return Ok(());
        }
        let reason = format!("give from 1 to {}", Self::MAX_THREADS);
        Err(Error::Threads { threads: self.threads, reason })
    }
}

/// Threads that several networks share: a clone is a handle of the same threads, which end with the last one.
///
/// One network at a time runs on them; another that is asked to infer on another thread waits for it.
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
    /// [`Error::Threads`] for a number that cannot be started, or cores that there are not.
    pub fn new(settings: &ThreadSettings) -> Result<Self, Error> {
        settings.validate()?;
        let ThreadSettings { threads, cores, waiting } = settings;
        let pool = Pool::new(*threads, cores, *waiting)
            .map_err(|error| Error::Threads { threads: *threads, reason: error.to_string() })?;
        Ok(Self { pool: Arc::new(Mutex::new(pool)), count: *threads })
    }

    /// How many threads share the work, the caller's included.
    pub fn count(&self) -> usize {
        self.count
    }

    /// The threads, once no other network runs on them. After a panic in a kernel they run nothing more, which
    /// the pool itself sees to.
    pub(crate) fn lock(&self) -> MutexGuard<'_, Pool> {
        self.pool.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
