//! How often the threads wake up.

use std::time::Duration;

/// Longest time after which the threads notice that they should end.
pub(super) const WAKES: Duration = Duration::from_millis(50);
