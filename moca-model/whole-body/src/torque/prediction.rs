//! Prediction of joint states between measurements.

use super::impedance::{JointState, RateLimit};
use crate::error::{Error, check_size};

/// Age up to which a measurement has full weight \[s\]. It leaves the largest gains that are stable at any delay a margin
/// of a third.
const IN_FULL: f64 = 2.5e-3;
/// Age up to which joints are predicted from measurements, and the time in which the weight then fades to zero \[s\].
const LOST: f64 = 8e-3;
const FADE: f64 = 4e-3;
/// Time in which the weight returns after measurements were overdue \[s\]. It is the time in which such joints come to
/// rest.
const RETURN: f64 = 0.2;
/// Time constants with which joints are brought to rest, without measurements and after them \[s\]. Commanded
/// accelerations could need torques that the torque rate cannot follow, and the joints would lag differently. Measured
/// joints are also held against friction that is not modelled.
const BRAKING: f64 = 0.1;
const SETTLING: f64 = 0.05;
/// Share of â that the model provides while measurements have full weight, and the time constant with which it follows
/// \[s\]. A larger share follows the command more closely. A robot whose commands get lost keeps that acceleration.
const MODELLED: f64 = 0.6;
const SMOOTHING: f64 = 0.03;
/// Number of ticks whose commanded accelerations are stored, at least those of 8 ms.
const REMEMBERED: usize = 16;

/// Predicts the present positions and velocities of joints from what was measured `age` seconds ago.
///
/// Each joint is assumed to accelerate as commanded since the measurement, â = q̈*. Once the next measurement is
/// overdue ([`MeasurementWatch::awaited`](crate::torque::MeasurementWatch::awaited)) or the robot does not take commands
/// ([`set_unheard`](Self::set_unheard)), joints with torque drives are brought to rest: â = c q̈* − (1 − c) v̂ / T. The
/// confidence c is the lowest weight since, and returns to 1 within 0.2 s. T is 0.1 s without measurements, else 0.05 s.
/// The predictions are v̂ = v + ∫ â dt and q̂ = q + ∫ v̂ dt.
///
/// The weight w says how far the measurement can be trusted. It is 1 up to an age of 2.5 ms, then 2.5 ms over the age,
/// and falls to 0 from 8 to 12 ms. It is at most c, since q̇* has meanwhile changed otherwise than q̇. Springs and dampers
/// on the predicted state are weighted by it, because a damper on an old velocity is a constant push. The model provides
/// the remaining share 1 − w of M(q̂) â + C(q̂, v̂) v̂, and a part of M(q̂) â always.
///
/// ```
/// use whole_body::torque::{JointState, StatePrediction};
///
/// let mut prediction = StatePrediction::new(&[0.0], &[0]);
/// let measured = JointState { position: &[0.0], velocity: &[1.0] };
/// prediction.update(measured, &[1.0], 0.0, 5e-3, 1e-3)?;
/// for tick in 1..=4 {
///     // Nothing comes, and the command slows down by 0.01 rad/s a tick.
///     let age = 1e-3 * f64::from(tick);
///     prediction.update(measured, &[1.0 - 0.01 * f64::from(tick)], age, 5e-3, 1e-3)?;
/// }
/// assert!((prediction.velocity()[0] - 0.96).abs() < 1e-12);
/// assert!((prediction.weight() - 0.625).abs() < 1e-12);
/// // A measurement after 9 ms of silence does not count in full at once.
/// for tick in 5..=9 {
///     prediction.update(measured, &[0.9], 1e-3 * f64::from(tick), 5e-3, 1e-3)?;
/// }
/// prediction.update(measured, &[0.9], 0.0, 5e-3, 1e-3)?;
/// assert!(prediction.weight() < 0.3);
/// # Ok::<(), whole_body::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct StatePrediction {
    position: Vec<f64>,
    velocity: Vec<f64>,
    /// q̇* of the last tick.
    commanded: Vec<f64>,
    /// â of the last tick.
    acceleration: Vec<f64>,
    /// The part of â that the model provides.
    modelled: Vec<f64>,
    /// True if each joint has a torque drive.
    driven: Vec<bool>,
    /// Changes of q̇* in the last ticks.
    changes: Vec<Vec<f64>>,
    /// Index of the newest change.
    newest: usize,
    /// True if q̇* of an earlier tick is known.
    began: bool,
    /// Age of the measurement \[s\].
    age: f64,
    /// True if the next measurement is overdue.
    is_overdue: bool,
    /// The confidence c, an upper bound of the weight.
    trust: f64,
    /// True if the robot did not take the last commands.
    is_unheard: bool,
}

/// The weight of a measurement of this age \[s\], 0 to 1. It is 0 if the age is NaN.
fn weight(age: f64) -> f64 {
    let weight = (IN_FULL / age).min(1.0) * ((LOST + FADE - age) / FADE).min(1.0);
    if weight > 0.0 { weight } else { 0.0 }
}

impl StatePrediction {
    /// Creates a prediction for joints at rest. `driven` are the indices of those with torque drives; the others follow
    /// velocities.
    pub fn new(position: &[f64], driven: &[usize]) -> Self {
        let none = vec![0.0; position.len()];
        Self {
            position: position.to_vec(),
            velocity: none.clone(),
            commanded: none.clone(),
            acceleration: none.clone(),
            modelled: none.clone(),
            driven: (0..position.len()).map(|joint| driven.contains(&joint)).collect(),
            changes: vec![none; REMEMBERED],
            newest: 0,
            began: false,
            age: 0.0,
            is_overdue: false,
            trust: 1.0,
            is_unheard: false,
        }
    }

