//! Capsules and spheres: the points near a segment.

#[cfg(feature = "serde")]
mod capsule_table;

use nalgebra::{Isometry3, Point3, Vector3};

use super::half_space::HalfSpace;
use crate::error::{Error, check_all, not_negative};
#[cfg(feature = "serde")]
use capsule_table::CapsuleTable;

/// The points within `radius` of a segment; with equal ends a sphere.
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
    /// The radius of the sphere around it.
    reach: f64,
}

impl Capsule {
    /// Around the segment from `start` to `end` \[m\].
    ///
    /// # Errors
    /// [`Error::Value`] for what is not finite, and for a negative radius.
    pub fn new(start: Vector3<f64>, end: Vector3<f64>, radius: f64) -> Result<Self, Error> {
        check_all("the segment of a capsule", start.iter().chain(end.iter()))?;
        let radius = not_negative("the radius of a capsule", radius)?;
        Ok(Self { start, end, radius, reach: 0.5 * (end - start).norm() + radius })
    }

    /// The sphere around `center` \[m\].
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn sphere(center: Vector3<f64>, radius: f64) -> Result<Self, Error> {
        Self::new(center, center, radius)
    }

    /// Where the segment begins.
    pub fn start(&self) -> &Vector3<f64> {
        &self.start
    }

    /// Where the segment ends.
    pub fn end(&self) -> &Vector3<f64> {
        &self.end
    }

    /// The radius \[m\].
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// The same capsule, given in the axes of `pose`, in those in which `pose` is given.
    #[must_use]
    pub fn placed(&self, pose: &Isometry3<f64>) -> Self {
        let place = |point: &Vector3<f64>| (pose * Point3::from(*point)).coords;
        Self { start: place(&self.start), end: place(&self.end), ..*self }
    }

    /// The middle of the segment \[m\].
    pub fn middle(&self) -> Vector3<f64> {
        (self.start + self.end) * 0.5
    }

    /// Both ends of the segment \[m\].
    pub fn ends(&self) -> [Vector3<f64>; 2] {
        [self.start, self.end]
    }

    /// The sphere of the same radius at a point of the segment \[m\].
    #[must_use]
    pub fn at(&self, point: Vector3<f64>) -> Self {
        Self { start: point, end: point, reach: self.radius, ..*self }
    }

    /// The same capsule, moved by a vector \[m\].
    #[must_use]
    pub fn moved(&self, by: &Vector3<f64>) -> Self {
        Self { start: self.start + by, end: self.end + by, ..*self }
    }

    /// The nearest point of the segment.
    pub fn nearest_on_segment(&self, point: &Vector3<f64>) -> Vector3<f64> {
        let along = self.end - self.start;
        let length_squared = along.norm_squared();
        if length_squared == 0.0 {
            return self.start;
        }
        let share = (point - self.start).dot(&along) / length_squared;
        self.start + along * share.clamp(0.0, 1.0)
    }

    /// The nearest point of the capsule; a point within is its own.
    pub fn nearest(&self, point: &Vector3<f64>) -> Vector3<f64> {
        let axis = self.nearest_on_segment(point);
        let away = point - axis;
        let distance = away.norm();
        if distance <= self.radius { *point } else { axis + away * (self.radius / distance) }
    }

    /// The distance to the surface \[m\]; negative within.
    pub fn signed_distance(&self, point: &Vector3<f64>) -> f64 {
        (point - self.nearest_on_segment(point)).norm() - self.radius
    }

    /// The radius of the sphere around it, about its middle \[m\].
    pub fn reach(&self) -> f64 {
        self.reach
    }

    /// The half-space that touches the capsule where it is nearest to `point`.
    pub(crate) fn supporting(&self, point: &Vector3<f64>) -> HalfSpace {
        let axis = self.nearest_on_segment(point);
        let away = point - axis;
        let distance = away.norm();
        // On the segment every direction across it is as good.
        let normal = if distance > 1e-12 { away / distance } else { self.across() };
        HalfSpace { normal, offset: self.support(&normal) }
    }

    pub(crate) fn support(&self, direction: &Vector3<f64>) -> f64 {
        direction.dot(&self.start).max(direction.dot(&self.end)) + self.radius * direction.norm()
    }

    /// A direction across the segment, of length 1.
    pub fn across(&self) -> Vector3<f64> {
        let along = self.end - self.start;
        let other = if along.x.abs() > along.y.abs() { Vector3::y() } else { Vector3::x() };
        along.cross(&other).try_normalize(0.0).unwrap_or_else(Vector3::x)
    }
}
