//! Clock of a control loop: times of ticks and stamps of camera frames.

use crate::age::Age;
use crate::error::{Error, positive};
use crate::fault::{ClockFault, Fault, FrameFault};

/// A stamp and a tick that differ by more have different origins \[s\]. No frame is a day old.
/// Seconds since 1970 and seconds since the start of a machine differ by decades.
const EPOCH: f64 = 86_400.0;

/// Two ticks closer than this share of the period have the same time.
const STANDING: f64 = 1e-3;
/// Two ticks are one period apart if the difference is within this share of the period. Times in
/// seconds since 1970 have no better resolution.
const ROUNDING: f64 = 1e-3;
/// A tick that is early by less than this share of the period counts as on time.
const NEAR: f64 = 0.02;
/// Weight of a tick in the share of late ticks. About the last twenty ticks count.
const NEWEST: f64 = 0.05;
/// Share of late ticks above which a loop is late: half, and what the newest ticks add.
const MOST: f64 = 0.6;

/// Result of a tick's time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tick {
    /// Time since the tick before \[s\], or the period if the clock has no valid time.
    pub elapsed: f64,
    /// Fault of the tick's time.
    pub fault: Option<Fault>,
    /// True if all frames taken so far must be forgotten. They lie after this tick or in another
    /// epoch.
    pub forgets: bool,
}

/// Largest delay of a tick beyond one period after the tick before \[s\]. A longer delay means that the
/// clock was set or the loop stood still.
const GAP: f64 = 0.1;

/// Checks the times of ticks and frames. All times are in seconds on one clock of any origin, which
/// must not stand still or be set.
///
/// Ticks are due once a period, and a missed tick is not made up for. A tick is early if it comes
/// before its due time by more than the tolerance. After a late tick the next tick is still due at
/// its own time. One late tick is no fault. It is a fault if most of the last ticks were late,
/// since the loop is then slower than its period.
///
/// Frames are stamped with the time at which the camera took them, and arrive later. Each must be
/// newer than the one before. A frame that is not is refused and changes nothing.
///
/// ```
/// use hrsw_safety::{FrameFault, LoopClock};
///
/// let mut clock = LoopClock::new(1e-3)?;
/// assert_eq!(clock.tick(20.0).fault, None);
/// assert_eq!(clock.frame(19.95), Ok(()));
/// assert_eq!(clock.frame(3620.0), Err(FrameFault::Future));
/// assert_eq!(clock.frame(1.7e9), Err(FrameFault::ForeignEpoch));
/// assert!((clock.age().seconds() - 0.05).abs() < 1e-9);
/// // 2.8 ms late, and the next one in time.
/// assert_eq!(clock.tick(20.0038).fault, None);
/// assert_eq!(clock.tick(20.004).fault, None);
/// # Ok::<(), hrsw_safety::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LoopClock {
    period: f64,
    now: Option<f64>,
    /// Current time, if it was set before the tick \[s\].
    present: Option<f64>,
    /// Time from the due time to the last tick \[s\]. Less than a period, negative for a slightly
    /// early tick.
    behind: f64,
    /// Share of late ticks among the last ones.
    late_share: f64,
    newest: Option<f64>,
}

impl LoopClock {
    /// Share of the period by which a tick may be early or late \[-\]. Earlier is an early tick, later
    /// a late one.
    pub const TOLERANCE: f64 = 0.5;
    /// Largest time by which a frame's stamp may be ahead of the ticks \[s\], for clocks that agree
    /// only approximately.
    pub const AHEAD: f64 = 0.005;

    /// Creates a clock before its first tick, for a control `period` \[s\].
    ///
    /// # Errors
    /// [`Error::Value`] unless the period is positive and finite.
    pub fn new(period: f64) -> Result<Self, Error> {
        Ok(Self {
            period: positive("the control period", period)?,
            now: None,
            present: None,
            behind: 0.0,
            late_share: 0.0,
            newest: None,
        })
    }

    /// Returns the largest delay of a tick beyond one period after the tick before \[s\]. It is at least
    /// two periods, so that a slow loop may miss a tick.
    pub fn longest_gap(&self) -> f64 {
        GAP.max(2.0 * self.period)
    }

