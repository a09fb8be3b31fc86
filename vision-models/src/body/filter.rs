//! Kalman filter of a point whose measurement errors are correlated in time.

use std::array::from_fn;

use nalgebra::{Matrix3, SMatrix, SVector};

/// Kalman filter over D axes. Its state is the position, the velocity and the lasting part of the
/// measurement error.
///
/// The lasting error is a Gauss-Markov process: it fades with the correlation time, and each
/// measurement renews it. Measurements with a common error therefore count as less information.
#[derive(Clone, Copy, Debug)]
pub(super) struct PointFilter<const D: usize> {
    mean: [SVector<f64, D>; 3],
    /// Covariance of each block of the state (rows) with each other block (columns).
    covariance: [[SMatrix<f64, D, D>; 3]; 3],
}

/// Share of the variance of measured joints that lasts from frame to frame. Errors of real
/// detectors have correlations of 0.72, 0.51 and 0.31 after 0.05, 0.1 and 0.2 s.
pub(super) const LASTING: f64 = 0.9;

/// Distance from the expected position above which a measurement has less weight (standard
/// deviations).
const LIKELY: f64 = 1.5;

const POSITION: usize = 0;
const VELOCITY: usize = 1;
const ERROR: usize = 2;

/// A measured position.
#[derive(Clone, Copy, Debug)]
pub(super) struct Measurement<const D: usize> {
    pub(super) position: SVector<f64, D>,
    pub(super) covariance: SMatrix<f64, D, D>,
    /// Share of the variance that lasts.
    pub(super) lasting: f64,
}

/// The filter's model of the motion.
#[derive(Clone, Copy, Debug)]
pub(super) struct Motion {
    /// Spectral density of the acceleration of a moving point (unit²/s³).
    pub(super) density: f64,
    /// Spectral density of the velocity of a standing point (unit²/s).
    pub(super) drift: f64,
    /// Largest speed (unit/s). A third of it is the initial standard deviation of the velocity.
    pub(super) max_speed: f64,
    /// Longest time for which the motion continues without a measurement (s).
    pub(super) coasts: f64,
    /// Correlation time of the errors (s).
    pub(super) correlation_time: f64,
}

/// Effect of a time step on the three blocks, equal for all axes, and the noise that it adds.
pub(super) struct Transition {
    state: Matrix3<f64>,
    noise: Matrix3<f64>,
    /// Correlation of the errors over the step.
    correlation: f64,
}

impl Motion {
    /// Returns the step of a moving point: nearly constant velocity with white acceleration.
    pub(super) fn moving(&self, elapsed: f64) -> Transition {
        let correlation = self.correlation(elapsed);
        let (t, q) = (elapsed, self.density);
        let (cubic, square) = (q * t.powi(3) / 3.0, q * t * t / 2.0);
        Transition {
            state: Matrix3::new(1.0, t.min(self.coasts), 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, correlation),
            noise: Matrix3::new(cubic, square, 0.0, square, q * t, 0.0, 0.0, 0.0, 0.0),
            correlation,
        }
    }

    /// Returns the step of a standing point, which only drifts.
    pub(super) fn standing(&self, elapsed: f64) -> Transition {
        let correlation = self.correlation(elapsed);
        let mut noise = Matrix3::zeros();
        noise[(POSITION, POSITION)] = self.drift * elapsed;
        let state = Matrix3::from_diagonal(&[1.0, 0.0, correlation].into());
        Transition { state, noise, correlation }
    }

    fn correlation(&self, elapsed: f64) -> f64 {
        (-elapsed / self.correlation_time.max(1e-9)).exp()
    }
}

impl<const D: usize> Measurement<D> {
    /// Combines two measurements of one position, each weighted by its information.
    pub(super) fn with(&self, other: &Self) -> Option<Self> {
        let (one, two) = (self.covariance.cholesky()?, other.covariance.cholesky()?);
        let covariance = (one.inverse() + two.inverse()).cholesky()?.inverse();
        let position = covariance * (one.solve(&self.position) + two.solve(&other.position));
        Some(Self { position, covariance, lasting: self.lasting })
    }

    /// Returns the squared Mahalanobis distance from a position with this covariance. Infinite if
    /// the covariances are invalid.
    pub(super) fn distance_squared(
        &self,
        position: SVector<f64, D>,
        covariance: SMatrix<f64, D, D>,
    ) -> f64 {
        let innovation = self.position - position;
        (covariance + self.covariance)
            .cholesky()
            .map_or(f64::INFINITY, |factor| innovation.dot(&factor.solve(&innovation)))
    }
}

impl<const D: usize> PointFilter<D> {
    /// Creates a filter at rest at the measured position.
    pub(super) fn starting_at(measured: &Measurement<D>, motion: &Motion) -> Self {
        let lasting = measured.covariance * measured.lasting;
        let velocity = SMatrix::identity() * (motion.max_speed / 3.0).powi(2);
        let none = SMatrix::zeros();
        Self {
            mean: [measured.position, SVector::zeros(), SVector::zeros()],
            covariance: [
                [measured.covariance, none, -lasting],
                [none, velocity, none],
                [-lasting, none, lasting],
            ],
        }
    }

