//! The Kalman filter of a point that moves with nearly constant velocity.

use nalgebra::{SMatrix, SVector};

/// A Kalman filter over D axes: state (position, velocity), transition x ← x + v Δt, white
/// acceleration of the same spectral density on each axis, and measured positions, each with its
/// own covariance.
#[derive(Clone, Copy, Debug)]
pub(super) struct ConstantVelocity<const D: usize> {
    pub(super) position: SVector<f64, D>,
    pub(super) velocity: SVector<f64, D>,
    covariance: Covariance<D>,
}

/// The blocks of the state's covariance.
#[derive(Clone, Copy, Debug)]
struct Covariance<const D: usize> {
    position: SMatrix<f64, D, D>,
    /// Of position (rows) with velocity (columns).
    cross: SMatrix<f64, D, D>,
    velocity: SMatrix<f64, D, D>,
}

/// A measured position.
#[derive(Clone, Copy, Debug)]
pub(super) struct Measurement<const D: usize> {
    pub(super) position: SVector<f64, D>,
    pub(super) covariance: SMatrix<f64, D, D>,
}

/// What the filter believes about the motion.
#[derive(Clone, Copy, Debug)]
pub(super) struct Motion {
    /// Spectral density of the acceleration (unit²/s³).
    pub(super) density: f64,
    /// No faster than this (unit/s); a third of it is the standard deviation of the velocity at the
    /// start.
    pub(super) max_speed: f64,
}

impl<const D: usize> ConstantVelocity<D> {
    /// At rest where it was measured.
    pub(super) fn starting_at(measured: &Measurement<D>, motion: &Motion) -> Self {
        let velocity = SMatrix::identity() * (motion.max_speed / 3.0).powi(2);
        Self {
            position: measured.position,
            velocity: SVector::zeros(),
            covariance: Covariance {
                position: measured.covariance,
                cross: SMatrix::zeros(),
                velocity,
            },
        }
    }

    /// The state after `dt` ≥ 0 seconds without a measurement.
    pub(super) fn advanced(&self, dt: f64, motion: &Motion) -> Self {
        let Covariance { position, cross, velocity } = &self.covariance;
        let noise = |factor: f64| SMatrix::<f64, D, D>::identity() * (motion.density * factor);
        let both = cross + cross.transpose();
        Self {
            position: self.position + self.velocity * dt,
            velocity: self.velocity,
            covariance: Covariance {
                position: position + (both + velocity * dt) * dt + noise(dt.powi(3) / 3.0),
                cross: cross + velocity * dt + noise(dt.powi(2) / 2.0),
                velocity: velocity + noise(dt),
            },
        }
    }

    /// The square of how many standard deviations a measurement is away from what is expected
    /// (Mahalanobis' distance); infinite for one whose covariance is none.
    pub(super) fn distance_squared(&self, measured: &Measurement<D>) -> f64 {
        let innovation = measured.position - self.position;
        (self.covariance.position + measured.covariance)
            .cholesky()
            .map_or(f64::INFINITY, |factor| innovation.dot(&factor.solve(&innovation)))
    }

    /// Takes a measurement in; one whose covariance is none changes nothing.
    pub(super) fn correct(&mut self, measured: &Measurement<D>, motion: &Motion) {
        let Covariance { position, cross, velocity } = self.covariance;
        let Some(factor) = (position + measured.covariance).cholesky() else { return };
        let innovation = measured.position - self.position;
        // Gains are P S⁻¹, and P and S are symmetric.
        let of_position = factor.solve(&position).transpose();
        let of_velocity = factor.solve(&cross).transpose();
        self.position += of_position * innovation;
        self.velocity = (self.velocity + of_velocity * innovation).cap_magnitude(motion.max_speed);
        let symmetric = |matrix: SMatrix<f64, D, D>| (matrix + matrix.transpose()) * 0.5;
        self.covariance = Covariance {
            position: symmetric(position - of_position * position),
            cross: cross - of_position * cross,
            velocity: symmetric(velocity - of_velocity * cross),
        };
    }

