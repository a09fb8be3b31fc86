//! Tasks that minimise a convex quadratic.

use std::any::Any;
use std::fmt::Debug;
use std::ops::Range;

use nalgebra::{DMatrix, DVector, Dim, Matrix, RawStorage};

use super::input::TaskInput;
use crate::error::{Error, check_size};
use crate::robot::model::Model;

/// Something that a robot is to do as well as it can: it minimises ½ xᵀHx + gᵀx, H symmetric and
/// positive semidefinite, x being q̇ and the further variables of the stack.
///
/// Such tasks stand on levels without rows; several on one level are added. As in
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
    /// Checks what can be checked without a state, when the task is taken into a stack.
    ///
    /// # Errors
    /// What makes the task impossible for this robot.
    fn validate(&self, _model: &Model) -> Result<(), Error> {
        Ok(())
    }

    /// Adds its H and g for a configuration.
    ///
    /// # Errors
    /// What makes the task impossible now.
    fn write(
        &mut self,
        input: &mut TaskInput<'_, '_>,
        quadratic: &mut TaskQuadratic<'_>,
    ) -> Result<(), Error>;
}

/// A clone behind a box, as [`CloneTask`](crate::tasks::CloneTask) for rows.
pub trait CloneQuadraticTask {
    /// The clone.
    fn clone_task(&self) -> Box<dyn QuadraticTask>;
}

impl<T: QuadraticTask + Clone> CloneQuadraticTask for T {
    fn clone_task(&self) -> Box<dyn QuadraticTask> {
        Box::new(self.clone())
    }
}

/// Where tasks add their quadratics: H and g of a level.
#[derive(Debug)]
pub struct TaskQuadratic<'a> {
    hessian: &'a mut DMatrix<f64>,
    gradient: &'a mut DVector<f64>,
}

impl<'a> TaskQuadratic<'a> {
    /// The quadratic zero.
    pub(crate) fn cleared(hessian: &'a mut DMatrix<f64>, gradient: &'a mut DVector<f64>) -> Self {
        hessian.as_mut_slice().fill(0.0);
        gradient.as_mut_slice().fill(0.0);
        Self { hessian, gradient }
    }

    /// Adds ½ yᵀHy + gᵀy, y being the variables of a range: 0..n for q̇, or that of
    /// [`Variables`](crate::tasks::Variables).
    ///
    /// # Errors
    /// [`Error::WrongSize`] unless H and g have the size of the range, and the range is one of the
    /// stack.
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
            let (expected, got) = (self.gradient.len(), variables.end);
            return Err(Error::WrongSize { what: "the range of variables", expected, got });
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
