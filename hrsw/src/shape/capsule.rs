//! Capsules and spheres: the points near a segment.

#[cfg(feature = "serde")]
mod capsule_table;

use nalgebra::{Isometry3, Point3, Vector3};

use super::half_space::HalfSpace;
use crate::error::{Error, check_all, not_negative};
#[cfg(feature = "serde")]
use capsule_table::CapsuleTable;

/// The points within `radius` of a segment. If the ends are equal, it is a sphere.
///
/// ```
/// use hrsw::Capsule;
/// use nalgebra::Vector3;
///
/// let forearm = Capsule::new(Vector3::zeros(), Vector3::new(0.0, 0.0, 0.25), 0.05)?;
/// assert!((forearm.signed_distance(&Vector3::new(0.15, 0.0, 0.1)) - 0.1).abs() < 1e-15);
/// # Ok::<(), hrsw::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize, schemars::JsonSchema))]
#[cfg_attr(feature = "serde", serde(try_from = "CapsuleTable", into = "CapsuleTable"))]
pub struct Capsule {
    start: Vector3<f64>,
    end: Vector3<f64>,
    radius: f64,
    /// Radius of the enclosing sphere.
    reach: f64,
}

impl Capsule {
    /// Creates a capsule around the segment from `start` to `end` \[m\].
    ///
    /// # Errors
    /// [`Error::Value`] if a number is not finite, or the radius is negative.
    pub fn new(start: Vector3<f64>, end: Vector3<f64>, radius: f64) -> Result<Self, Error> {
        check_all("the segment of a capsule", start.iter().chain(end.iter()))?;
        let radius = not_negative("the radius of a capsule", radius)?;
        Ok(Self { start, end, radius, reach: 0.5 * (end - start).norm() + radius })
    }

    /// Creates the sphere around `center` \[m\].
    ///
    /// # Errors
    /// Those of [`new`](Self::new).
    pub fn sphere(center: Vector3<f64>, radius: f64) -> Result<Self, Error> {
        Self::new(center, center, radius)
    }

    /// Start of the segment \[m\].
    pub fn start(&self) -> &Vector3<f64> {
        &self.start
    }

    /// End of the segment \[m\].
    pub fn end(&self) -> &Vector3<f64> {
        &self.end
    }

    /// The radius \[m\].
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// Returns the capsule in the outer axes of `pose`, if it is given in the inner ones.
    #[must_use]
    pub fn placed(&self, pose: &Isometry3<f64>) -> Self {
        let place = |point: &Vector3<f64>| (pose * Point3::from(*point)).coords;
        Self { start: place(&self.start), end: place(&self.end), ..*self }
    }

    /// Returns the midpoint of the segment \[m\].
    pub fn middle(&self) -> Vector3<f64> {
        (self.start + self.end) * 0.5
    }

    /// Returns both ends of the segment \[m\].
    pub fn ends(&self) -> [Vector3<f64>; 2] {
        [self.start, self.end]
    }

    /// Returns the sphere of the same radius at a point of the segment \[m\].
    #[must_use]
    pub fn at(&self, point: Vector3<f64>) -> Self {
        Self { start: point, end: point, reach: self.radius, ..*self }
    }

    /// Returns the capsule moved by a vector \[m\].
    #[must_use]
    pub fn moved(&self, by: &Vector3<f64>) -> Self {
        Self { start: self.start + by, end: self.end + by, ..*self }
    }

    /// Returns the nearest point of the segment \[m\].
    pub fn nearest_on_segment(&self, point: &Vector3<f64>) -> Vector3<f64> {
        let along = self.end - self.start;
        let length_squared = along.norm_squared();
        if length_squared == 0.0 {
            return self.start;
        }
        let share = (point - self.start).dot(&along) / length_squared;
        self.start + along * share.clamp(0.0, 1.0)
    }

    /// Returns the nearest point of the capsule \[m\]. A point inside is its own nearest point.
    pub fn nearest(&self, point: &Vector3<f64>) -> Vector3<f64> {
        let axis = self.nearest_on_segment(point);
        let away = point - axis;
        let distance = away.norm();
        if distance <= self.radius { *point } else { axis + away * (self.radius / distance) }
    }

    /// Returns the distance to the surface \[m\], negative inside.
    pub fn signed_distance(&self, point: &Vector3<f64>) -> f64 {
        (point - self.nearest_on_segment(point)).norm() - self.radius
    }

    /// Returns the radius of the enclosing sphere around the midpoint \[m\].
    pub fn reach(&self) -> f64 {
        self.reach
    }

    /// Returns the half-space that touches the capsule where it is nearest to `point`.
    pub(crate) fn supporting(&self, point: &Vector3<f64>) -> HalfSpace {
        let axis = self.nearest_on_segment(point);
        let away = point - axis;
        let distance = away.norm();
        // On the segment all directions across it are equivalent.
        let normal = if distance > 1e-12 { away / distance } else { self.across() };
        HalfSpace { normal, offset: self.support(&normal) }
    }

    pub(crate) fn support(&self, direction: &Vector3<f64>) -> f64 {
        direction.dot(&self.start).max(direction.dot(&self.end)) + self.radius * direction.norm()
    }

    /// Returns a unit vector across the segment.
    pub fn across(&self) -> Vector3<f64> {
        let along = self.end - self.start;
        let other = if along.x.abs() > along.y.abs() { Vector3::y() } else { Vector3::x() };
        along.cross(&other).try_normalize(0.0).unwrap_or_else(Vector3::x)
    }
}
