//! Bounds along three axes: a box.

use nalgebra::Vector3;

use super::half_space::HalfSpace;
use crate::error::{Error, check_all};

/// Bounds along three axes, `min ≤ v ≤ max`, of a position \[m\] or a rotation vector \[rad\].
///
/// ```
/// use hrsw::Bounds;
/// use nalgebra::Vector3;
///
/// let bounds = Bounds::new(Vector3::new(0.2, -0.5, 0.7), Vector3::new(0.75, 0.2, 1.6))?;
/// assert_eq!(bounds.nearest(&Vector3::new(0.0, 0.0, 1.0)), Vector3::new(0.2, 0.0, 1.0));
/// # Ok::<(), hrsw::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    min: Vector3<f64>,
    max: Vector3<f64>,
}

impl Bounds {
    /// Creates bounds from their lower and upper ends.
    ///
    /// # Errors
    /// [`Error::Value`] if a bound is NaN or infinite. [`Error::EmptyRange`] if a minimum is above
    /// its maximum.
    pub fn new(min: Vector3<f64>, max: Vector3<f64>) -> Result<Self, Error> {
        check_all("a bound", min.iter().chain(max.iter()))?;
        if let Some(axis) = (0..3).find(|&axis| min[axis] > max[axis]) {
            let (min, max) = (min[axis], max[axis]);
            return Err(Error::EmptyRange { what: "the bounds", axis, min, max });
        }
        Ok(Self { min, max })
    }

    /// Creates bounds at the distance `half` on both sides of zero.
    ///
    /// # Errors
    /// Those of [`new`](Self::new).
    pub fn symmetric(half: Vector3<f64>) -> Result<Self, Error> {
        Self::new(-half, half)
    }

    /// The lower bounds of the three coordinates \[m\], or of a rotation vector \[rad\].
    pub fn min(&self) -> &Vector3<f64> {
        &self.min
    }

    /// The upper bounds of the three coordinates \[m\], or of a rotation vector \[rad\].
    pub fn max(&self) -> &Vector3<f64> {
        &self.max
    }

    /// The midpoint of the bounds \[m or rad\].
    pub fn center(&self) -> Vector3<f64> {
        (self.min + self.max) * 0.5
    }

    /// Returns the point inside that is nearest to `v`.
    pub fn nearest(&self, v: &Vector3<f64>) -> Vector3<f64> {
        v.sup(&self.min).inf(&self.max)
    }

    /// Returns true if `v` is inside.
    pub fn contains(&self, v: &Vector3<f64>) -> bool {
        self.nearest(v) == *v
    }

    /// Returns the Euclidean distance of `v`. Inside it is minus the distance to the nearest face.
    pub fn signed_distance(&self, v: &Vector3<f64>) -> f64 {
        let outside = (v - self.nearest(v)).norm();
        if outside > 0.0 { outside } else { (self.min - v).sup(&(v - self.max)).max() }
    }

    /// Returns the bounds moved by `offset`.
    #[must_use]
    pub fn shifted(&self, offset: &Vector3<f64>) -> Self {
        Self { min: self.min + offset, max: self.max + offset }
    }

    /// Creates bounds from ends that are in order up to rounding.
    pub(crate) fn ordered(a: Vector3<f64>, b: Vector3<f64>) -> Self {
        Self { min: a.inf(&b), max: a.sup(&b) }
    }

    /// Returns (1 − share) · self + share · other, for a share in [0, 1].
    pub(crate) fn blended(&self, other: &Self, share: f64) -> Self {
        Self { min: self.min.lerp(&other.min, share), max: self.max.lerp(&other.max, share) }
    }

    /// Returns a face. Faces 0 to 2 bound from above, 3 to 5 from below.
    pub(crate) fn face(&self, index: usize) -> HalfSpace {
        let axis = index % 3;
        let mut normal = Vector3::zeros();
        if index < 3 {
            normal[axis] = 1.0;
            HalfSpace { normal, offset: self.max[axis] }
        } else {
            normal[axis] = -1.0;
            HalfSpace { normal, offset: -self.min[axis] }
        }
    }

    pub(crate) fn support(&self, direction: &Vector3<f64>) -> f64 {
        (0..3).map(|i| (direction[i] * self.min[i]).max(direction[i] * self.max[i])).sum()
    }
}
