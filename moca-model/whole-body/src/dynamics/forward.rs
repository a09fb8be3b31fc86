//! Forward dynamics: the motion that forces cause.

use super::external::ExternalWrench;
use crate::error::{Error, check_size};
use crate::state::moving::Moving;
use crate::state::posed::Posed;

impl Moving<'_> {
    /// The acceleration q̈ that the torques and forces `torque` and the external wrenches cause, of the size of q̇
    /// \[rad/s² or m/s²\]: M(q) q̈ = τ − C(q, q̇) q̇ − g(q) + Σ Jₖᵀ wₖ.
    ///
    /// The articulated-body algorithm (Featherstone 2008, Sec. 7.3), with the velocity-dependent part of the recursive
    /// Newton-Euler algorithm. Mimic joints cannot be eliminated one by one, so models with them factorise the mass
    /// matrix by Cholesky. Friction is left out: subtract [`friction_into`](Self::friction_into) from the torque.
    ///
    /// # Errors
    /// [`Error::Size`], [`Error::Value`], [`Error::ForeignId`]; [`Error::NoInertia`] for a
    /// joint that moves nothing.
    pub fn forward_dynamics_into(
        &mut self,
        torque: &[f64],
        external: &[ExternalWrench],
        out: &mut [f64],
    ) -> Result<(), Error> {
        let model = self.posed.model;
        model.check_velocity("τ", torque)?;
        check_size("the list of accelerations", out.len(), model.velocities)?;
        self.forces(None);
        self.posed.relieve(external)?;
        self.collect(out);
        out.iter_mut().zip(torque).for_each(|(out, torque)| *out = torque - *out);
        self.posed.divide_by_mass_matrix(out)
    }
}

impl Posed<'_> {
    pub(super) fn divide_by_mass_matrix(&mut self, b: &mut [f64]) -> Result<(), Error> {
        if self.model.mimics.is_empty() {
            return self.solve_by_articulated_bodies(b, &[]);
        }
        let mut matrix = std::mem::take(&mut self.data.scratch.mass_matrix);
        self.fill_mass_matrix(&mut matrix);
        let solved = solve_by_cholesky(&mut matrix, b);
        self.data.scratch.mass_matrix = matrix;
        solved.map_err(|pivot| self.no_inertia(pivot))
    }
}

/// Solves A x = b in place by A = L Lᵀ, stored by columns. Returns the index of the first pivot that is not positive,
/// if there is one.
fn solve_by_cholesky(a: &mut [f64], b: &mut [f64]) -> Result<(), usize> {
    let n = b.len();
    for j in 0..n {
        for k in 0..j {
            let factor = a[k * n + j];
            for i in j..n {
                a[j * n + i] -= factor * a[k * n + i];
            }
        }
        let pivot = a[j * n + j];
        if pivot <= 0.0 || pivot.is_nan() {
            return Err(j);
        }
        let root = pivot.sqrt();
        a[j * n + j..(j + 1) * n].iter_mut().for_each(|entry| *entry /= root);
    }
    for j in 0..n {
        b[j] /= a[j * n + j];
        for i in j + 1..n {
            b[i] -= a[j * n + i] * b[j];
        }
    }
    for j in (0..n).rev() {
        for i in j + 1..n {
            b[j] -= a[j * n + i] * b[i];
        }
        b[j] /= a[j * n + j];
    }
    Ok(())
}
