//! Boxes that are turned in the axes of the workspace.

use nalgebra::{Isometry3, Vector3};

use super::bounds::Bounds;
use super::half_space::HalfSpace;
use crate::error::{Error, check_pose};

/// A box in its own axes.
///
/// ```
/// use hrsw::{Bounds, OrientedBox};
/// use nalgebra::{Isometry3, Vector3};
///
/// let turned = Isometry3::rotation(Vector3::z() * std::f64::consts::FRAC_PI_4);
/// let shape = OrientedBox::new(turned, Bounds::symmetric(Vector3::repeat(1.0))?)?;
/// assert!(shape.signed_distance(&Vector3::new(1.4, 0.0, 0.0)) < 0.0);
/// # Ok::<(), hrsw::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OrientedBox {
    pose: Isometry3<f64>,
    bounds: Bounds,
}

impl OrientedBox {
    /// Creates the box `bounds` in the axes of `pose`, which is in the axes of the workspace.
    ///
    /// # Errors
    /// [`Error::Value`] if the pose is invalid.
    pub fn new(pose: Isometry3<f64>, bounds: Bounds) -> Result<Self, Error> {
        check_pose(&pose)?;
        Ok(Self { pose, bounds })
    }

    /// The axes of the box and its origin \[m\].
    pub fn pose(&self) -> &Isometry3<f64> {
        &self.pose
    }

    /// Bounds in the axes of the box \[m\].
    pub fn bounds(&self) -> &Bounds {
        &self.bounds
    }

    /// Returns the nearest point of the box \[m\].
    pub fn nearest(&self, point: &Vector3<f64>) -> Vector3<f64> {
        let inner = self.inner(point);
        // A point inside is its own nearest point, to the last bit.
        if self.bounds.contains(&inner) {
            return *point;
        }
        self.pose.rotation * self.bounds.nearest(&inner) + self.pose.translation.vector
    }

    /// Returns the Euclidean distance \[m\]. Inside it is minus the distance to the nearest face.
    pub fn signed_distance(&self, point: &Vector3<f64>) -> f64 {
        self.bounds.signed_distance(&self.inner(point))
    }

    pub(crate) fn face(&self, index: usize) -> HalfSpace {
        let face = self.bounds.face(index);
        let normal = self.pose.rotation * face.normal;
        HalfSpace { normal, offset: face.offset + normal.dot(&self.pose.translation.vector) }
    }

    pub(crate) fn support(&self, direction: &Vector3<f64>) -> f64 {
        self.bounds.support(&(self.pose.rotation.inverse() * direction))
            + direction.dot(&self.pose.translation.vector)
    }

    fn inner(&self, point: &Vector3<f64>) -> Vector3<f64> {
        self.pose.rotation.inverse() * (point - self.pose.translation.vector)
    }
}
