//! A point that stands or moves.

use nalgebra::{SMatrix, SVector};

use super::filter::{Measurement, Motion, PointFilter};

/// Rates at which a standing point begins to move, and a moving point stops (1/s).
const BEGINS: f64 = 0.01;
const STOPS: f64 = 0.2;

/// Largest logarithm of the factor by which one measurement changes the odds. One wrong measurement
/// counts little.
const MOST: f64 = 2.0;

/// Two Kalman filters, one for a moving and one for a standing point, weighted by how well each
/// explains the measurements.
///
/// Interacting multiple models (Blom and Bar-Shalom 1988). Only the standing filter is mixed with
/// the other: a point that stops stays where it is. Position and velocity are the weighted means.
/// The covariances are those of the moving filter about these means, since a standing point may
/// have just begun to move.
#[derive(Clone, Copy, Debug)]
pub(super) struct TwoModels<const D: usize> {
    moving: PointFilter<D>,
    standing: PointFilter<D>,
    /// Probability that the point stands.
    stands: f64,
}

impl<const D: usize> TwoModels<D> {
    /// Creates the filters at the measured position. The point may stand or move.
    pub(super) fn starting_at(measured: &Measurement<D>, motion: &Motion) -> Self {
        let moving = PointFilter::starting_at(measured, motion);
        Self { moving, standing: moving.at_rest(), stands: 0.5 }
    }

    /// Returns the state after a time without a measurement (s).
    pub(super) fn advanced(&self, elapsed: f64, motion: &Motion) -> Self {
        Self {
            moving: self.moving.advanced(&motion.moving(elapsed)),
            standing: self.standing.advanced(&motion.standing(elapsed)),
            ..*self
        }
    }

    /// Returns the state after a time (s) and a measurement.
    pub(super) fn corrected(
        &self,
        measured: &Measurement<D>,
        elapsed: f64,
        motion: &Motion,
    ) -> Self {
        let within = |rate: f64| 1.0 - (-rate * elapsed).exp();
        let stopped = (1.0 - self.stands) * within(STOPS);
        let stands = stopped + self.stands * (1.0 - within(BEGINS));
        let standing =
            self.standing.mixed_with(&self.moving.at_rest(), stopped / stands.max(1e-12));
        let (standing, if_standing) = standing.corrected(measured, &motion.standing(elapsed));
        let (moving, if_moving) = self.moving.corrected(measured, &motion.moving(elapsed));
        let likely = stands * (if_standing - if_moving).clamp(-MOST, MOST).exp();
        let moving = moving.no_faster_than(motion.max_speed);
        Self { moving, standing, stands: likely / (likely + 1.0 - stands) }
    }

    /// See [`Measurement::distance_squared`].
    pub(super) fn distance_squared(&self, measured: &Measurement<D>) -> f64 {
        measured.distance_squared(self.position(), self.position_covariance())
    }

    pub(super) fn position(&self) -> SVector<f64, D> {
        self.moving.position() + self.away()
    }

    pub(super) fn velocity(&self) -> SVector<f64, D> {
        self.moving.velocity() * (1.0 - self.share())
    }

    pub(super) fn position_covariance(&self) -> SMatrix<f64, D, D> {
        self.moving.position_covariance() + self.away() * self.away().transpose()
    }

    pub(super) fn velocity_covariance(&self) -> SMatrix<f64, D, D> {
        let away = self.moving.velocity() * self.share();
        self.moving.velocity_covariance() + away * away.transpose()
    }

    /// Returns the weight of the standing filter: 0 if moving is more probable, 1 if moving has
    /// less than a tenth.
    fn share(&self) -> f64 {
        ((self.stands - 0.5) / 0.4).clamp(0.0, 1.0)
    }

    /// Returns the vector from the moving filter's position to the weighted mean.
    fn away(&self) -> SVector<f64, D> {
        (self.standing.position() - self.moving.position()) * self.share()
    }
}
