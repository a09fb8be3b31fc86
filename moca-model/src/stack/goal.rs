//! The objective of the third level.

use ergo_map::ErgonomicsQuadratic;
use nalgebra::{Matrix6, Vector3, Vector6};
use whole_body::tasks::{QuadraticTask, TaskInput, TaskQuadratic, Variables};

use crate::error::Error;

/// The objective of the third level.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct GoalTerms<'a> {
    /// The person's ergonomics in the world, τ seconds ahead.
    pub(crate) ergonomics: Option<&'a ErgonomicsQuadratic>,
    /// Velocity of the walking person in world axes \[m/s\]. It is fed forward, so that the optimum does not lag
    /// behind.
    pub(crate) drift: Vector3<f64>,
    /// Weight from 0, the benchmark min ‖ẋ_d‖², to 1, ergonomics alone.
    pub(crate) activation: f64,
}

/// activation · e_s(x_d + τ (ẋ_d − drift)) + (1 − activation) ‖ẋ_d‖², over ẋ_d.
///
/// A single level changes its weights, so that the solution does not jump, as it would if two levels changed places.
#[derive(Debug, Clone)]
pub(super) struct GoalTask {
    desired_twist: Variables,
    horizon: f64,
    hessian: Matrix6<f64>,
    gradient: Vector6<f64>,
}

impl GoalTask {
    pub(super) fn new(desired_twist: Variables, horizon: f64) -> Self {
        let (hessian, gradient) = (Matrix6::zeros(), Vector6::zeros());
        Self { desired_twist, horizon, hessian, gradient }
    }

    /// Sets the objective for a desired pose at `desired` \[m\].
    pub(super) fn set(
        &mut self,
        goal: &GoalTerms<'_>,
        desired: &Vector3<f64>,
    ) -> Result<(), Error> {
        (self.hessian, self.gradient) = (Matrix6::zeros(), Vector6::zeros());
        let mut share = 0.0;
        if let Some(quadratic) = goal.ergonomics
            && goal.activation > 0.0
        {
            share = goal.activation.min(1.0);
            let ahead = desired - goal.drift * self.horizon;
            let terms = quadratic.task_terms(&ahead, self.horizon)?;
            self.hessian.fixed_view_mut::<3, 3>(0, 0).copy_from(&(share * terms.hessian));
            self.gradient.fixed_rows_mut::<3>(0).copy_from(&(share * terms.gradient));
        }
        for axis in 0..6 {
            self.hessian[(axis, axis)] += 2.0 * (1.0 - share);
        }
        Ok(())
    }
}

impl QuadraticTask for GoalTask {
    fn write(
        &mut self,
        _input: &mut TaskInput<'_, '_>,
        quadratic: &mut TaskQuadratic<'_>,
    ) -> Result<(), whole_body::Error> {
        quadratic.add(self.desired_twist.range(), &self.hessian, &self.gradient)
    }
}
