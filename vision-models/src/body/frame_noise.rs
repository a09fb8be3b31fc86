//! Noise of a place on the floor, estimated from frame to frame.

use std::ops::RangeInclusive;

use nalgebra::{Matrix2, Vector2};

/// Number of frames over which the covariance is averaged.
const FRAMES: f64 = 40.0;
/// Intervals between frames whose second difference is noise (s). Longer ones show motion.
const INTERVALS: RangeInclusive<f64> = 1e-3..=0.15;
/// Largest error that counts, in standard deviations. A jump is no noise.
const MOST: f64 = 3.0;

/// Estimates the covariance of the independent errors of a place from its second differences.
///
/// A steady walk does not change second differences, and accelerations of people hardly do.
#[derive(Clone, Copy, Debug)]
pub(super) struct FrameNoise {
    /// The last two times (s) and places (m), the latest first.
    before: [Option<(f64, Vector2<f64>)>; 2],
    covariance: Matrix2<f64>,
    /// Smallest variance in each direction (m²).
    least: f64,
}

impl FrameNoise {
    /// Creates an estimate with this standard deviation on each axis (m). It never states less.
    pub(super) fn at_least(sigma: f64) -> Self {
        let least = sigma.powi(2);
        Self { before: [None; 2], covariance: Matrix2::identity() * least, least }
    }

    /// Updates the estimate with the place that a frame shows (m). Times (s) must increase.
    pub(super) fn update(&mut self, time: f64, place: Vector2<f64>) {
        if let [Some((t1, x1)), Some((t0, x0))] = self.before
            && INTERVALS.contains(&(time - t1))
            && INTERVALS.contains(&(t1 - t0))
        {
            let ratio = (time - t1) / (t1 - t0);
            let scale = (1.0 + (1.0 + ratio).powi(2) + ratio.powi(2)).sqrt();
            let error = (place - x1 - (x1 - x0) * ratio) / scale;
            let error = error.cap_magnitude(MOST * self.covariance.trace().sqrt());
            self.covariance += (error * error.transpose() - self.covariance) / FRAMES;
        }
        self.before = [Some((time, place)), self.before[0]];
    }

    /// Returns the covariance (m²).
    pub(super) fn covariance(&self) -> Matrix2<f64> {
        let mut axes = self.covariance.symmetric_eigen();
        axes.eigenvalues.apply(|variance| *variance = variance.max(self.least));
        axes.recompose()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::vector;

    /// Standard deviations along x and y after frames of a person at `place(time)` with alternating errors.
    fn sigmas(place: impl Fn(f64) -> Vector2<f64>, error: Vector2<f64>, interval: f64) -> [f64; 2] {
        let mut noise = FrameNoise::at_least(0.02);
        // Every pattern of three signs occurs once in eight frames (de Bruijn).
        let signs = [1.0, 1.0, 1.0, -1.0, 1.0, -1.0, -1.0, -1.0];
        for (frame, sign) in (0..200_u32).zip(signs.into_iter().cycle()) {
            let time = f64::from(frame) * interval;
            noise.update(time, place(time) + error * sign);
        }
        let covariance = noise.covariance();
        [covariance.m11.sqrt(), covariance.m22.sqrt()]
    }

    #[test]
    fn noise_of_walker_is_found_in_each_direction() {
        let walks = |time: f64| vector![1.3 * time, -0.4 * time];
        let [along, across] = sigmas(walks, vector![0.06, 0.0], 0.05);
        assert!((0.05..0.07).contains(&along), "{along} m");
        assert!((across - 0.02).abs() < 1e-9, "{across} m");
    }

    #[test]
    fn motion_and_pauses_are_no_noise() {
        let speeds_up = |time: f64| vector![1.5 * time * time, 0.0];
        let none = Vector2::zeros();
        assert_eq!(sigmas(speeds_up, none, 0.05).map(|sigma| (sigma * 1e6).round()), [2e4; 2]);
        // Frames twice a second show steps, which are no noise.
        assert_eq!(sigmas(speeds_up, vector![0.2, 0.0], 0.5), [0.02; 2]);
    }

    #[test]
    fn frames_at_nearly_one_time_change_nothing() {
        let mut noise = FrameNoise::at_least(0.02);
        for time in [0.0, 1e-310, 1e-6, 0.05, 0.1, 0.15] {
            noise.update(time, vector![0.3, 1.0]);
            assert_eq!(noise.covariance(), Matrix2::identity() * 0.0004, "at {time} s");
        }
    }

    #[test]
    fn one_jump_counts_little() {
        let mut noise = FrameNoise::at_least(0.02);
        for frame in 0..40_u32 {
            let x = if frame < 20 { 0.0 } else { 2.0 };
            noise.update(f64::from(frame) * 0.05, vector![x, 0.0]);
        }
        assert!(noise.covariance().m11.sqrt() < 0.04, "{}", noise.covariance());
    }
}
