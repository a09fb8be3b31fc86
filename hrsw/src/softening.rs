//! Softening by the slack s, so that no motion of the workspace makes the problem infeasible.

use ahqp_core::{AugmentedState, Level, Rows};
use nalgebra::{DMatrix, DVector, Isometry3};

use crate::error::{Error, positive};
use crate::workspace::Workspace;

/// The level min ½‖s‖² subject to z_min − s ≤ z ≤ z_max + s (the paper's eqs. 9 and 10), one
/// slack a coordinate, shared by its two sides.
///
/// z is taken τ seconds ahead, z(t) ≈ z(t−1) + τ M (ẋ_d − drift), with the velocity of the
/// workspace fed forward. With τ = Δt this is the paper's form, which asks for the optimum
/// within one tick; a larger horizon approaches the bounds with the time constant τ. To leave
/// room to brake, τ must be at least the velocity limit over the acceleration limit of ẋ_d.
///
/// ```
/// use ahqp_core::AugmentedState;
/// use hrsw::{Bounds, SoftWorkspace, Workspace};
/// use nalgebra::{Isometry3, Vector3};
///
/// let state = AugmentedState { joints: 10, task: 6, slack: 6 };
/// let soft = SoftWorkspace::new(state, 0.2)?;
/// let mut level = soft.level()?;
/// let workspace = Workspace::new(
///     Isometry3::identity(),
///     Bounds::symmetric(Vector3::repeat(0.5))?,
///     Bounds::symmetric(Vector3::repeat(0.2))?,
/// )?;
/// soft.write(&workspace, &Isometry3::identity(), &mut level)?;
/// assert_eq!(level.constraints().len(), 12);
/// # Ok::<(), hrsw::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SoftWorkspace {
    state: AugmentedState,
    horizon: f64,
}

impl SoftWorkspace {
    /// With the layout of χ and the horizon τ \[s\].
    ///
    /// # Errors
    /// [`Error::State`] unless the task has 6 dimensions and 6 slacks; [`Error::Parameter`] for
    /// a horizon that is not positive.
    pub fn new(state: AugmentedState, horizon: f64) -> Result<Self, Error> {
        for (what, found) in [("task dimensions", state.task), ("slack variables", state.slack)] {
            if found != 6 {
                return Err(Error::State { what, found, expected: 6 });
            }
        }
        Ok(Self { state, horizon: positive("the horizon", horizon)? })
    }

    /// The level, its constraints still to be written.
    ///
    /// # Errors
    /// None for a state that [`new`](Self::new) accepts.
    pub fn level(&self) -> Result<Level, Error> {
        let slack = self.state.slack();
        let mut selection = DMatrix::zeros(slack.len(), self.state.len());
        for (i, j) in slack.clone().enumerate() {
            selection[(i, j)] = 1.0;
        }
        let objective = Rows::equalities(&selection, &DVector::zeros(slack.len()))?;
        let constraints = Rows::zeros(2 * slack.len(), self.state.len());
        Ok(Level::least_squares(objective).with_constraints(constraints))
    }

    /// Writes the rows [0 τM −I] χ ≤ z_max − z + τM drift and [0 −τM −I] χ ≤ z − z_min − τM drift
    /// for the desired pose x_d(t−1) into a level made by [`level`](Self::level).
    ///
    /// # Errors
    /// [`Error::NotFinite`] for a desired pose that is not finite.
    pub fn write(
        &self,
        workspace: &Workspace,
        desired: &Isometry3<f64>,
        level: &mut Level,
    ) -> Result<(), Error> {
        crate::workspace::check_pose(desired)?;
        let z = workspace.coordinates(desired);
        let (matrix, drift) = workspace.rates(desired);
        let ahead = matrix * self.horizon;
        let moved = ahead * drift;
        let (min, max) = workspace.coordinate_bounds();
        let (velocity, slack) = (self.state.desired_velocity().start, self.state.slack().start);
        let rows = level.constraints_mut();
        for side in 0..2 {
            let sign = if side == 0 { 1.0 } else { -1.0 };
            for i in 0..6 {
                let index = 6 * side + i;
                if let Some(row) = rows.row_mut(index) {
                    row.fill(0.0);
                    for j in 0..6 {
                        row[velocity + j] = sign * ahead[(i, j)];
                    }
                    row[slack + i] = -1.0;
                }
                let bound = if side == 0 { max[i] } else { -min[i] };
                rows.lower_mut()[index] = f64::NEG_INFINITY;
                rows.upper_mut()[index] = bound - sign * (z[i] - moved[i]);
            }
        }
        Ok(())
    }
}
