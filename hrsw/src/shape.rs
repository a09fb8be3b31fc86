//! Shapes that bound a position.

mod bounds;
mod capsule;
mod cone;
mod half_space;
mod orientation;
mod oriented_box;
mod polytope;

use nalgebra::Vector3;

pub use bounds::Bounds;
pub use capsule::Capsule;
pub use cone::Cone;
pub use half_space::HalfSpace;
pub use orientation::OrientationShape;
pub(crate) use orientation::{OrientationRow, RotationPoint};
pub use oriented_box::OrientedBox;
pub use polytope::Polytope;

/// A convex set of positions, in the axes of the workspace \[m\].
///
/// ```
/// use hrsw::{Capsule, PositionShape};
/// use nalgebra::Vector3;
///
/// let shape = PositionShape::from(Capsule::sphere(Vector3::zeros(), 0.5)?);
/// let outside = Vector3::new(0.8, 0.0, 0.0);
/// assert!((shape.signed_distance(&outside) - 0.3).abs() < 1e-15);
/// assert!((shape.nearest(&outside) - Vector3::new(0.5, 0.0, 0.0)).norm() < 1e-15);
/// # Ok::<(), hrsw::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum PositionShape {
    /// A box along the axes.
    Box(Bounds),
    /// A box along its own axes.
    OrientedBox(OrientedBox),
    /// A convex polytope.
    Polytope(Polytope),
    /// A capsule or a sphere, bounded by the plane that supports it at its nearest point.
    Capsule(Capsule),
}

impl From<Bounds> for PositionShape {
    fn from(bounds: Bounds) -> Self {
        Self::Box(bounds)
    }
}

impl From<OrientedBox> for PositionShape {
    fn from(oriented: OrientedBox) -> Self {
        Self::OrientedBox(oriented)
    }
}

impl From<Polytope> for PositionShape {
    fn from(polytope: Polytope) -> Self {
        Self::Polytope(polytope)
    }
}

impl From<Capsule> for PositionShape {
    fn from(capsule: Capsule) -> Self {
        Self::Capsule(capsule)
    }
}

impl PositionShape {
    /// Number of rows that bound the shape.
    pub fn row_count(&self) -> usize {
        match self {
            Self::Box(_) | Self::OrientedBox(_) => 6,
            Self::Polytope(polytope) => polytope.faces().len(),
            Self::Capsule(_) => 1,
        }
    }

    /// Returns half-space `index` around the shape, as seen from `point`. None past the last row.
    ///
    /// A flat face is the same from everywhere. A round shape returns the plane that touches it at
    /// its nearest point.
    pub fn half_space(&self, index: usize, point: &Vector3<f64>) -> Option<HalfSpace> {
        if index >= self.row_count() {
            return None;
        }
        match self {
            Self::Box(bounds) => Some(bounds.face(index)),
            Self::OrientedBox(oriented) => Some(oriented.face(index)),
            Self::Polytope(polytope) => polytope.faces().get(index).copied(),
            Self::Capsule(capsule) => Some(capsule.supporting(point)),
        }
    }

    /// Returns the support function, the largest direction · z over the shape \[m\].
    pub fn support(&self, direction: &Vector3<f64>) -> f64 {
        match self {
            Self::Box(bounds) => bounds.support(direction),
            Self::OrientedBox(oriented) => oriented.support(direction),
            Self::Polytope(polytope) => polytope.support(direction),
            Self::Capsule(capsule) => capsule.support(direction),
        }
    }

    /// Returns true if the point is inside.
    pub fn contains(&self, point: &Vector3<f64>) -> bool {
        match self {
            Self::Box(bounds) => bounds.contains(point),
            _ => self.signed_distance(point) <= 0.0,
        }
    }

    /// Returns the Euclidean distance \[m\]. Inside it is minus the distance to the surface.
    pub fn signed_distance(&self, point: &Vector3<f64>) -> f64 {
        match self {
            Self::Box(bounds) => bounds.signed_distance(point),
            Self::OrientedBox(oriented) => oriented.signed_distance(point),
            Self::Polytope(polytope) => polytope.signed_distance(point),
            Self::Capsule(capsule) => capsule.signed_distance(point),
        }
    }

    /// Returns the nearest point of the shape. A point inside is its own nearest point.
    pub fn nearest(&self, point: &Vector3<f64>) -> Vector3<f64> {
        match self {
            Self::Box(bounds) => bounds.nearest(point),
            Self::OrientedBox(oriented) => oriented.nearest(point),
            Self::Polytope(polytope) => polytope.nearest(point),
            Self::Capsule(capsule) => capsule.nearest(point),
        }
    }

    /// Returns the smallest bounds around the shape.
    pub fn extent(&self) -> Bounds {
        let reach =
            |sign: f64| Vector3::from_fn(|axis, _| sign * self.support(&Vector3::ith(axis, sign)));
        match self {
            Self::Box(bounds) => *bounds,
            _ => Bounds::ordered(reach(-1.0), reach(1.0)),
        }
    }
}
