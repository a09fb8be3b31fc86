//! Noise of a place on the floor, estimated from frame to frame.

use std::ops::RangeInclusive;

use nalgebra::{Matrix2, Vector2};

use super::settings::correlation;

/// Time over which squares are averaged (s).
const AVERAGED: f64 = 3.0;
/// Intervals between frames whose second differences show the noise that does not last (s), and all
/// of the noise. Longer ones show motion.
const SHORT: RangeInclusive<f64> = 1e-3..=0.15;
const LONG: RangeInclusive<f64> = 0.18..=0.3;
/// Smallest time between frames that are remembered (s), and their number.
const APART: f64 = 0.025;
const REMEMBERED: usize = 16;
/// Largest error that counts, in standard deviations. A jump is no noise.
const MOST: f64 = 3.0;
/// Largest share of the variance that lasts.
const MOST_LASTING: f64 = 0.95;
/// Least difference of the losses that tells the share.
const LEAST_LOSS: f64 = 0.1;

/// Estimates the covariance of the errors of a place, and the share of it that lasts, from second
/// differences.
///
/// A steady walk does not change second differences, and accelerations of people hardly do.
#[derive(Clone, Copy, Debug)]
pub(super) struct FrameNoise {
    /// Earlier times (s) and places (m), the latest first.
    before: [Option<(f64, Vector2<f64>)>; REMEMBERED],
    short: Differences,
    long: Differences,
    /// Smallest variance in each direction (m²).
    least: f64,
}

/// Mean of the products of second differences, divided by those of independent errors of variance 1.
#[derive(Clone, Copy, Debug)]
struct Differences {
    covariance: Matrix2<f64>,
    /// Mean loss of the square of a difference for each share of the variance that lasts.
    loss: f64,
}

impl FrameNoise {
    /// Creates an estimate with this standard deviation on each axis (m). It never states less.
    pub(super) fn at_least(sigma: f64) -> Self {
        let least = sigma.powi(2);
        // The losses are those of 20 frames a second at first.
        let of = |interval| Differences {
            covariance: Matrix2::identity() * least,
            loss: (4.0 * correlation(interval) - correlation(2.0 * interval)) / 3.0,
        };
        Self { before: [None; REMEMBERED], short: of(0.05), long: of(0.2), least }
    }

    /// Updates the estimate with the place that a frame shows (m). Times (s) must increase.
    pub(super) fn update(&mut self, time: f64, place: Vector2<f64>) {
        let (short, long) = (self.triple((time, place), SHORT), self.triple((time, place), LONG));
        if let (Some(short), Some(long)) = (short, long) {
            let weight = 1.0 - (-(time - short[1].0) / AVERAGED).exp();
            self.short.update(short, weight, self.least);
            self.long.update(long, weight, self.least);
        }
        if self.before[0].is_none_or(|(newest, _)| time - newest >= APART) {
            self.before.rotate_right(1);
            self.before[0] = Some((time, place));
        }
    }

    /// Returns a frame and the latest two whose times are apart by these intervals.
    fn triple(
        &self,
        newest: (f64, Vector2<f64>),
        intervals: RangeInclusive<f64>,
    ) -> Option<[(f64, Vector2<f64>); 3]> {
        let before = |(time, _): (f64, Vector2<f64>)| {
            let mut frames = self.before.iter().flatten();
            frames.find(|(before, _)| intervals.contains(&(time - before))).copied()
        };
        let middle = before(newest)?;
        Some([newest, middle, before(middle)?])
    }

    /// Returns the covariance (m²).
    pub(super) fn covariance(&self) -> Matrix2<f64> {
        let unlost = 1.0 - self.lasting() * self.long.loss;
        let mut axes = (self.long.covariance / unlost).symmetric_eigen();
        axes.eigenvalues.apply(|variance| *variance = variance.max(self.least));
        axes.recompose()
    }

    /// Returns the share of the variance that lasts from frame to frame. It is smaller where less
    /// noise is seen than is stated.
    ///
    /// Squared differences are 1 - s times their loss as large as those of independent errors, for
    /// the share s.
    pub(super) fn lasting(&self) -> f64 {
        let ratio = self.short.covariance.trace() / self.long.covariance.trace();
        let share = (1.0 - ratio) / (self.short.loss - ratio * self.long.loss).max(LEAST_LOSS);
        let seen = (0.5 * self.long.covariance.trace() / self.least).min(1.0);
        share.clamp(0.0, MOST_LASTING) * seen
    }
}