    /// Returns the state after a step without a measurement.
    pub(super) fn advanced(&self, over: &Transition) -> Self {
        let Transition { state, noise, .. } = over;
        let half: [[SMatrix<f64, D, D>; 3]; 3] = from_fn(|row| {
            from_fn(|column| (0..3).map(|k| self.covariance[k][column] * state[(row, k)]).sum())
        });
        Self {
            mean: from_fn(|row| (0..3).map(|k| self.mean[k] * state[(row, k)]).sum()),
            covariance: from_fn(|row| {
                from_fn(|column| {
                    let moved: SMatrix<f64, D, D> =
                        (0..3).map(|k| half[row][k] * state[(column, k)]).sum();
                    moved + SMatrix::identity() * noise[(row, column)]
                })
            }),
        }
    }

    /// Returns the state after a step and a measurement. Also returns the log-likelihood of the
    /// measurement up to a constant. A measurement with an invalid covariance changes nothing.
    pub(super) fn corrected(&self, measured: &Measurement<D>, over: &Transition) -> (Self, f64) {
        let mut filter = self.advanced(over);
        let lasting = measured.covariance * measured.lasting;
        filter.covariance[ERROR][ERROR] += lasting * (1.0 - over.correlation.powi(2));
        let with_measured: [SMatrix<f64, D, D>; 3] =
            from_fn(|row| filter.covariance[row][POSITION] + filter.covariance[row][ERROR]);
        let fresh = measured.covariance - lasting;
        let expected = with_measured[POSITION] + with_measured[ERROR] + fresh;
        let Some(factor) = expected.cholesky() else { return (filter, 0.0) };
        let innovation = measured.position - filter.mean[POSITION] - filter.mean[ERROR];
        let distance = innovation.dot(&factor.solve(&innovation));
        // Huber's weight (1964).
        let doubt = (distance.sqrt() / LIKELY).max(1.0);
        let gains = with_measured.map(|block| factor.solve(&block.transpose()).transpose() / doubt);
        for (mean, gain) in filter.mean.iter_mut().zip(&gains) {
            *mean += gain * innovation;
        }
        let corrected: [[SMatrix<f64, D, D>; 3]; 3] = from_fn(|row| {
            from_fn(|column| {
                filter.covariance[row][column] - gains[row] * with_measured[column].transpose()
            })
        });
        filter.covariance = from_fn(|row| {
            from_fn(|column| (corrected[row][column] + corrected[column][row].transpose()) * 0.5)
        });
        let volume = factor.determinant().ln() + D as f64 * doubt.ln();
        (filter, -0.5 * (distance / doubt + volume))
    }

    /// Returns the state with its speed limited (unit/s).
    pub(super) fn no_faster_than(mut self, speed: f64) -> Self {
        self.mean[VELOCITY] = self.mean[VELOCITY].cap_magnitude(speed);
        self
    }

    /// Returns the state with another velocity.
    pub(super) fn with_velocity(mut self, velocity: SVector<f64, D>) -> Self {
        self.mean[VELOCITY] = velocity;
        self
    }

    /// Returns the state at rest, without uncertainty of the velocity.
    pub(super) fn at_rest(mut self) -> Self {
        self.mean[VELOCITY] = SVector::zeros();
        self.covariance[VELOCITY] = [SMatrix::zeros(); 3];
        for row in &mut self.covariance {
            row[VELOCITY] = SMatrix::zeros();
        }
        self
    }

    /// Returns the mixture of this state and another one of probability `share`, with the mixture's
    /// mean and covariance.
    pub(super) fn mixed_with(&self, other: &Self, share: f64) -> Self {
        let apart: [_; 3] = from_fn(|row| other.mean[row] - self.mean[row]);
        Self {
            mean: from_fn(|row| self.mean[row] + apart[row] * share),
            covariance: from_fn(|row| {
                from_fn(|column| {
                    let spread = apart[row] * apart[column].transpose() * (1.0 - share);
                    self.covariance[row][column] * (1.0 - share)
                        + (other.covariance[row][column] + spread) * share
                })
            }),
        }
    }

    /// See [`Measurement::distance_squared`].
    pub(super) fn distance_squared(&self, measured: &Measurement<D>) -> f64 {
        measured.distance_squared(self.position(), self.position_covariance())
    }

    pub(super) fn position(&self) -> SVector<f64, D> {
        self.mean[POSITION]
    }

    pub(super) fn velocity(&self) -> SVector<f64, D> {
        self.mean[VELOCITY]
    }

    /// Returns the covariance of the position.
    pub(super) fn position_covariance(&self) -> SMatrix<f64, D, D> {
        self.covariance[POSITION][POSITION]
    }

