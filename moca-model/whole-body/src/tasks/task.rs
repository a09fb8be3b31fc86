//! The trait of tasks that write rows.

use std::any::Any;
use std::fmt::Debug;

use super::curvature::Curvature;
use super::input::TaskInput;
use super::rows::TaskRows;
use crate::error::Error;
use crate::robot::model::Model;

/// A task of rows `lower ≤ A q̇ ≤ upper`. A level minimises their violation in the least-squares sense.
///
/// The tasks of this crate implement it, and so can your own. [`write`](Self::write) runs in the control loop: it must
/// not allocate, lock or wait.
///
/// ```
/// use whole_body::tasks::{PostureTask, TaskInput, TaskRows};
/// use whole_body::{Axes, Description, Error, FrameId, Ik, Model, Task};
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
///
/// let model = Model::from_urdf_file("examples/urdf/panda.urdf", &Description::default())?;
/// let mut builder = Ik::builder(&model);
/// builder.push("above the floor", AboveTheFloor(model.frame_id("panda_hand_tcp")?));
/// builder.push("posture", PostureTask::new());
/// let ik = builder.build_at(&model.neutral())?;
/// # Ok::<(), Error>(())
/// ```
pub trait Task: Any + CloneTask + Debug + Send + Sync {
    /// The number of rows that it writes for this robot, which must not change.
    fn dimension(&self, model: &Model) -> usize;

    /// Checks what does not depend on a state, when the task is added to a stack.
    ///
    /// # Errors
    /// The reason why this robot cannot do the task.
    fn validate(&self, _model: &Model) -> Result<(), Error> {
        Ok(())
    }

    /// True if its rows may become dependent at singular configurations, on each other or on rows of levels above.
    /// Targets of such rows are damped there. The default is true.
    fn is_damped(&self) -> bool {
        true
    }

    /// True if its rows, as hard limits, leave accelerations the time to fade under jerk limits. Rows of other limits
    /// are narrowed so that they do.
    fn anticipates(&self) -> bool {
        false
    }

    /// True if its rows, as hard limits, restrict a planar base to motion along its heading. The base then stays able
    /// to stop without sliding.
    fn keeps_heading(&self) -> bool {
        false
    }

    /// True if it [adds its curvature](Self::add_curvature). A level whose tasks all do so distinguishes the ends of
    /// its reach from other singular configurations. Other levels treat all singular configurations alike.
    fn has_curvature(&self) -> bool {
        false
    }

    /// Adds −Σ λᵢ ∇²yᵢ, where yᵢ is what row i controls and λᵢ its factor. The robot is where the rows were written
    /// last.
    ///
    /// # Errors
    /// The reason why the task is impossible now.
    fn add_curvature(
        &self,
        _factors: &[f64],
        _input: &mut TaskInput<'_, '_>,
        _curvature: &mut Curvature,
    ) -> Result<(), Error> {
        Ok(())
    }

    /// True if it writes every coefficient, bound and weight of rows over this number of variables. Rows may then have
    /// any content when [`write`](Self::write) is called. The default is false.
    fn writes_all(&self, _variables: usize) -> bool {
        false
    }

    /// Sets the target to the present state, unless it has one; see
    /// [`IkBuilder::build_at`](crate::ik::IkBuilder::build_at). A task without a target does nothing.
    ///
    /// # Errors
    /// The reason why it cannot find it.
    fn hold(&mut self, _input: &mut TaskInput<'_, '_>) -> Result<(), Error> {
        Ok(())
    }

    /// Writes its rows for a configuration. The rows are zero before, with targets of zero and weights of one, unless
    /// it [writes all](Self::writes_all).
    ///
    /// # Errors
    /// The reason why the task is impossible now, such as a target that was never set.
    fn write(
        &mut self,
        input: &mut TaskInput<'_, '_>,
        rows: &mut TaskRows<'_>,
    ) -> Result<(), Error>;
}

/// Clones behind a box, for stacks that are cloned. Every task that is [`Clone`] implements it.
pub trait CloneTask {
    /// The clone.
    fn clone_task(&self) -> Box<dyn Task>;
}

impl<T: Task + Clone> CloneTask for T {
    fn clone_task(&self) -> Box<dyn Task> {
        Box::new(self.clone())
    }
}

/// A task whose rows always admit rest, lower ≤ 0 ≤ upper, or that all joints brake. It can therefore also be a hard
/// limit; see [`IkBuilder::limit`](crate::ik::IkBuilder::limit).
pub trait Limit: Task {}
