//! Clocks that a control loop waits on.

use std::cell::Cell;
use std::rc::Rc;
use std::thread;
use std::time::{Duration, Instant};

/// A clock that a loop waits on. Times are in seconds from any origin.
pub trait Clock {
    /// The present \[s\].
    fn now(&self) -> f64;

    /// Waits until `time` \[s\], if that is not past.
    fn sleep_until(&mut self, time: f64);
}

/// The system's monotonic clock. Its time begins at its construction.
#[derive(Debug, Clone, Copy)]
pub struct MonotonicClock {
    start: Instant,
    spin: f64,
}

impl MonotonicClock {
    /// Creates a clock whose waits sleep until `spin` \[s\] before their end and spend the rest in a busy loop. That
    /// wakes up more exactly and keeps a processor busy. Zero only sleeps.
    pub fn new(spin: f64) -> Self {
        Self { start: Instant::now(), spin: spin.max(0.0) }
    }
}

impl Default for MonotonicClock {
    fn default() -> Self {
        Self::new(0.0)
    }
}

impl Clock for MonotonicClock {
    fn now(&self) -> f64 {
        self.start.elapsed().as_secs_f64()
    }

    fn sleep_until(&mut self, time: f64) {
        let rest = time - self.now() - self.spin;
        if let Ok(rest) = Duration::try_from_secs_f64(rest) {
            thread::sleep(rest);
        }
        while self.now() < time {
            std::hint::spin_loop();
        }
    }
}

/// A clock that tests drive. Its time passes only in waits and by [`advance`](Self::advance). Its clones share one
/// time.
///
/// ```
/// use whole_body::control_loop::{Clock, ManualClock};
///
/// let mut clock = ManualClock::default();
/// clock.sleep_until(2.0);
/// clock.clone().advance(0.5);
/// assert_eq!(clock.now(), 2.5);
/// ```
#[derive(Debug, Clone, Default)]
pub struct ManualClock {
    now: Rc<Cell<f64>>,
}

impl ManualClock {
    /// Advances the clock by `time` \[s\].
    pub fn advance(&self, time: f64) {
        self.now.set(self.now.get() + time);
    }
}

impl Clock for ManualClock {
    fn now(&self) -> f64 {
        self.now.get()
    }

    fn sleep_until(&mut self, time: f64) {
        self.now.set(self.now.get().max(time));
    }
}
