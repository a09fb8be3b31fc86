use nalgebra::{Matrix3, Vector3};

use crate::error::{Result, within};

/// A person's frame H in the world: origin on the floor below the pelvis, x along the heading, z up.
/// Ergonomics are stated in it.
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
    /// The frame with its origin at `position` \[m\] (world, on the floor below the pelvis) and its
    /// x axis along `heading` \[rad\] about the world's z axis.
    ///
    /// # Errors
    /// [`crate::Error::Value`] for a coordinate or the heading.
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

    /// The rotation that takes directions of the person's frame to the world.
    pub fn rotation(&self) -> Matrix3<f64> {
        let (sin, cos) = self.heading.sin_cos();
        Matrix3::new(cos, -sin, 0.0, sin, cos, 0.0, 0.0, 0.0, 1.0)
    }

    /// A point of the person's frame, in the world.
    pub fn to_world(&self, point: &Vector3<f64>) -> Vector3<f64> {
        self.position + self.rotation() * point
    }

    /// A point of the world, in the person's frame.
    pub fn to_person(&self, point: &Vector3<f64>) -> Vector3<f64> {
        self.rotation().tr_mul(&(point - self.position))
    }
}