impl Differences {
    /// Updates the means by a weight with the second difference of three frames, the latest first. Errors have
    /// the variance `least` on each axis at least (m²).
    fn update(&mut self, frames: [(f64, Vector2<f64>); 3], weight: f64, least: f64) {
        let [(time, place), (t1, x1), (t0, x0)] = frames;
        let (after, before) = (time - t1, t1 - t0);
        let ratio = after / before;
        let squares = 1.0 + (1.0 + ratio).powi(2) + ratio.powi(2);
        let error = (place - x1 - (x1 - x0) * ratio) / squares.sqrt();
        let most = MOST * self.covariance.trace().max(2.0 * least).sqrt();
        let error = error.cap_magnitude(most);
        self.covariance += (error * error.transpose() - self.covariance) * weight;
        let loss = 2.0 * (1.0 + ratio) * (correlation(after) + ratio * correlation(before))
            - 2.0 * ratio * correlation(after + before);
        self.loss += (loss / squares - self.loss) * weight;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::vector;
    use rand_chacha::ChaCha8Rng;
    use rand_chacha::rand_core::{RngCore, SeedableRng};

    const INTERVAL: f64 = 0.05;

    /// Noise after a minute of frames of a person at `place(time)`. Errors have these standard deviations along x and
    /// y, and this share of their variance lasts.
    fn noise(
        place: impl Fn(f64) -> Vector2<f64>,
        sigma: Vector2<f64>,
        lasting: f64,
        interval: f64,
    ) -> FrameNoise {
        let mut draw = ChaCha8Rng::seed_from_u64(5);
        // The sum of twelve uniform numbers is approximately normal, with variance 1.
        let mut normal = || -> Vector2<f64> {
            (0..12)
                .map(|_| Vector2::from_fn(|_, _| f64::from(draw.next_u32()) / 4294967296.0 - 0.5))
                .sum()
        };
        let fades = (-interval / 0.16_f64).exp();
        let mut slow = normal();
        let mut noise = FrameNoise::at_least(0.02);
        for frame in 0..1200_u32 {
            slow = slow * fades + normal() * (1.0 - fades * fades).sqrt();
            let error = slow * lasting.sqrt() + normal() * (1.0 - lasting).sqrt();
            let time = f64::from(frame) * interval;
            noise.update(time, place(time) + error.component_mul(&sigma));
        }
        noise
    }

    fn stands(_: f64) -> Vector2<f64> {
        Vector2::zeros()
    }

    #[test]
    fn noise_of_walker_is_found_in_each_direction() {
        let walks = |time: f64| vector![1.3 * time, -0.4 * time];
        for lasting in [0.0, 0.9] {
            let covariance = noise(walks, vector![0.1, 0.0], lasting, INTERVAL).covariance();
            let [along, across] = [covariance.m11.sqrt(), covariance.m22.sqrt()];
            assert!((0.07..0.14).contains(&along), "{along} m, {lasting} lasts");
            assert!((across - 0.02).abs() < 1e-9, "{across} m");
        }
    }

    #[test]
    fn lasting_share_is_found_at_any_frame_rate() {
        for rate in [15.0, 20.0, 30.0, 60.0] {
            let of = |lasting| noise(stands, vector![0.05, 0.05], lasting, 1.0 / rate).lasting();
            let (white, real) = (of(0.0), of(0.9));
            assert!(white < 0.4, "{white} at {rate} Hz");
            assert!(real > 0.7, "{real} at {rate} Hz");
        }
    }

    #[test]
    fn motion_and_pauses_are_no_noise() {
        let speeds_up = |time: f64| vector![0.4 * time * time, 0.0];
        let sigma = |noise: FrameNoise| noise.covariance().m11.sqrt();
        let moving = noise(speeds_up, Vector2::zeros(), 0.0, INTERVAL);
        assert!(moving.lasting() < 0.4, "{} lasts at 0.8 m/s²", moving.lasting());
        let moving = sigma(moving);
        assert!((moving - 0.02).abs() < 1e-9, "{moving} m at 0.8 m/s²");
        // Frames twice a second show steps, which are no noise.
        let slow = sigma(noise(speeds_up, vector![0.2, 0.2], 0.0, 0.5));
        assert!((slow - 0.02).abs() < 1e-9, "{slow} m");
    }

    #[test]
    fn frames_at_nearly_one_time_change_nothing() {
        let times =
            [0.0, 1e-310, 1e-6].into_iter().chain((1..40).map(|frame| 0.05 * f64::from(frame)));
        let (mut noise, mut regular) = (FrameNoise::at_least(0.02), FrameNoise::at_least(0.02));
        for (frame, time) in times.enumerate() {
            let place = vector![if frame * frame % 7 < 2 { 0.3 } else { 0.2 }, 1.0];
            noise.update(time, place);
            if frame == 0 || time >= 0.05 {
                regular.update(time, place);
            }
            assert_eq!(noise.covariance(), regular.covariance(), "at {time} s");
            assert_eq!(noise.lasting(), regular.lasting(), "at {time} s");
        }
        assert!(noise.covariance().m11 > 4.1e-4, "{}", noise.covariance());
    }

    #[test]
    fn one_jump_counts_little() {
        let mut noise = FrameNoise::at_least(0.02);
        for frame in 0..40_u32 {
            let x = if frame < 20 { 0.0 } else { 2.0 };
            noise.update(f64::from(frame) * INTERVAL, vector![x, 0.0]);
        }
        assert!(noise.covariance().m11.sqrt() < 0.05, "{}", noise.covariance());
    }
}