    /// Returns the covariance of the velocity.
    pub(super) fn velocity_covariance(&self) -> SMatrix<f64, D, D> {
        self.covariance[VELOCITY][VELOCITY]
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{Matrix2, Matrix2x6, Matrix6, Vector6, vector};

    use super::*;

    const MOTION: Motion =
        Motion { density: 0.1, drift: 1e-5, max_speed: 3.0, coasts: 0.5, correlation_time: 0.16 };

    /// Compares with the filter of the whole state, every matrix written out.
    #[test]
    fn agrees_with_the_matrix_form() {
        let (dt, lasting) = (0.05_f64, 0.9);
        let correlation = (-dt / MOTION.correlation_time).exp();
        let (mut f, mut q) = (Matrix6::identity(), Matrix6::zeros());
        for axis in 0..2 {
            f[(axis, axis + 2)] = dt;
            f[(axis + 4, axis + 4)] = correlation;
            q[(axis, axis)] = MOTION.density * dt.powi(3) / 3.0;
            q[(axis, axis + 2)] = MOTION.density * dt * dt / 2.0;
            q[(axis + 2, axis)] = MOTION.density * dt * dt / 2.0;
            q[(axis + 2, axis + 2)] = MOTION.density * dt;
        }
        let mut h = Matrix2x6::zeros();
        h.fixed_view_mut::<2, 2>(0, 0).fill_with_identity();
        h.fixed_view_mut::<2, 2>(0, 4).fill_with_identity();
        let covariance = |k: i32| {
            let angle = f64::from(k);
            let axes = Matrix2::new(angle.cos(), -angle.sin(), angle.sin(), angle.cos());
            axes * Matrix2::new(0.04_f64.powi(2), 0.0, 0.0, 0.01_f64.powi(2)) * axes.transpose()
        };
        let start =
            Measurement { position: vector![0.4, -0.1], covariance: covariance(7), lasting };
        let mut filter = PointFilter::starting_at(&start, &MOTION);
        let mut x = Vector6::new(0.4, -0.1, 0.0, 0.0, 0.0, 0.0);
        let mut p = Matrix6::identity();
        p.fixed_view_mut::<2, 2>(0, 0).copy_from(&start.covariance);
        p.fixed_view_mut::<2, 2>(4, 4).copy_from(&(start.covariance * lasting));
        p.fixed_view_mut::<2, 2>(0, 4).copy_from(&(start.covariance * -lasting));
        p.fixed_view_mut::<2, 2>(4, 0).copy_from(&(start.covariance * -lasting));
        for k in 0..50 {
            let position = vector![0.4 + 0.02 * f64::from(k), 0.03 * f64::from(k * 7 % 5 - 2)];
            let r = covariance(k);
            let measured = Measurement { position, covariance: r, lasting };
            let (corrected, likely) = filter.corrected(&measured, &MOTION.moving(dt));
            filter = corrected;
            x = f * x;
            p = f * p * f.transpose() + q;
            let mut of_errors = p.fixed_view_mut::<2, 2>(4, 4);
            of_errors += r * lasting * (1.0 - correlation.powi(2));
            let innovation = position - h * x;
            let s = h * p * h.transpose() + r * (1.0 - lasting);
            let inverse = s.try_inverse().unwrap_or_default();
            let distance = innovation.dot(&(inverse * innovation));
            let doubt = (distance.sqrt() / LIKELY).max(1.0);
            let expected = -0.5 * (distance / doubt + (s * doubt).determinant().ln());
            assert!((likely - expected).abs() < 1e-9, "{likely} {expected}");
            let gain = p * h.transpose() * inverse / doubt;
            x += gain * innovation;
            p = (Matrix6::identity() - gain * h) * p;
            assert!((filter.position() - x.fixed_rows::<2>(0)).norm() < 1e-12);
            assert!((filter.velocity() - x.fixed_rows::<2>(2)).norm() < 1e-12);
            let position = filter.position_covariance() - p.fixed_view::<2, 2>(0, 0);
            let velocity = filter.velocity_covariance() - p.fixed_view::<2, 2>(2, 2);
            assert!(position.norm() < 1e-12 && velocity.norm() < 1e-12);
        }
    }

    #[test]
    fn follows_a_ramp_without_lag() {
        let covariance = Matrix2::identity() * 0.03_f64.powi(2);
        let at = |position| Measurement { position, covariance, lasting: 0.9 };
        let mut filter = PointFilter::starting_at(&at(vector![1.0, 2.0]), &MOTION);
        let velocity = vector![0.8, -0.3];
        for k in 1..=400 {
            let truth = vector![1.0, 2.0] + velocity * 0.05 * f64::from(k);
            (filter, _) = filter.corrected(&at(truth), &MOTION.moving(0.05));
        }
        assert!((filter.velocity() - velocity).norm() < 1e-6);
    }
}
