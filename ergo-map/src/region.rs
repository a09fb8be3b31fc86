use nalgebra::Vector3;

use crate::error::{Error, Result, finite};
use crate::side::Side;

/// A box of hand positions in the person's frame \[m\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Region {
    min: Vector3<f64>,
    max: Vector3<f64>,
}

impl Region {
    /// Creates the box between two corners.
    ///
    /// # Errors
    /// [`Error::Value`] if a corner is not finite, or with the name of an empty axis.
    pub fn new(min: Vector3<f64>, max: Vector3<f64>) -> Result<Self> {
        for (axis, (min, max)) in ['x', 'y', 'z'].into_iter().zip(min.iter().zip(max.iter())) {
            let (min, max) = (finite("region min", *min)?, finite("region max", *max)?);
            if min >= max {
                let wanted = format!("lie below region max, {max} m, on the axis {axis}");
                return Err(Error::Value { what: "region min", got: min, unit: "m", wanted });
            }
        }
        Ok(Self { min, max })
    }

    /// Returns the zone in which hands work: 0.20 to 0.75 m ahead of the pelvis, 0.5 m outward to
    /// 0.2 m across. This is for a person of 1.75 m, and proportional for others. The height is .40
    /// to .95 of stature above the floor.
    pub fn work_zone(stature: f64, side: Side) -> Self {
        let per_metre = stature / 1.75;
        let (out, across) = (0.5 * side.sign() * per_metre, -0.2 * side.sign() * per_metre);
        Self {
            min: Vector3::new(0.2 * per_metre, out.min(across), 0.40 * stature),
            max: Vector3::new(0.75 * per_metre, out.max(across), 0.95 * stature),
        }
    }

    /// Corner with the smallest coordinates.
    pub fn min(&self) -> &Vector3<f64> {
        &self.min
    }

    /// Corner with the largest coordinates.
    pub fn max(&self) -> &Vector3<f64> {
        &self.max
    }

    /// Returns the lengths of the edges.
    pub fn size(&self) -> Vector3<f64> {
        self.max - self.min
    }

    /// Returns true if the point is in the box or on its faces.
    pub fn contains(&self, point: &Vector3<f64>) -> bool {
        (0..3).all(|i| point[i] >= self.min[i] && point[i] <= self.max[i])
    }

    /// Returns the surroundings within reach of a standing person, in fractions of stature. They
    /// are from .25 behind to .60 ahead, .60 outward to .45 across, and .05 to 1.30 above the
    /// floor.
    pub fn surroundings(stature: f64, side: Side) -> Self {
        let (out, across) = (0.60 * side.sign(), -0.45 * side.sign());
        Self {
            min: Vector3::new(-0.25, out.min(across), 0.05) * stature,
            max: Vector3::new(0.60, out.max(across), 1.30) * stature,
        }
    }

    /// Returns the smallest box around points. It is all zero if there are none.
    pub(crate) fn around(points: impl Iterator<Item = Vector3<f64>>) -> Self {
        let bounds = points.map(|point| (point, point));
        let (min, max) = bounds.reduce(|a, b| (a.0.inf(&b.0), a.1.sup(&b.1))).unwrap_or_default();
        Self { min, max }
    }

    /// Returns the box with every face moved outward.
    pub(crate) fn grown(&self, by: f64) -> Self {
        Self { min: self.min.map(|x| x - by), max: self.max.map(|x| x + by) }
    }

    /// Returns the box in other units.
    pub(crate) fn scaled(&self, by: f64) -> Self {
        Self { min: self.min * by, max: self.max * by }
    }
}
