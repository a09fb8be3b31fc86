//! The centre of mass at a point.

use nalgebra::{Matrix3xX, Point3, Vector3};

use super::feedback::Feedback;
use super::input::TaskInput;
use super::mask::{Axis, VectorMask};
use super::rows::TaskRows;
use super::task::Task;
use crate::error::{Error, check_finite};
use crate::robot::model::Model;

/// Brings the centre of mass of all links that move to a point of the world: J_c q̇ = ċ_d +
/// feedback(c_d − c). Up to three rows, in world axes \[m/s\].
#[derive(Debug, Clone)]
pub struct CentreOfMassTask {
    target: Option<(Point3<f64>, Vector3<f64>)>,
    feedback: Feedback,
    mask: VectorMask,
    jacobian: Matrix3xX<f64>,
}

impl CentreOfMassTask {
    /// Of `model`, along all axes; the target is to be set before the first step.
    pub fn new(model: &Model) -> Self {
        Self {
            target: None,
            feedback: Feedback::LINEAR,
            mask: VectorMask::default(),
            jacobian: Matrix3xX::zeros(model.velocity_count()),
        }
    }

    /// With this gain \[1/s\] instead of that of [`Feedback::LINEAR`].
    #[must_use]
    pub fn with_gain(mut self, gain: f64) -> Self {
        self.feedback.gain = gain;
        self
    }

    /// With this feedback instead of [`Feedback::LINEAR`].
    #[must_use]
    pub fn with_feedback(mut self, feedback: Feedback) -> Self {
        self.feedback = feedback;
        self
    }

    /// Along these axes of the world only: x and y to stay above the feet.
    #[must_use]
    pub fn with_axes(mut self, axes: &[Axis]) -> Self {
        self.mask.choose(axes);
        self
    }

    /// With weights of the three axes against the other rows of the level.
    #[must_use]
    pub fn with_weights(mut self, weights: Vector3<f64>) -> Self {
        self.mask.weights = weights;
        self
    }

    /// Where the centre of mass is to be \[m\].
    ///
    /// # Errors
    /// [`Error::NotFinite`]; the target is then as before.
    pub fn set_target(&mut self, position: Point3<f64>) -> Result<(), Error> {
        self.set_moving_target(position, Vector3::zeros())
    }

    /// Where the centre of mass is to be \[m\], and how fast that place moves \[m/s\].
    ///
    /// # Errors
    /// [`Error::NotFinite`]; the target is then as before.
    pub fn set_moving_target(
        &mut self,
        position: Point3<f64>,
        velocity: Vector3<f64>,
    ) -> Result<(), Error> {
        for value in position.coords.iter().chain(&velocity) {
            check_finite(*value, || "a coordinate of the target".to_owned())?;
        }
        self.target = Some((position, velocity));
        Ok(())
    }
}

impl Task for CentreOfMassTask {
    fn dimension(&self, _model: &Model) -> usize {
        self.mask.len()
    }

    fn validate(&self, model: &Model) -> Result<(), Error> {
        self.feedback.validate()?;
        self.mask.validate()?;
        if model.mass() > 0.0 { Ok(()) } else { Err(Error::NoMass { robot: model.name().into() }) }
    }

    fn write(
        &mut self,
        input: &mut TaskInput<'_, '_>,
        rows: &mut TaskRows<'_>,
    ) -> Result<(), Error> {
        let (target, velocity) = self.target.ok_or(Error::TargetMissing)?;
        self.feedback.check_period(input.period())?;
        let error = self.mask.apply(&(target - input.posed().centre_of_mass()));
        let velocity = velocity + self.feedback.velocity(&error);
        input.posed_mut().centre_of_mass_jacobian_into(&mut self.jacobian)?;
        for (row, axis) in self.mask.iter().enumerate() {
            rows.set_coefficients(row, self.jacobian.row(axis).iter());
            rows.set_target(row, velocity[axis]);
            rows.set_weight(row, self.mask.weights[axis]);
        }
        Ok(())
    }
}
