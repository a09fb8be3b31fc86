//! Paths of a frame's origin.

use std::str::FromStr;

use anyhow::{bail, ensure};
use nalgebra::Vector3;

/// The shape of a path.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Shape {
    /// A circle of this radius \[m\] in the plane of y and z, below the start.
    Circle(f64),
    /// A line along y of this length \[m\], to and fro.
    Line(f64),
    /// Points in the world \[m\] with their times \[s\], joined by straight lines.
    Points(Vec<(f64, Vector3<f64>)>),
}

/// A path with its timing.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Path {
    /// The shape.
    pub(crate) shape: Shape,
    /// Time for a round at full speed \[s\]; points have their own times.
    pub(crate) duration: f64,
    /// Number of rounds.
    pub(crate) rounds: f64,
}

/// Time in which circles and lines reach full speed, and stop \[s\].
const RAMP: f64 = 1.0;
/// Time that is recorded after the end of the path \[s\].
const REST: f64 = 1.0;

impl Path {
    /// The duration, with the rest at the end \[s\].
    pub(crate) fn time(&self) -> f64 {
        match &self.shape {
            Shape::Circle(_) | Shape::Line(_) => self.duration * self.rounds + RAMP + REST,
            Shape::Points(points) => points.last().map_or(0.0, |(time, _)| *time) + REST,
        }
    }

    /// Place \[m\] and velocity \[m/s\] at a time \[s\], for a frame that began at `start`.
    pub(crate) fn at(&self, time: f64, start: &Vector3<f64>) -> (Vector3<f64>, Vector3<f64>) {
        match &self.shape {
            Shape::Circle(radius) => {
                let (angle, rate) = self.angle(time);
                let (sine, cosine) = angle.sin_cos();
                let place = start + *radius * Vector3::new(0.0, sine, cosine - 1.0);
                (place, rate * *radius * Vector3::new(0.0, cosine, -sine))
            }
            Shape::Line(length) => {
                let (angle, rate) = self.angle(time);
                let place = start + 0.5 * length * (1.0 - angle.cos()) * Vector3::y();
                (place, 0.5 * length * rate * angle.sin() * Vector3::y())
            }
            Shape::Points(points) => between(points, time),
        }
    }

    /// The angle and its rate, with minimum-jerk ramps of the rate at both ends.
    fn angle(&self, time: f64) -> (f64, f64) {
        let full = std::f64::consts::TAU / self.duration;
        let end = self.duration * self.rounds;
        let (up, down) = (ramp(time / RAMP), ramp((time - end) / RAMP));
        (full * RAMP * (up.0 - down.0), full * (up.1 - down.1))
    }
}

/// The integral of the minimum-jerk polynomial 10s³ − 15s⁴ + 6s⁵, and its value: 0 before, 1 behind.
fn ramp(s: f64) -> (f64, f64) {
    if s <= 0.0 {
        (0.0, 0.0)
    } else if s >= 1.0 {
        (s - 0.5, 1.0)
    } else {
        let cube = s * s * s;
        (cube * s * (2.5 - s * (3.0 - s)), cube * (10.0 - s * (15.0 - 6.0 * s)))
    }
}

fn between(points: &[(f64, Vector3<f64>)], time: f64) -> (Vector3<f64>, Vector3<f64>) {
    let next = points.iter().position(|(own, _)| *own > time);
    match (next, points) {
        (Some(0), [(_, first), ..]) => (*first, Vector3::zeros()),
        (Some(next), _) => {
            let ((begin, from), (end, to)) = (points[next - 1], points[next]);
            let velocity = (to - from) / (end - begin);
            (from + velocity * (time - begin), velocity)
        }
        (None, [.., (_, last)]) => (*last, Vector3::zeros()),
        _ => (Vector3::zeros(), Vector3::zeros()),
    }
}

/// Parses lines of time,x,y,z. Empty lines, and a first line that begins with a letter, are skipped.
impl FromStr for Shape {
    type Err = anyhow::Error;

    fn from_str(text: &str) -> anyhow::Result<Self> {
        let mut points: Vec<(f64, Vector3<f64>)> = Vec::new();
        for (line, found) in (1..).zip(text.lines()) {
            let found = found.trim();
            if found.is_empty() || (line == 1 && found.starts_with(|c: char| c.is_alphabetic())) {
                continue;
            }
            let numbers: Vec<f64> =
                found.split(',').filter_map(|part| part.trim().parse().ok()).collect();
            let (&[time, x, y, z], true) =
                (&numbers[..], numbers.iter().all(|number| number.abs() < 1e6))
            else {
                let found = beginning(found);
                bail!(
                    "line {line}: {found:?} is not time,x,y,z: seconds and metres, finite numbers"
                );
            };
            ensure!(
                points.last().is_none_or(|(last, _)| time > *last),
                "line {line}: the time {time} s is not later than the one before"
            );
            points.push((time, Vector3::new(x, y, z)));
        }
        ensure!(points.len() >= 2, "the path has {} points; two are needed", points.len());
        Ok(Self::Points(points))
    }
}

/// The part of a line that a message quotes.
fn beginning(line: &str) -> String {
    const LONGEST: usize = 120;
    match line.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{}…", &line[..end]),
        None => line.to_owned(),
    }
}
