//! The one clock of a control loop: its ticks, and the stamps of camera frames.

use crate::age::Age;
use crate::error::{Error, not_negative, positive};
use crate::fault::{ClockFault, Fault, FrameFault};

/// How far times may differ from what is expected.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize, schemars::JsonSchema))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct ClockSettings {
    /// By which share of the period a tick may come before it is due, or after; sooner is an early
    /// tick, later a late one \[-\]. Default 0.5.
    pub tolerance: f64,
    /// How much later than a period after the one before a tick may come; beyond that the clock was
    /// set, or the loop stood \[s\]. Default 0.1.
    pub gap: f64,
    /// How far a frame's stamp may lie ahead of the ticks, for clocks that agree only nearly \[s\].
    /// Below a day. Default 0.005.
    pub ahead: f64,
}

/// Stamp and tick that differ by more count from different origins \[s\]: a day. No frame is so old, and
/// seconds since 1970 and since the start of a machine differ by decades.
const EPOCH: f64 = 86_400.0;

impl Default for ClockSettings {
    fn default() -> Self {
        Self { tolerance: 0.5, gap: 0.1, ahead: 0.005 }
    }
}

impl ClockSettings {
    /// Checks the ranges, for a control `period` \[s\].
    ///
    /// # Errors
    /// [`Error::Value`] names the first that is out of its range.
    pub fn validate(&self, period: f64) -> Result<(), Error> {
        positive("the control period", period)?;
        if !(self.tolerance > 0.0 && self.tolerance < 1.0) {
            let (name, value) = ("clock.tolerance", self.tolerance);
            return Err(Error::Value { what: name, got: value, wanted: "above 0 and below 1" });
        }
        if self.gap.is_nan() || self.gap < (1.0 + self.tolerance) * period {
            let (name, value) = ("clock.gap", self.gap);
            let expected = "at least the longest time between ticks that the tolerance admits";
            return Err(Error::Value { what: name, got: value, wanted: expected });
        }
        not_negative("clock.ahead", self.ahead)?;
        if self.ahead >= EPOCH {
            let (what, wanted) = ("clock.ahead", "below a day, 86,400 s");
            return Err(Error::Value { what, got: self.ahead, wanted });
        }
        Ok(())
    }
}

/// Two ticks that are nearer than this share of the period are at the same time.
const STANDING: f64 = 1e-3;
/// Two ticks are a period apart when their times differ from it by less than this share: times in
/// seconds since 1970 are that coarse.
const ROUNDING: f64 = 1e-3;
/// A tick that comes less than this share of the period before it is due comes when it is due.
const NEAR: f64 = 0.02;
/// The weight of a tick in the share of late ones: about the last twenty count.
const NEWEST: f64 = 0.05;
/// A loop is late above this share of late ticks: half of them, and what the newest make of it.
const MOST: f64 = 0.6;

/// What the time of a tick says.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tick {
    /// The time since the tick before \[s\]; the period where the clock does not say.
    pub elapsed: f64,
    /// What is wrong with it.
    pub fault: Option<Fault>,
    /// Whether all frames taken so far count no longer, because they lie after this tick, or in
    /// another epoch: what came of them is to be forgotten.
    pub forgets: bool,
}

/// Checks the times of ticks and frames, all of them in seconds on one clock, of any origin, that
/// neither stands still nor is set.
///
/// Ticks are due once a period, and one that is missed is not made up for. A tick is early that comes before
/// it is due, by more than the tolerance; after a late tick the next is due at its own time all the same. A
/// tick that is late is no fault. It is one that most of the last ticks were: the loop is then slower than
/// its period.
///
/// Frames are stamped with the time at which the camera took them, arrive
/// later, and each is newer than the one before; one that is not is refused and leaves no trace.
///
/// ```
/// use hrsw_safety::{ClockSettings, FrameFault, LoopClock};
///
/// let mut clock = LoopClock::new(1e-3, ClockSettings::default())?;
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
    settings: ClockSettings,
    period: f64,
    now: Option<f64>,
    /// The time, where it was told before the tick \[s\].
    present: Option<f64>,
    /// How long before the last tick it was due, less than a period; negative for one that came just before \[s\].
    behind: f64,
    /// Of the last ticks.
    late_share: f64,
    newest: Option<f64>,
}

impl LoopClock {
    /// Before the first tick, for a control `period` \[s\].
    ///
    /// # Errors
    /// [`Error::Value`] for settings out of range.
    pub fn new(period: f64, settings: ClockSettings) -> Result<Self, Error> {
        settings.validate(period)?;
        Ok(Self {
            settings,
            period,
            now: None,
            present: None,
            behind: 0.0,
            late_share: 0.0,
            newest: None,
        })
    }

    /// Takes the time `now` \[s\] before the tick: frames that are taken until then are judged by it, and not by the
    /// last tick, which may be long ago.
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

    /// The time since the last tick, as it is to be used, and what is wrong with it.
    fn judge(&mut self, elapsed: f64) -> (f64, Option<Fault>) {
        let Self { settings, period, .. } = *self;
        let fault = if elapsed < 0.0 {
            Some(ClockFault::SetBack)
        } else if elapsed <= STANDING * period {
            Some(ClockFault::StandsStill)
        } else if elapsed - period > settings.gap + ROUNDING * period {
            Some(ClockFault::SetAhead)
        } else {
            None
        };
        if let Some(fault) = fault {
            self.behind = 0.0;
            return (period, Some(fault.into()));
        }
        let is_late = elapsed > (1.0 + settings.tolerance + ROUNDING) * period;
        self.late_share += NEWEST * (f64::from(u8::from(is_late)) - self.late_share);
        let before_due = period - self.behind.max(0.0) - elapsed;
        // After the first due time that no tick has come for yet. Of those that have passed it stands for the last.
        let after = self.behind + elapsed - period;
        let missed = (after / period + NEAR).floor();
        // The clock may be faster than the period by the tolerance: an earlier tick moves the due times.
        self.behind = if missed < 0.0 { 0.0 } else { after - missed * period };
        let exact = (elapsed - period).abs() <= ROUNDING * period;
        let fault = if before_due > (settings.tolerance + ROUNDING) * period {
            Some(Fault::EarlyTick)
        } else {
            (self.late_share > MOST).then_some(Fault::LateTick)
        };
        (if exact { period } else { elapsed }, fault)
    }

    /// Takes the stamp of a frame that has arrived \[s\].
    ///
    /// Until the first tick the present is not known; the tick then judges what has come.
    ///
    /// # Errors
    /// Why the frame counts as no data; the clock is then as it was.
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

    /// What is wrong with a stamp against a tick at `now`; a frame may be taken until the next tick.
    fn misplaced(&self, stamp: f64, now: f64) -> Option<FrameFault> {
        let ClockSettings { tolerance, ahead, .. } = self.settings;
        let latest = now + (1.0 + tolerance) * self.period + ahead;
        if (stamp - now).abs() > EPOCH {
            Some(FrameFault::ForeignEpoch)
        } else if stamp > latest {
            Some(FrameFault::Future)
        } else {
            None
        }
    }

    /// The age of the newest frame at the last tick; [`Age::NEVER`] before the first of either.
    pub fn age(&self) -> Age {
        self.newest.zip(self.now).map_or(Age::NEVER, |(stamp, now)| Age::since(stamp, now))
    }

    /// The time of the last tick that had one \[s\].
    pub fn now(&self) -> Option<f64> {
        self.now
    }

    /// The stamp of the newest frame \[s\].
    pub fn newest(&self) -> Option<f64> {
        self.newest
    }
}
