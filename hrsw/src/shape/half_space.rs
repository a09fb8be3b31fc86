//! Half-spaces: planes that bound and support the shapes.

use nalgebra::Vector3;

use crate::error::{Error, check_all};

/// The points z with normal · z ≤ offset \[m\]. The normal has length 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HalfSpace {
    pub(crate) normal: Vector3<f64>,
    pub(crate) offset: f64,
}

impl HalfSpace {
    /// Creates the set of points z with normal · z ≤ offset, for a normal of any nonzero length.
    ///
    /// # Errors
    /// [`Error::Value`] if a number is not finite, or the normal has length zero.
    pub fn new(normal: Vector3<f64>, offset: f64) -> Result<Self, Error> {
        check_all("a half-space", normal.iter().chain([&offset]))?;
        let length = normal.norm();
        if length < 1e-12 {
            let name = "the length of a half-space's normal";
            return Err(Error::Value { what: name, got: length, wanted: "above zero" });
        }
        Ok(Self { normal: normal / length, offset: offset / length })
    }

    /// Outer normal, of length 1.
    pub fn normal(&self) -> &Vector3<f64> {
        &self.normal
    }

    /// Distance of the plane from the origin, along the normal \[m\].
    pub fn offset(&self) -> f64 {
        self.offset
    }

    /// Returns the distance of `point` beyond the plane \[m\], negative inside.
    pub fn signed_distance(&self, point: &Vector3<f64>) -> f64 {
        self.normal.dot(point) - self.offset
    }
}
