//! The task of staying away from singular configurations.

use ahqp_core::PoseAxes;
use nalgebra::{Matrix6, Vector3, Vector6};

use super::input::TaskInput;
use super::mask::check_weights;
use super::rows::TaskRows;
use super::task::Task;
use crate::error::Error;
use crate::kinematics::jacobian::Axes;
use crate::robot::frame::FrameId;
use crate::robot::model::Model;

/// Keeps Yoshikawa's manipulability w = √det(J Jᵀ) of a frame above a threshold by one row, ∇wᵀ q̇ ≥ gain (threshold −
/// w) (Yoshikawa, Int. J. Robotics Research 4(2), 1985). Above the threshold w may fall at a decreasing rate; below it
/// must rise.
///
/// The gradient is ∂w/∂qᵢ = w tr((J Jᵀ)⁻¹ (∂J/∂qᵢ) Jᵀ). The derivatives of J follow from its columns (Haviland and
/// Corke, "Manipulator differential kinematics, part 2", IEEE Robotics and Automation Magazine 2024, Sec. II).
#[derive(Debug, Clone)]
pub struct ManipulabilityTask {
    frame: FrameId,
    coordinates: PoseAxes,
    threshold: f64,
    gain: f64,
    weight: f64,
}

/// Share of the trace of J Jᵀ that is added to its diagonal, so that it has an inverse.
const REGULARISATION: f64 = 1e-9;

impl ManipulabilityTask {
    /// Creates a task for the position of `frame` (the unit of w is then m³/rad³), with a gain of 5 1/s.
    pub fn new(frame: FrameId, threshold: f64) -> Self {
        Self { frame, coordinates: PoseAxes::POSITION, threshold, gain: 5.0, weight: 1.0 }
    }

    /// Sets the coordinates of the frame that w is of.
    #[must_use]
    pub fn with_coordinates(mut self, coordinates: PoseAxes) -> Self {
        self.coordinates = coordinates;
        self
    }

    /// Sets the gain \[1/s\].
    #[must_use]
    pub fn with_gain(mut self, gain: f64) -> Self {
        self.gain = gain;
        self
    }

    /// Sets the weight relative to the other rows of the level.
    #[must_use]
    pub fn with_weight(mut self, weight: f64) -> Self {
        self.weight = weight;
        self
    }

    /// Returns (J Jᵀ)⁻¹ and w of the chosen coordinates. The others count as uncoupled, with ones on the diagonal.
    fn measure(&self, gram: &Matrix6<f64>) -> (Matrix6<f64>, f64) {
        let mut chosen = Matrix6::identity();
        for i in self.coordinates.iter() {
            for j in self.coordinates.iter() {
                chosen[(i, j)] = gram[(i, j)];
            }
        }
        let trace: f64 = self.coordinates.iter().map(|i| gram[(i, i)]).sum();
        for i in self.coordinates.iter() {
            chosen[(i, i)] += REGULARISATION * trace;
        }
        let Some(factor) = chosen.cholesky() else { return (Matrix6::zeros(), 0.0) };
        let measure: f64 = factor.l_dirty().diagonal().iter().product();
        (factor.inverse(), measure)
    }
}

impl Task for ManipulabilityTask {
    fn dimension(&self, _model: &Model) -> usize {
        1
    }

    fn validate(&self, model: &Model) -> Result<(), Error> {
        check_weights(&[self.weight])?;
        for (what, value) in [("the gain", self.gain), ("the threshold", self.threshold)] {
            if !(value > 0.0 && value.is_finite()) {
                return Err(Error::value(what, value, "positive and finite"));
            }
        }
        model.expect_moving(self.frame)?;
        model.expect_no_repetition(self.frame)
    }

    fn is_damped(&self) -> bool {
        false
    }

    fn write(
        &mut self,
        input: &mut TaskInput<'_, '_>,
        rows: &mut TaskRows<'_>,
    ) -> Result<(), Error> {
        let model = input.posed().model();
        let jacobian = input.jacobian(self.frame, Axes::World)?;
        let mut gram = Matrix6::zeros();
        for column in jacobian.column_iter() {
            gram += column * column.transpose();
        }
        let (mut inverse, measure) = self.measure(&gram);
        for i in 0..6 {
            if !self.coordinates.iter().any(|axis| axis == i) {
                inverse.row_mut(i).fill(0.0);
                inverse.column_mut(i).fill(0.0);
            }
        }
        let column = |index: usize| -> Vector6<f64> { jacobian.column(index).into_owned() };
        let angular = |twist: &Vector6<f64>| -> Vector3<f64> { twist.fixed_rows::<3>(3).into() };
        let linear = |twist: &Vector6<f64>| -> Vector3<f64> { twist.fixed_rows::<3>(0).into() };
        // The loop goes from the frame to the root, so that later joints move earlier ones. The entries of a floating
        // base all rotate about the world's axes.
        for (place, i) in model.moved_by(self.frame)?.enumerate() {
            if model.is_base_entry(i) && i < 3 {
                continue; // The whole robot moves along.
            }
            let own = column(i);
            let mut slope = 0.0;
            for (other, j) in model.moved_by(self.frame)?.enumerate() {
                let moved = column(j);
                let carries = place >= other && !model.is_base_entry(j);
                let change = if carries {
                    let (along, about) = (linear(&moved), angular(&moved));
                    stack(&angular(&own).cross(&along), &angular(&own).cross(&about))
                } else {
                    stack(&angular(&moved).cross(&linear(&own)), &Vector3::zeros())
                };
                slope += change.dot(&(inverse * moved));
            }
            if let Some(entry) = rows.row_mut(0).get_mut(i) {
                *entry = measure * slope;
            }
        }
        rows.set_range(0, self.gain * (self.threshold - measure), f64::INFINITY);
        rows.set_weight(0, self.weight);
        Ok(())
    }
}

fn stack(linear: &Vector3<f64>, angular: &Vector3<f64>) -> Vector6<f64> {
    Vector6::new(linear.x, linear.y, linear.z, angular.x, angular.y, angular.z)
}
