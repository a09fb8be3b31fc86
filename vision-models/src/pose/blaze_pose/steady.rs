//! Smooths the circle around a person over time.
//!
//! The one-euro filter of G. Casiez, N. Roussel and D. Vogel, "1 € filter: a simple speed-based
//! low-pass filter for noisy input in interactive systems", CHI 2012, with MediaPipe's parameters.
//! A region rests while the person does, and follows a moving person without delay.

use std::f64::consts::TAU;

use nalgebra::{Point2, SVector};

/// Lowest cutoff (Hz), its growth with the speed (in diameters of the circle), and the cutoff of
/// the speed (Hz).
const CUTOFF: f64 = 0.01;
const BETA: f64 = 10.0;
const SPEED_CUTOFF: f64 = 1.0;

/// The points of a circle: its centre, and a point on it.
type Circle = [Point2<f64>; 2];

/// The filter of one circle.
#[derive(Clone, Debug, Default)]
pub(super) struct Steady {
    last: Option<Last>,
}

/// The last state of both points' coordinates.
#[derive(Clone, Debug)]
struct Last {
    time: f64,
    raw: SVector<f64, 4>,
    /// Speed in diameters per second.
    speed: SVector<f64, 4>,
    filtered: SVector<f64, 4>,
}

impl Steady {
    /// Returns the smoothed circle at a time (s). If the time is not later than the previous one,
    /// it returns the circle itself.
    pub(super) fn update(&mut self, time: f64, [centre, edge]: Circle) -> Circle {
        let raw = SVector::from([centre.x, centre.y, edge.x, edge.y]);
        let seen = |speed| Last { time, raw, speed, filtered: raw };
        let next = match &self.last {
            Some(last) if time > last.time => {
                let step = time - last.time;
                let weight = |cutoff: f64| 1.0 / (1.0 + 1.0 / (TAU * cutoff * step));
                let diameter = (2.0 * (edge - centre).norm()).max(1e-6);
                let measured = (raw - last.raw) / (diameter * step);
                let speed = last.speed.lerp(&measured, weight(SPEED_CUTOFF));
                let mix = |old: f64, new: f64, speed: f64| {
                    let share = weight(CUTOFF + BETA * speed.abs());
                    share * new + (1.0 - share) * old
                };
                let filtered = last.filtered.zip_zip_map(&raw, &speed, mix);
                Last { time, raw, speed, filtered }
            }
            _ => seen(SVector::zeros()),
        };
        let [x, y, u, v] = next.filtered.into();
        self.last = Some(next);
        [Point2::new(x, y), Point2::new(u, v)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn circle(x: f64) -> Circle {
        [Point2::new(x, 50.0), Point2::new(x, 0.0)]
    }

    #[test]
    fn standing_circles_are_smoothed_and_moving_ones_followed() {
        let mut steady = Steady::default();
        assert_eq!(steady.update(0.0, circle(10.0)), circle(10.0));
        // A jitter of one pixel.
        let [centre, _] = steady.update(0.04, circle(11.0));
        assert!((10.0..10.2).contains(&centre.x), "{centre}");
        // Moves by 50 pixels per second: one metre per second if the circle is two metres wide.
        for frame in 0_i32..50 {
            let (x, time) = (11.0 + 2.0 * f64::from(frame), 0.08 + 0.04 * f64::from(frame));
            let [centre, _] = steady.update(time, circle(x));
            assert!(frame < 20 || (centre.x - x).abs() < 6.0, "{centre} for {x}");
        }
        // If the time does not advance, the circle is not smoothed.
        assert_eq!(steady.update(0.0, circle(10.0)), circle(10.0));
    }
}
