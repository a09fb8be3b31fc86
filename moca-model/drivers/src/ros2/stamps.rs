//! Times of messages.

use std::time::{Duration, SystemTime, UNIX_EPOCH};

use super::messages::Time;
use super::refusal::Refusal;

/// How far stamps may be from this machine's clock.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StampWindow {
    /// How old a message may be \[s\].
    pub oldest: f64,
    /// How far in the future it may be \[s\]: what clocks of two machines that are kept the same differ by.
    pub ahead: f64,
}

/// The stamps of one topic.
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
    /// At most this old and this far ahead.
    pub fn new(window: StampWindow) -> Self {
        Self { window, newest: None }
    }

    /// What robots measure and are told: 100 ms old, 10 ms ahead.
    pub fn of_robot() -> Self {
        Self::new(StampWindow { oldest: 0.1, ahead: 0.01 })
    }

    /// What cameras see, and networks have looked at: 1 s old, 10 ms ahead.
    pub fn of_camera() -> Self {
        Self::new(StampWindow { oldest: 1.0, ahead: 0.01 })
    }

    /// Takes the stamp of a message that has come `now`; its age \[s\], negative if it is ahead.
    ///
    /// # Errors
    /// The refusals that are about stamps.
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
    /// From another time to this one \[s\].
    pub fn seconds_since(self, other: Self) -> f64 {
        let whole = i64::from(self.sec) - i64::from(other.sec);
        let nanoseconds = i64::from(self.nanosec) - i64::from(other.nanosec);
        whole as f64 + 1e-9 * nanoseconds as f64
    }
}

/// Times that ROS cannot write, before 1970 and after 2038, are zero, which no receiver admits.
impl From<SystemTime> for Time {
    fn from(time: SystemTime) -> Self {
        let since = time.duration_since(UNIX_EPOCH).unwrap_or(Duration::ZERO);
        match i32::try_from(since.as_secs()) {
            Ok(sec) => Self { sec, nanosec: since.subsec_nanos() },
            Err(_) => Self::default(),
        }
    }
}
