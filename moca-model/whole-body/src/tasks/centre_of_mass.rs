//! The task of moving the centre of mass to a point.

use nalgebra::{Matrix3xX, Point3, Vector3};

use super::feedback::Feedback;
use super::input::TaskInput;
use super::rows::TaskRows;
use super::vector_task::{VectorQuantity, VectorTask};
use crate::error::Error;
use crate::robot::model::Model;

/// Moves the centre of mass of all moving links to a point of the world: J_c q̇ = ċ_d + feedback(c_d − c). Up to three
/// rows, in world axes \[m/s\].
///
/// See [`PositionTask`](crate::tasks::PositionTask) for an example.
pub type CentreOfMassTask = VectorTask<CentreOfMass>;

/// The centre of mass of all links that move \[m\].
#[derive(Debug, Clone)]
pub struct CentreOfMass {
    jacobian: Matrix3xX<f64>,
}

impl CentreOfMassTask {
    /// Creates the quantity for `model`, along all axes. Set the target before the first step.
    pub fn new(model: &Model) -> Self {
        Self::of(CentreOfMass { jacobian: Matrix3xX::zeros(model.velocity_count()) })
    }
}

impl VectorQuantity for CentreOfMass {
    type Value = Point3<f64>;
    const FEEDBACK: Feedback = Feedback::LINEAR;

    fn validate(&self, model: &Model) -> Result<(), Error> {
        if model.mass() > 0.0 {
            return Ok(());
        }
        let what = format!("no link of robot `{}` that moves has a mass", model.name());
        Err(Error::unsuitable(what, "add <inertial> to its URDF"))
    }

    fn numbers(value: &Point3<f64>) -> impl Iterator<Item = f64> {
        value.coords.iter().copied()
    }

    fn value(&self, input: &TaskInput<'_, '_>) -> Result<Point3<f64>, Error> {
        Ok(input.posed().centre_of_mass())
    }

    fn difference(target: &Point3<f64>, actual: &Point3<f64>) -> Vector3<f64> {
        target - actual
    }

    fn write_jacobian(
        &mut self,
        axes: impl Iterator<Item = usize>,
        input: &mut TaskInput<'_, '_>,
        rows: &mut TaskRows<'_>,
    ) -> Result<(), Error> {
        input.posed_mut().centre_of_mass_jacobian_into(&mut self.jacobian)?;
        for (row, axis) in axes.enumerate() {
            rows.set_coefficients(row, self.jacobian.row(axis).iter());
        }
        Ok(())
    }
}
