//! Softening by slack, so that no motion of the workspace makes the problem infeasible.

use ahqp_core::{AugmentedState, Level, Rows};
use nalgebra::{DMatrix, DVector, Isometry3, Vector6};

use crate::error::{Error, check_pose, check_size, not_negative, positive};
use crate::rows::PoseRow;
use crate::workspace::Workspace;

/// Softening of a workspace by one slack for each coordinate, shared by all rows that the
/// coordinate affects (the paper's Sec. III-C). The shape grows by the box of half-widths s.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Softening {
    /// Costs of the slacks, by coordinate of the workspace \[1/m², 1/rad²\]. Default 1.
    pub weights: Vector6<f64>,
    /// Margin inside the bounds that is kept to the pose \[m or rad\], since the frame is not known
    /// exactly. The slack includes the violation of the margin. A shape narrower than both margins
    /// keeps the pose to its middle. Default 0.
    pub margin: f64,
    /// Room for rows of the position. A change between two kinds of shape needs as many as both
    /// together. Default 6, a box.
    pub position_rows: usize,
}

/// Room for rows of the orientation: a box.
const ORIENTATION_ROWS: usize = 6;

impl Default for Softening {
    fn default() -> Self {
        Self { weights: Vector6::repeat(1.0), margin: 0.0, position_rows: 6 }
    }
}

/// The level min ½ Σ wᵢsᵢ² subject to the rows of the workspace, each relaxed by the slack. Its
/// place in the hierarchy is the caller's choice.
///
/// The rows of boxes are z_min − s ≤ z ≤ z_max + s (the paper's Sec. III-C). The excess e of each
/// row is predicted by τ seconds, e + τ (gradient · ẋ_d + drift). The drift feeds the velocity of
/// the workspace forward.
///
/// The paper uses τ = Δt, which demands the optimum within one tick. A larger horizon approaches
/// the bounds with the time constant τ. To leave room for braking, τ must be at least the velocity
/// limit of ẋ_d over its acceleration limit.
///
/// ```
/// use ahqp_core::AugmentedState;
/// use hrsw::{Bounds, SoftWorkspace, Softening, Workspace};
/// use nalgebra::{Isometry3, Vector3};
///
/// let state = AugmentedState { joints: 10, task: 6, slack: 6 };
/// let soft = SoftWorkspace::new(state, 0.2, Softening::default())?;
/// let mut level = soft.level()?;
/// let workspace = Workspace::new(
///     Isometry3::identity(),
///     Bounds::symmetric(Vector3::repeat(0.5))?,
///     Bounds::symmetric(Vector3::repeat(0.2))?,
/// )?;
/// soft.write_rows(&workspace, &Isometry3::identity(), level.constraints_mut())?;
/// assert_eq!(level.constraints().len(), 12);
/// # Ok::<(), hrsw::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SoftWorkspace {
    state: AugmentedState,
    horizon: f64,
    softening: Softening,
}

impl SoftWorkspace {
    /// Creates a level for the layout of χ and the horizon τ \[s\]. The default softening is the
    /// paper's, for boxes.
    ///
    /// # Errors
    /// [`Error::Size`] unless the task has 6 dimensions and 6 slacks. [`Error::Value`] if the horizon
    /// or a weight is not positive.
    pub fn new(state: AugmentedState, horizon: f64, softening: Softening) -> Result<Self, Error> {
        check_size("the task of the augmented state", state.task, 6)?;
        check_size("the slack of the augmented state", state.slack, 6)?;
        for &weight in &softening.weights {
            positive("a weight of the slack", weight)?;
        }
        not_negative("the margin of the slack", softening.margin)?;
        Ok(Self { state, horizon: positive("the horizon", horizon)?, softening })
    }

    /// Number of rows of a level.
    pub fn capacity(&self) -> usize {
        self.softening.position_rows + ORIENTATION_ROWS
    }

    /// Creates the level, whose rows are still to be written.
    ///
    /// # Errors
    /// [`Error::Hierarchy`] if a weight is not from 1e-100 to 1e100.
    pub fn level(&self) -> Result<Level, Error> {
        let rows = free_rows(self.capacity(), self.state.len());
        let slack = self.state.slack();
        let mut selection = DMatrix::zeros(slack.len(), self.state.len());
        for (i, j) in slack.clone().enumerate() {
            selection[(i, j)] = 1.0;
        }
        let mut objective = Rows::equalities(&selection, &DVector::zeros(slack.len()))?;
        objective.set_weights(&self.softening.weights)?;
        Ok(Level::least_squares(objective).with_constraints(rows))
    }

    /// Writes the rows τ gradient · ẋ_d − |axes| · s ≤ −excess − τ drift for the desired pose
    /// x_d(t−1) into [`capacity`](Self::capacity) constraints, those of [`level`](Self::level) or
    /// others. Boxes have the rows of the paper's Sec. III-C.
    ///
    /// # Errors
    /// [`Error::Value`] if the desired pose is invalid. [`Error::TooMany`] if the workspace has
    /// more rows than there is room for. [`Error::Size`] or [`Error::Hierarchy`] if the constraints
    /// are other ones.
    pub fn write_rows(
        &self,
        workspace: &Workspace,
        desired: &Isometry3<f64>,
        rows: &mut Rows,
    ) -> Result<(), Error> {
        check_pose(desired)?;
        self.check_room(workspace)?;
        check_size("the level's rows", rows.len(), self.capacity())?;
        check_size("the level's columns", rows.columns(), self.state.len())?;
        rows.set_free();
        for index in 0..rows.len() {
            rows.row_mut(index)?.fill(0.0);
        }
        for (index, row) in workspace.rows(desired).enumerate() {
            self.write_row(&row, rows, index)?;
        }
        Ok(())
    }

    fn check_room(&self, workspace: &Workspace) -> Result<(), Error> {
        let (positions, orientations) = workspace.row_counts();
        for (what, got, most) in [
            ("rows of the position", positions, self.softening.position_rows),
            ("rows of the orientation", orientations, ORIENTATION_ROWS),
        ] {
            if got > most {
                return Err(Error::TooMany { what, got, most });
            }
        }
        Ok(())
    }

    fn write_row(&self, row: &PoseRow, rows: &mut Rows, index: usize) -> Result<(), Error> {
        let velocity = self.state.desired_velocity();
        let out = rows.row_mut(index)?;
        for (out, gradient) in out[velocity].iter_mut().zip(&row.gradient) {
            *out = self.horizon * gradient;
        }
        for (out, part) in out[self.state.slack()].iter_mut().zip(&row.axes) {
            *out = -part.abs();
        }
        // The gradient of a row that fades out fades too.
        let margin = self.softening.margin * row.gradient.norm();
        rows.upper_mut()[index] = -(row.excess + margin + self.horizon * row.drift);
        Ok(())
    }
}

/// Creates rows that bound nothing.
fn free_rows(rows: usize, columns: usize) -> Rows {
    let mut rows = Rows::zeros(rows, columns);
    rows.set_free();
    rows
}