    /// Sets the time `now` \[s\] before the tick. Frames taken until the tick are judged by it
    /// instead of by the last tick, which may be long ago.
    pub fn set_present(&mut self, now: f64) {
        self.present = Some(now).filter(|now| now.is_finite());
    }

    /// Takes the time `now` of a tick \[s\].
    pub fn tick(&mut self, now: f64) -> Tick {
        self.present = None;
        if !now.is_finite() {
            let fault = Some(ClockFault::NotFinite.into());
            return Tick { elapsed: self.period, fault, forgets: false };
        }
        let (elapsed, fault) =
            self.now.replace(now).map_or((self.period, None), |last| self.judge(now - last));
        let stale = self.newest.and_then(|stamp| self.misplaced(stamp, now));
        if stale.is_some() {
            self.newest = None;
        }
        Tick { elapsed, fault: fault.or(stale.map(Fault::from)), forgets: stale.is_some() }
    }

    /// Returns the time since the last tick, as it is to be used, and its fault.
    fn judge(&mut self, elapsed: f64) -> (f64, Option<Fault>) {
        let period = self.period;
        let fault = if elapsed < 0.0 {
            Some(ClockFault::SetBack)
        } else if elapsed <= STANDING * period {
            Some(ClockFault::StandsStill)
        } else if elapsed - period > self.longest_gap() + ROUNDING * period {
            Some(ClockFault::SetAhead)
        } else {
            None
        };
        if let Some(fault) = fault {
            self.behind = 0.0;
            return (period, Some(fault.into()));
        }
        let is_late = elapsed > (1.0 + Self::TOLERANCE + ROUNDING) * period;
        self.late_share += NEWEST * (f64::from(u8::from(is_late)) - self.late_share);
        let before_due = period - self.behind.max(0.0) - elapsed;
        // Time since the first due time without a tick. A late tick takes the place of the last due
        // time that has passed.
        let after = self.behind + elapsed - period;
        let missed = (after / period + NEAR).floor();
        // The clock may be faster than the period within the tolerance. An earlier tick moves the
        // due times.
        self.behind = if missed < 0.0 { 0.0 } else { after - missed * period };
        let exact = (elapsed - period).abs() <= ROUNDING * period;
        let fault = if before_due > (Self::TOLERANCE + ROUNDING) * period {
            Some(Fault::EarlyTick)
        } else {
            (self.late_share > MOST).then_some(Fault::LateTick)
        };
        (if exact { period } else { elapsed }, fault)
    }

    /// Takes the stamp of a frame that has arrived \[s\].
    ///
    /// Before the first tick the current time is not known. The first tick then judges the newest
    /// frame.
    ///
    /// # Errors
    /// The reason why the frame counts as no data. The clock is then unchanged.
    pub fn frame(&mut self, stamp: f64) -> Result<(), FrameFault> {
        if !stamp.is_finite() {
            return Err(FrameFault::NotFinite);
        }
        let present = self.present.or(self.now);
        if let Some(fault) = present.and_then(|now| self.misplaced(stamp, now)) {
            return Err(fault);
        }
        match self.newest {
            Some(newest) if stamp == newest => Err(FrameFault::Repeated),
            Some(newest) if stamp < newest => Err(FrameFault::OutOfOrder),
            _ => {
                self.newest = Some(stamp);
                Ok(())
            }
        }
    }

    /// Returns the fault of a stamp relative to a tick at `now`. A frame may be taken until the
    /// next tick.
    fn misplaced(&self, stamp: f64, now: f64) -> Option<FrameFault> {
        let latest = now + (1.0 + Self::TOLERANCE) * self.period + Self::AHEAD;
        if (stamp - now).abs() > EPOCH {
            Some(FrameFault::ForeignEpoch)
        } else if stamp > latest {
            Some(FrameFault::Future)
        } else {
            None
        }
    }

    /// Returns the age of the newest frame at the last tick. It is [`Age::NEVER`] before the first
    /// frame or tick.
    pub fn age(&self) -> Age {
        self.newest.zip(self.now).map_or(Age::NEVER, |(stamp, now)| Age::since(stamp, now))
    }

    /// Returns the time of the last tick that had a finite time \[s\].
    pub fn now(&self) -> Option<f64> {
        self.now
    }

    /// Returns the stamp of the newest frame \[s\].
    pub fn newest(&self) -> Option<f64> {
        self.newest
    }
}
