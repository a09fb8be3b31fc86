use nalgebra::{Matrix3, Vector3};

use crate::error::{Result, within};

/// A person's frame H in the world, in which ergonomics are expressed. The origin is on the floor
/// below the pelvis. x points along the heading, and z up.
///
/// ```
/// use ergo_map::PersonFrame;
/// use nalgebra::Vector3;
/// let person = PersonFrame::new(Vector3::new(1.0, 2.0, 0.0), core::f64::consts::FRAC_PI_2)?;
/// let hand = person.to_world(&Vector3::new(0.4, 0.0, 1.1));
/// assert!((hand - Vector3::new(1.0, 2.4, 1.1)).norm() < 1e-12);
/// # Ok::<(), ergo_map::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PersonFrame {
    position: Vector3<f64>,
    heading: f64,
}

impl PersonFrame {
    /// Creates the frame with its origin at `position` \[m\] and its x axis along `heading`
    /// \[rad\]. The position is in the world, on the floor below the pelvis. The heading is about
    /// the world's z axis.
    ///
    /// # Errors
    /// [`crate::Error::Value`] if a coordinate or the heading is invalid.
    pub fn new(position: Vector3<f64>, heading: f64) -> Result<Self> {
        for (name, value) in ["person x", "person y", "person z"].into_iter().zip(position.iter()) {
            within(name, *value, [-1e7, 1e7], "m")?;
        }
        Ok(Self { position, heading: within("person heading", heading, [-1e6, 1e6], "rad")? })
    }

    /// Origin of the person's frame in the world \[m\].
    pub fn position(&self) -> &Vector3<f64> {
        &self.position
    }

    /// Heading \[rad\].
    pub fn heading(&self) -> f64 {
        self.heading
    }

    /// Returns the rotation that transforms directions of the person's frame to the world.
    pub fn rotation(&self) -> Matrix3<f64> {
        let (sin, cos) = self.heading.sin_cos();
        Matrix3::new(cos, -sin, 0.0, sin, cos, 0.0, 0.0, 0.0, 1.0)
    }

    /// Transforms a point of the person's frame to the world.
    pub fn to_world(&self, point: &Vector3<f64>) -> Vector3<f64> {
        self.position + self.rotation() * point
    }

    /// Transforms a point of the world to the person's frame.
    pub fn to_person(&self, point: &Vector3<f64>) -> Vector3<f64> {
        self.rotation().tr_mul(&(point - self.position))
    }
}
