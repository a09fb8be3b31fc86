//! Times of messages.

use std::time::{Duration, SystemTime, UNIX_EPOCH};

use super::messages::Time;
use super::refusal::Refusal;

/// Allowed distance of stamps from this machine's clock.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StampWindow {
    /// Largest age of a message \[s\].
    pub oldest: f64,
    /// Largest time by which a stamp may lie in the future \[s\]. It covers the remaining difference between
    /// synchronised clocks of two machines.
    pub ahead: f64,
}

/// Checks the stamps of one topic.
///
/// ```
/// use std::time::{Duration, UNIX_EPOCH};
///
/// use moca_drivers::ros2::messages::Time;
/// use moca_drivers::ros2::{Refusal, Stamps};
///
/// let mut stamps = Stamps::of_robot();
/// let now = UNIX_EPOCH + Duration::from_millis(5_000);
/// let age = stamps.admit(Time { sec: 4, nanosec: 998_000_000 }, now)?;
/// assert!((age - 0.002).abs() < 1e-9);
/// assert_eq!(stamps.admit(Time { sec: 4, nanosec: 997_000_000 }, now), Err(Refusal::Overtaken));
/// # Ok::<(), Refusal>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Stamps {
    window: StampWindow,
    newest: Option<Time>,
}

impl Stamps {
    /// Creates a check with this window.
    pub fn new(window: StampWindow) -> Self {
        Self { window, newest: None }
    }

    /// Creates a check for measurements and commands of robots: at most 100 ms old, at most 10 ms ahead.
    pub fn of_robot() -> Self {
        Self::new(StampWindow { oldest: 0.1, ahead: 0.01 })
    }

    /// Creates a check for camera frames and the results of networks: at most 1 s old, at most 10 ms ahead.
    pub fn of_camera() -> Self {
        Self::new(StampWindow { oldest: 1.0, ahead: 0.01 })
    }

    /// Accepts the stamp of a message that came at time `now`. Returns its age \[s\], which is negative if the stamp is
    /// ahead.
    ///
    /// # Errors
    /// The refusals that concern stamps.
    pub fn admit(&mut self, stamp: Time, now: SystemTime) -> Result<f64, Refusal> {
        let StampWindow { oldest, ahead: most } = self.window;
        if stamp == Time::default() {
            return Err(Refusal::NoStamp);
        }
        if stamp.nanosec >= 1_000_000_000 {
            return Err(Refusal::Stamp { nanosec: stamp.nanosec });
        }
        let age = Time::from(now).seconds_since(stamp);
        if age > oldest {
            return Err(Refusal::Old { age, oldest });
        }
        if age < -most {
            return Err(Refusal::Future { ahead: -age, most });
        }
        if self.newest.is_some_and(|newest| stamp <= newest) {
            return Err(Refusal::Overtaken);
        }
        self.newest = Some(stamp);
        Ok(age)
    }
}

impl Time {
    /// Returns the time from `other` to this time \[s\].
    pub fn seconds_since(self, other: Self) -> f64 {
        let whole = i64::from(self.sec) - i64::from(other.sec);
        let nanoseconds = i64::from(self.nanosec) - i64::from(other.nanosec);
        whole as f64 + 1e-9 * nanoseconds as f64
    }
}

/// Converts a time. Times that ROS cannot write, before 1970 and after 2038, become zero, which no receiver accepts.
impl From<SystemTime> for Time {
    fn from(time: SystemTime) -> Self {
        let since = time.duration_since(UNIX_EPOCH).unwrap_or(Duration::ZERO);
        match i32::try_from(since.as_secs()) {
            Ok(sec) => Self { sec, nanosec: since.subsec_nanos() },
            Err(_) => Self::default(),
        }
    }
}