    /// The covariance of the position.
    pub(super) fn position_covariance(&self) -> &SMatrix<f64, D, D> {
        &self.covariance.position
    }

    /// The covariance of the velocity.
    pub(super) fn velocity_covariance(&self) -> &SMatrix<f64, D, D> {
        &self.covariance.velocity
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{Matrix2, Matrix2x4, Matrix4, Vector4, vector};

    use super::*;

    const MOTION: Motion = Motion { density: 0.1, max_speed: 3.0 };

    /// The filter of the whole state, with every matrix written out.
    #[test]
    fn agrees_with_the_matrix_form() {
        let dt = 0.05_f64;
        let mut f = Matrix4::identity();
        (f[(0, 2)], f[(1, 3)]) = (dt, dt);
        let mut q = Matrix4::zeros();
        for axis in 0..2 {
            q[(axis, axis)] = dt.powi(3) / 3.0;
            q[(axis, axis + 2)] = dt * dt / 2.0;
            q[(axis + 2, axis)] = dt * dt / 2.0;
            q[(axis + 2, axis + 2)] = dt;
        }
        let h = Matrix2x4::identity();
        let covariance = |k: i32| {
            let angle = f64::from(k);
            let axes = Matrix2::new(angle.cos(), -angle.sin(), angle.sin(), angle.cos());
            axes * Matrix2::new(0.04_f64.powi(2), 0.0, 0.0, 0.01_f64.powi(2)) * axes.transpose()
        };
        let start = Measurement { position: vector![0.4, -0.1], covariance: covariance(7) };
        let mut filter = ConstantVelocity::starting_at(&start, &MOTION);
        let mut x = Vector4::new(0.4, -0.1, 0.0, 0.0);
        let mut p = Matrix4::identity();
        p.fixed_view_mut::<2, 2>(0, 0).copy_from(&start.covariance);
        for k in 0..50 {
            let z = vector![0.4 + 0.02 * f64::from(k), 0.03 * f64::from(k * 7 % 5 - 2)];
            let r = covariance(k);
            filter = filter.advanced(dt, &MOTION);
            let measured = Measurement { position: z, covariance: r };
            let distance = filter.distance_squared(&measured);
            filter.correct(&measured, &MOTION);
            x = f * x;
            p = f * p * f.transpose() + q * MOTION.density;
            let innovation = z - h * x;
            let s = (h * p * h.transpose() + r).try_inverse().unwrap_or_default();
            assert!((distance - innovation.dot(&(s * innovation))).abs() < 1e-9 * distance);
            let gain = p * h.transpose() * s;
            x += gain * innovation;
            p = (Matrix4::identity() - gain * h) * p;
            assert!((filter.position - x.fixed_rows::<2>(0)).norm() < 1e-12);
            assert!((filter.velocity - x.fixed_rows::<2>(2)).norm() < 1e-12);
            let position = filter.position_covariance() - p.fixed_view::<2, 2>(0, 0);
            let velocity = filter.velocity_covariance() - p.fixed_view::<2, 2>(2, 2);
            assert!(position.norm() < 1e-12 && velocity.norm() < 1e-12);
        }
    }

    #[test]
    fn follows_a_ramp_without_lag() {
        let covariance = Matrix2::identity() * 0.03_f64.powi(2);
        let at = |position| Measurement { position, covariance };
        let mut filter = ConstantVelocity::starting_at(&at(vector![1.0, 2.0]), &MOTION);
        let velocity = vector![0.8, -0.3];
        for k in 1..=200 {
            filter = filter.advanced(0.05, &MOTION);
            let truth = vector![1.0, 2.0] + velocity * 0.05 * f64::from(k);
            filter.correct(&at(truth), &MOTION);
        }
        assert!((filter.velocity - velocity).norm() < 1e-6);
    }
}
