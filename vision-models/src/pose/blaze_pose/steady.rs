//! The circle around a person, steadied over time.
//!
//! The one-euro filter of G. Casiez, N. Roussel and D. Vogel, "1 € filter: a simple speed-based low-pass filter for noisy
//! input in interactive systems", CHI 2012, with MediaPipe's parameters: a region that stands still where the person
//! does, and follows at once where they move.

use std::f64::consts::TAU;

use nalgebra::{Point2, SVector};

/// The lowest cutoff (Hz), how it grows with the speed (in diameters of the circle), and the cutoff of the speed (Hz).
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

/// Both points' coordinates.
#[derive(Clone, Debug)]
struct Last {
    time: f64,
    raw: SVector<f64, 4>,
    /// Diameters a second.
    speed: SVector<f64, 4>,
    filtered: SVector<f64, 4>,
}

impl Steady {
    /// The steadied circle for the one that is seen at a time (s). Without a later time than before it stays as it is seen.
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
    fn what_stands_is_steadied_and_what_moves_is_followed() {
        let mut steady = Steady::default();
        assert_eq!(steady.update(0.0, circle(10.0)), circle(10.0));
        // A jitter of a pixel.
        let [centre, _] = steady.update(0.04, circle(11.0));
        assert!((10.0..10.2).contains(&centre.x), "{centre}");
        // A step of a metre each second, where the circle is about two wide.
        for frame in 0_i32..50 {
            let (x, time) = (11.0 + 2.0 * f64::from(frame), 0.08 + 0.04 * f64::from(frame));
            let [centre, _] = steady.update(time, circle(x));
            assert!(frame < 20 || (centre.x - x).abs() < 6.0, "{centre} for {x}");
        }
        // Times that stand still: as it is seen.
        assert_eq!(steady.update(0.0, circle(10.0)), circle(10.0));
    }
}
