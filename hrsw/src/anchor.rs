//! Frames to which a workspace is attached. Their measurements are late, noisy and not periodic.

use nalgebra::{Isometry3, Vector3, Vector6};

use crate::error::{Error, check_all, check_pose, not_negative, positive};
use crate::motion::{is_period, moved};

/// Two measurements whose ages differ by less are the same one \[s\]. Ages are sums of periods.
const SIMULTANEOUS: f64 = 1e-6;

/// Extrapolation of a frame that is not seen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AnchorSettings {
    /// Time for which it moves on with the last measured velocity \[s\]. Default 0.2, four frames
    /// of a 20 Hz camera.
    pub extrapolation: f64,
    /// Time in which it then comes to rest \[s\]. Default 0.3.
    pub braking: f64,
}

impl Default for AnchorSettings {
    fn default() -> Self {
        Self { extrapolation: 0.2, braking: 0.3 }
    }
}

impl AnchorSettings {
    /// Returns the time at full speed that gives the displacement after `age`. It is ∫ c dt, where
    /// c is the share of the velocity: 1 at first, then falling to 0.
    fn coasted(&self, age: f64) -> f64 {
        let Self { extrapolation, braking } = *self;
        let beyond = (age - extrapolation).clamp(0.0, braking);
        age.min(extrapolation) + beyond * (1.0 - 0.5 * beyond / braking)
    }
}

/// A measured frame that is extrapolated between measurements for a bounded time, and then stands
/// still.
///
/// ```
/// use hrsw::{Anchor, AnchorSettings};
/// use nalgebra::{Isometry3, Vector6};
///
/// let mut person = Anchor::new(AnchorSettings::default())?;
/// let walking = Vector6::new(1.0, 0.0, 0.0, 0.0, 0.0, 0.0);
/// person.observe(Isometry3::identity(), walking, 0.1)?; // seen a tenth of a second ago
/// for _ in 0..1000 {
///     person.advance(1e-3);
/// }
/// // 0.2 s at 1 m/s, then 0.3 s of braking.
/// assert!((person.pose().map_or(0.0, |pose| pose.translation.x) - 0.35).abs() < 1e-3);
/// # Ok::<(), hrsw::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Anchor {
    settings: AnchorSettings,
    pose: Option<Isometry3<f64>>,
    measured: Vector6<f64>,
    age: f64,
}

impl Anchor {
    /// Creates a frame that was never seen.
    ///
    /// # Errors
    /// [`Error::Value`] if a time is not positive and finite.
    pub fn new(settings: AnchorSettings) -> Result<Self, Error> {
        positive("the extrapolation time", settings.extrapolation)?;
        positive("the braking time of an anchor", settings.braking)?;
        Ok(Self { settings, pose: None, measured: Vector6::zeros(), age: f64::INFINITY })
    }

    /// Takes a measurement of age `age` \[s\]: the pose at that time and the velocity, linear at
    /// the origin, then angular, in world axes.
    ///
    /// # Errors
    /// [`Error::Value`] if the pose is invalid or the age negative. [`Error::OutOfOrder`] if the
    /// measurement is older than the newest one. The frame is then unchanged.
    pub fn observe(
        &mut self,
        pose: Isometry3<f64>,
        twist: Vector6<f64>,
        age: f64,
    ) -> Result<(), Error> {
        check_pose(&pose)?;
        check_all("the twist of an anchor", twist.iter())?;
        let age = not_negative("the age of a measurement", age)?;
        if age > self.age + SIMULTANEOUS {
            return Err(Error::OutOfOrder { age, newest: self.age });
        }
        let now = carried(&pose, &twist, self.settings.coasted(age));
        check_pose(&now)?;
        self.pose = Some(now);
        self.measured = twist;
        self.age = age;
        Ok(())
    }

    /// Advances by `period` \[s\]. A period that is not positive and finite has no effect.
    pub fn advance(&mut self, period: f64) {
        if !is_period(period) {
            return;
        }
        if let Some(pose) = &mut self.pose {
            let later = self.age + period;
            let time = self.settings.coasted(later) - self.settings.coasted(self.age);
            *pose = carried(pose, &self.measured, time);
            self.age = later;
        }
    }

    /// Returns the extrapolated pose. None before the first measurement.
    pub fn pose(&self) -> Option<&Isometry3<f64>> {
        self.pose.as_ref()
    }

    /// Returns the extrapolated velocity: first as measured, then braking, then zero.
    pub fn twist(&self) -> Vector6<f64> {
        let beyond = (self.age - self.settings.extrapolation) / self.settings.braking;
        self.measured * (1.0 - beyond).clamp(0.0, 1.0)
    }

    /// Returns the age of the last measurement \[s\], infinite before the first one.
    pub fn age(&self) -> f64 {
        self.age
    }
}

/// Returns the pose after `time` at `twist`.
fn carried(pose: &Isometry3<f64>, twist: &Vector6<f64>, time: f64) -> Isometry3<f64> {
    let part = |at: usize| Vector3::new(twist[at], twist[at + 1], twist[at + 2]) * time;
    moved(pose, &part(0), &part(3))
}