    /// Takes the last measurement, `age` \[s\] old, and q̇* of the period that ends now, one element a joint. The next
    /// measurement is overdue above an age of `awaited` \[s\], at most 8 ms. Allocates nothing.
    ///
    /// # Errors
    /// [`Error::Size`]; nothing is then changed.
    pub fn update(
        &mut self,
        measured: JointState<'_>,
        commanded: &[f64],
        age: f64,
        awaited: f64,
        period: f64,
    ) -> Result<(), Error> {
        let joints = self.position.len();
        check_size("the measured position", measured.position.len(), joints)?;
        check_size("the measured velocity", measured.velocity.len(), joints)?;
        check_size("the commanded velocity", commanded.len(), joints)?;
        self.remember(commanded);
        self.age = if age > 0.0 { age } else { 0.0 };
        self.is_overdue = self.age > awaited.min(LOST);
        self.trust = if self.is_overdue {
            self.trust.min(weight(self.age))
        } else {
            (self.trust + period / RETURN).min(1.0)
        };
        if self.is_unheard {
            self.trust = 0.0;
        }
        self.accelerate(period);
        if self.is_overdue {
            let joints = self.position.iter_mut().zip(&mut self.velocity).zip(&self.acceleration);
            for ((position, velocity), acceleration) in joints {
                *velocity += acceleration * period;
                *position += *velocity * period;
            }
            return Ok(());
        }
        self.position.copy_from_slice(measured.position);
        self.velocity.copy_from_slice(measured.velocity);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 8 ms")]
        let ticks = ((self.age / period).round() as usize).min(REMEMBERED);
        (0..ticks).rev().for_each(|back| self.go_on(back, period));
        Ok(())
    }

    /// Computes â of this tick.
    fn accelerate(&mut self, period: f64) {
        let Some(changes) = self.changes.get(self.newest) else { return };
        let braking = if self.is_overdue { BRAKING } else { SETTLING };
        let joints =
            self.acceleration.iter_mut().zip(changes).zip(&self.velocity).zip(&self.driven);
        for (((acceleration, change), velocity), is_driven) in joints {
            let trust = if *is_driven { self.trust } else { 1.0 };
            *acceleration = trust * change / period - (1.0 - trust) * velocity / braking;
        }
        self.model(period);
    }

    /// Computes the part of â that the model provides.
    fn model(&mut self, period: f64) {
        let (weight, follows) = (self.weight(), (period / SMOOTHING).min(1.0));
        let joints = self.modelled.iter_mut().zip(&self.acceleration).zip(&self.driven);
        for ((modelled, acceleration), is_driven) in joints {
            let (share, follows) = if *is_driven {
                (1.0 - weight + weight * MODELLED, 1.0 - weight + weight * follows)
            } else {
                (1.0, follows)
            };
            *modelled += follows * (share * acceleration - *modelled);
        }
    }

    /// Sets whether the robot does not take commands. The weight is zero meanwhile.
    pub fn set_unheard(&mut self, is_unheard: bool) {
        self.is_unheard = is_unheard;
    }

    fn remember(&mut self, commanded: &[f64]) {
        self.newest = (self.newest + 1) % REMEMBERED;
        if let Some(change) = self.changes.get_mut(self.newest) {
            for ((change, now), before) in change.iter_mut().zip(commanded).zip(&self.commanded) {
                *change = if self.began { now - before } else { 0.0 };
            }
        }
        self.commanded.copy_from_slice(commanded);
        self.began = true;
    }

    /// Advances the prediction by a period in which q̇* changed as `back` ticks ago.
    fn go_on(&mut self, back: usize, period: f64) {
        let index = (self.newest + REMEMBERED - back) % REMEMBERED;
        let Some(changes) = self.changes.get(index) else { return };
        let joints = self.position.iter_mut().zip(&mut self.velocity).zip(changes);
        for ((position, velocity), change) in joints {
            *velocity += change;
            *position += *velocity * period;
        }
    }

    /// The accelerations that the model provides \[rad/s² or m/s²\], beside springs and dampers.
    ///
    /// They follow â with 0.03 s: all of it for joints that follow velocities, whose motion pushes the others, and 60 %
    /// of it for joints with torque drives. While the weight w is below 1, a share 1 − w of â counts at once and in full.
    pub(crate) fn modelled_acceleration(&self) -> &[f64] {
        &self.modelled
    }

    /// q̂ \[rad or m\].
    pub fn position(&self) -> &[f64] {
        &self.position
    }

    /// v̂ \[rad/s or m/s\].
    pub fn velocity(&self) -> &[f64] {
        &self.velocity
    }

    /// The weight of the measurement, 0 to 1.
    pub fn weight(&self) -> f64 {
        weight(self.age).min(self.trust)
    }

    /// True if c is below 1, because measurements were overdue or commands lost. The desired position should then
    /// restart from the measured one in each tick, so that no error of that time is corrected.
    pub fn is_recovering(&self) -> bool {
        self.trust < 1.0
    }

    /// The way in which torques change: together while measurements do not have full weight.
    pub(crate) fn rate_limit(&self) -> RateLimit {
        if self.weight() < 1.0 { RateLimit::Together } else { RateLimit::Each }
    }
}
