//! The trait that all tasks share.

use std::any::Any;
use std::fmt::Debug;

use super::curvature::Curvature;
use super::input::TaskInput;
use super::rows::TaskRows;
use crate::error::Error;
use crate::robot::model::Model;

/// Something that a robot is to do: rows `lower ≤ A q̇ ≤ upper`, of which a level minimises the
/// violation in the least-squares sense.
///
/// The tasks of this crate implement it, and so can yours. [`write`](Self::write) runs in the
/// control loop: it must not allocate, lock or wait.
///
/// ```
/// use whole_body::tasks::{TaskInput, TaskRows};
/// use whole_body::{Axes, Error, FrameId, Model, Task};
///
/// /// Keeps a frame above the height z = 0.
/// #[derive(Debug, Clone)]
/// struct AboveTheFloor(FrameId);
///
/// impl Task for AboveTheFloor {
///     fn dimension(&self, _model: &Model) -> usize {
///         1
///     }
///
///     fn write(&mut self, input: &mut TaskInput<'_, '_>, rows: &mut TaskRows<'_>) -> Result<(), Error> {
///         let height = input.posed().placement(self.0)?.translation.z;
///         rows.set_coefficients(0, input.jacobian(self.0, Axes::World)?.row(2).iter());
///         rows.set_range(0, -10.0 * height, f64::INFINITY); // ż ≥ −10 z
///         Ok(())
///     }
/// }
/// ```
pub trait Task: Any + CloneTask + Debug + Send + Sync {
    /// How many rows it writes for this robot; it must not change afterwards.
    fn dimension(&self, model: &Model) -> usize;

    /// Checks what can be checked without a state, when the task is taken into a stack.
    ///
    /// # Errors
    /// What makes the task impossible for this robot.
    fn validate(&self, _model: &Model) -> Result<(), Error> {
        Ok(())
    }

    /// Whether its rows may come to depend on each other, or on those of levels above, at singular
    /// configurations. Targets of such rows are damped there. True unless a task says otherwise.
    fn is_damped(&self) -> bool {
        true
    }

    /// Whether its rows, as hard limits, leave accelerations the time to fade where jerks are limited.
    /// Those of other limits are narrowed so that they do.
    fn anticipates(&self) -> bool {
        false
    }

    /// Whether its rows, as hard limits, let a planar base move along its heading alone. The base is then kept
    /// able to stop without sliding.
    fn keeps_heading(&self) -> bool {
        false
    }

    /// Whether it [adds its curvature](Self::add_curvature). Levels of tasks that all do take the
    /// ends of their reach for what they are; others treat all singular configurations as such ends.
    fn has_curvature(&self) -> bool {
        false
    }

    /// Adds −Σ λᵢ ∇²yᵢ, yᵢ being what row i controls and λᵢ its factor, for the robot where the rows
    /// were written last.
    ///
    /// # Errors
    /// What makes the task impossible now.
    fn add_curvature(
        &self,
        _factors: &[f64],
        _input: &mut TaskInput<'_, '_>,
        _curvature: &mut Curvature,
    ) -> Result<(), Error> {
        Ok(())
    }

    /// Whether it writes every coefficient, bound and weight of rows over so many variables. They may then be
    /// anything when [`write`](Self::write) is called. False unless a task says otherwise.
    fn writes_all(&self, _variables: usize) -> bool {
        false
    }

    /// Takes what it finds for its target, unless it has one; see
    /// [`IkBuilder::build_at`](crate::ik::IkBuilder::build_at). A task without a target does nothing.
    ///
    /// # Errors
    /// What keeps it from finding it.
    fn hold(&mut self, _input: &mut TaskInput<'_, '_>) -> Result<(), Error> {
        Ok(())
    }

    /// Writes its rows for a configuration. They are zero, with targets of zero and weights of one,
    /// when this is called, unless it [writes all](Self::writes_all).
    ///
    /// # Errors
    /// What makes the task impossible now, such as a target that was never set.
    fn write(
        &mut self,
        input: &mut TaskInput<'_, '_>,
        rows: &mut TaskRows<'_>,
    ) -> Result<(), Error>;
}

/// A clone behind a box, for stacks that are cloned. Every task that is [`Clone`] has it.
pub trait CloneTask {
    /// The clone.
    fn clone_task(&self) -> Box<dyn Task>;
}

impl<T: Task + Clone> CloneTask for T {
    fn clone_task(&self) -> Box<dyn Task> {
        Box::new(self.clone())
    }
}

/// A task whose rows always admit rest, lower ≤ 0 ≤ upper, so that it can be a hard limit too; see
/// [`IkBuilder::limit`](crate::ik::IkBuilder::limit).
pub trait Limit: Task {}
