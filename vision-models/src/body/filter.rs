//! The Kalman filter of a point that moves with nearly constant velocity.

use nalgebra::{SVector, vector};

/// A Kalman filter over D axes that share one covariance, since noise and gains are the same for
/// each: state (position, velocity), transition x ← x + v Δt, white acceleration of spectral
/// density `density`, and measured positions of standard deviation `sigma`.
#[derive(Clone, Copy, Debug)]
pub(super) struct ConstantVelocity<const D: usize> {
    pub(super) position: SVector<f64, D>,
    pub(super) velocity: SVector<f64, D>,
    /// Variance of position, covariance, variance of velocity, for each axis.
    covariance: [f64; 3],
}

/// What the filter believes about noise.
#[derive(Clone, Copy, Debug)]
pub(super) struct Noise {
    /// Spectral density of the acceleration (unit²/s³).
    pub(super) density: f64,
    /// Standard deviation of a measurement (unit).
    pub(super) sigma: f64,
    /// No faster than this (unit/s); also the standard deviation of the velocity at the start.
    pub(super) max_speed: f64,
}

impl<const D: usize> ConstantVelocity<D> {
    /// At rest where it was measured.
    pub(super) fn starting_at(position: SVector<f64, D>, noise: &Noise) -> Self {
        Self {
            position,
            velocity: SVector::zeros(),
            covariance: [noise.sigma.powi(2), 0.0, (noise.max_speed / 3.0).powi(2)],
        }
    }

    /// The state after `dt` ≥ 0 seconds without a measurement.
    pub(super) fn advanced(&self, dt: f64, noise: &Noise) -> Self {
        let [pp, pv, vv] = self.covariance;
        let q = noise.density;
        Self {
            position: self.position + self.velocity * dt,
            velocity: self.velocity,
            covariance: [
                pp + dt * (2.0 * pv + dt * vv) + q * dt.powi(3) / 3.0,
                pv + dt * vv + q * dt.powi(2) / 2.0,
                vv + q * dt,
            ],
        }
    }

    /// How many standard deviations a measurement is away from what is expected.
    pub(super) fn surprise(&self, measured: &SVector<f64, D>, noise: &Noise) -> f64 {
        let [pp, ..] = self.covariance;
        (measured - self.position).norm() / (pp + noise.sigma.powi(2)).sqrt()
    }

    /// Takes a measurement in.
    pub(super) fn correct(&mut self, measured: &SVector<f64, D>, noise: &Noise) {
        let [pp, pv, vv] = self.covariance;
        let innovation = measured - self.position;
        let variance = pp + noise.sigma.powi(2);
        let gain = vector![pp / variance, pv / variance];
        self.position += innovation * gain[0];
        self.velocity = (self.velocity + innovation * gain[1]).cap_magnitude(noise.max_speed);
        self.covariance = [pp * (1.0 - gain[0]), pv * (1.0 - gain[0]), vv - gain[1] * pv];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const NOISE: Noise = Noise { density: 0.1, sigma: 0.03, max_speed: 3.0 };

    /// The matrix form of the same filter, term by term.
    #[test]
    fn agrees_with_the_matrix_form() {
        use nalgebra::{Matrix2, Vector2};
        let dt = 0.05_f64;
        let f = Matrix2::new(1.0, dt, 0.0, 1.0);
        let q = Matrix2::new(dt.powi(3) / 3.0, dt * dt / 2.0, dt * dt / 2.0, dt) * NOISE.density;
        let h = Vector2::new(1.0, 0.0);
        let mut filter = ConstantVelocity::starting_at(vector![0.4], &NOISE);
        let mut x = Vector2::new(0.4, 0.0);
        let mut p = Matrix2::new(NOISE.sigma.powi(2), 0.0, 0.0, 1.0);
        for k in 0..50 {
            let z = 0.4 + 0.02 * f64::from(k) + 0.03 * f64::from(k * 7 % 5 - 2);
            filter = filter.advanced(dt, &NOISE);
            filter.correct(&vector![z], &NOISE);
            x = f * x;
            p = f * p * f.transpose() + q;
            let gain = p * h / (h.dot(&(p * h)) + NOISE.sigma.powi(2));
            x += gain * (z - h.dot(&x));
            p = (Matrix2::identity() - gain * h.transpose()) * p;
            assert!((filter.position[0] - x[0]).abs() < 1e-12);
            assert!((filter.velocity[0] - x[1]).abs() < 1e-12);
            assert!((filter.covariance[0] - p[(0, 0)]).abs() < 1e-12);
            assert!((filter.covariance[2] - p[(1, 1)]).abs() < 1e-12);
        }
    }

    #[test]
    fn follows_a_ramp_without_lag() {
        let mut filter = ConstantVelocity::starting_at(vector![1.0, 2.0], &NOISE);
        let velocity = vector![0.8, -0.3];
        for k in 1..=200 {
            filter = filter.advanced(0.05, &NOISE);
            let truth = vector![1.0, 2.0] + velocity * 0.05 * f64::from(k);
            filter.correct(&truth, &NOISE);
        }
        assert!((filter.velocity - velocity).norm() < 1e-6);
    }
}
