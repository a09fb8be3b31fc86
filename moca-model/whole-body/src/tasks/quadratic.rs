//! The trait of tasks that minimise a convex quadratic.

use std::any::Any;
use std::fmt::Debug;
use std::ops::Range;

use nalgebra::{DMatrix, DVector, Dim, Matrix, RawStorage};

use super::input::TaskInput;
use crate::error::{Error, check_size};
use crate::robot::model::Model;

/// A task that minimises ½ xᵀHx + gᵀx with H symmetric and positive semidefinite. The vector x is q̇ and the further
/// variables of the stack.
///
/// Such tasks need levels without rows. The quadratics of one level are added. As in
/// [`Task::write`](crate::Task::write), writing must not allocate, lock or wait.
///
/// ```
/// use nalgebra::{DMatrix, DVector};
/// use whole_body::tasks::{QuadraticTask, TaskInput, TaskQuadratic};
/// use whole_body::{Error, Model};
///
/// /// Least kinetic energy ½ q̇ᵀ M q̇.
/// #[derive(Debug, Clone)]
/// struct LeastEnergy { mass: DMatrix<f64>, none: DVector<f64> }
///
/// impl QuadraticTask for LeastEnergy {
///     fn write(
///         &mut self,
///         input: &mut TaskInput<'_, '_>,
///         quadratic: &mut TaskQuadratic<'_>,
///     ) -> Result<(), Error> {
///         input.posed_mut().mass_matrix_into(&mut self.mass)?;
///         quadratic.add(0..self.none.len(), &self.mass, &self.none)
///     }
/// }
/// ```
pub trait QuadraticTask: Any + CloneQuadraticTask + Debug + Send + Sync {
    /// Checks what does not depend on a state, when the task is added to a stack.
    ///
    /// # Errors
    /// The reason why this robot cannot do the task.
    fn validate(&self, _model: &Model) -> Result<(), Error> {
        Ok(())
    }

    /// Adds its H and g for a configuration.
    ///
    /// # Errors
    /// The reason why the task is impossible now.
    fn write(
        &mut self,
        input: &mut TaskInput<'_, '_>,
        quadratic: &mut TaskQuadratic<'_>,
    ) -> Result<(), Error>;
}

/// Clones behind a box, as [`CloneTask`](crate::tasks::CloneTask) does for tasks of rows.
pub trait CloneQuadraticTask {
    /// The clone.
    fn clone_task(&self) -> Box<dyn QuadraticTask>;
}

impl<T: QuadraticTask + Clone> CloneQuadraticTask for T {
    fn clone_task(&self) -> Box<dyn QuadraticTask> {
        Box::new(self.clone())
    }
}

/// Access to H and g of a level, to which tasks add their quadratics.
#[derive(Debug)]
pub struct TaskQuadratic<'a> {
    hessian: &'a mut DMatrix<f64>,
    gradient: &'a mut DVector<f64>,
}

impl<'a> TaskQuadratic<'a> {
    /// Sets the quadratic to zero.
    pub(crate) fn cleared(hessian: &'a mut DMatrix<f64>, gradient: &'a mut DVector<f64>) -> Self {
        hessian.as_mut_slice().fill(0.0);
        gradient.as_mut_slice().fill(0.0);
        Self { hessian, gradient }
    }

    /// Adds ½ yᵀHy + gᵀy, where y are the variables of a range: 0..n for q̇, or the range of
    /// [`Variables`](crate::tasks::Variables).
    ///
    /// # Errors
    /// [`Error::Size`] unless H and g have the size of the range and the stack has these variables.
    pub fn add<R, C, S, G, T>(
        &mut self,
        variables: Range<usize>,
        hessian: &Matrix<f64, R, C, S>,
        gradient: &Matrix<f64, G, nalgebra::U1, T>,
    ) -> Result<(), Error>
    where
        R: Dim,
        C: Dim,
        S: RawStorage<f64, R, C>,
        G: Dim,
        T: RawStorage<f64, G>,
    {
        let size = variables.len();
        check_size("the rows of the Hessian", hessian.nrows(), size)?;
        check_size("the columns of the Hessian", hessian.ncols(), size)?;
        check_size("the gradient", gradient.nrows(), size)?;
        let first = variables.start;
        if variables.end > self.gradient.len() {
            let (got, wanted) = (variables.end, self.gradient.len());
            return Err(Error::Size { what: "the range of variables", got, wanted });
        }
        for column in 0..size {
            for row in 0..size {
                self.hessian[(first + row, first + column)] += hessian[(row, column)];
            }
            self.gradient[first + column] += gradient[column];
        }
        Ok(())
    }
}
