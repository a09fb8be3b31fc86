//! The joint-space inertia matrix.

use nalgebra::DMatrix;

use crate::error::{Error, check_size};
use crate::inertia::world::WorldInertia;
use crate::robot::description::Base;
use crate::state::posed::Posed;

impl Posed<'_> {
    /// The mass matrix M(q), symmetric and positive definite, of the size of q̇ squared. The kinetic energy is q̇ᵀ M q̇
    /// / 2.
    ///
    /// The composite-rigid-body algorithm (Walker, Orin 1982; Featherstone 2008, Sec. 6.2) in world axes. Column i
    /// holds the forces for a unit acceleration of joint i alone, which moves its whole subtree.
    ///
    /// # Errors
    /// [`Error::Size`] unless `out` is square of the size of q̇.
    pub fn mass_matrix_into(&mut self, out: &mut DMatrix<f64>) -> Result<(), Error> {
        check_size("the mass matrix's list of rows", out.nrows(), self.model.velocities)?;
        check_size("the mass matrix's list of columns", out.ncols(), self.model.velocities)?;
        self.fill_mass_matrix(out.as_mut_slice());
        Ok(())
    }

    /// Writes M by columns.
    pub(super) fn fill_mass_matrix(&mut self, out: &mut [f64]) {
        let (model, data) = (self.model, &mut *self.data);
        let size = model.velocities;
        let composites = &mut data.scratch.composites;
        let bodies = data.inertias.iter().zip(&data.poses);
        for (composite, (inertia, pose)) in composites.iter_mut().zip(bodies) {
            *composite = WorldInertia::of_body(inertia, pose);
        }
        out.fill(0.0);
        for (index, mover) in model.movers.iter().enumerate().rev() {
            let (own, pose) = (composites[index + 1], &data.poses[index + 1]);
            let mut apart = pose.position - data.poses[mover.parent].position;
            composites[mover.parent].add(&own, &apart);
            let axis = mover.ratio * pose.axis();
            let mut force = own.along(mover.motion, &axis);
            let mut add = |other: usize, value: f64| {
                let (row, column) = (other.min(mover.velocity), other.max(mover.velocity));
                out[column * size + row] += value;
            };
            add(mover.velocity, mover.motion.part(&axis, &force));
            let mut below = mover.parent;
            while let Some(carrier) = below.checked_sub(1) {
                force.angular += apart.cross(&force.linear);
                let (other, pose) = (&model.movers[carrier], &data.poses[below]);
                let value = other.ratio * other.motion.part(&pose.axis(), &force);
                // Two joints that share an entry of q̇ count in both orders on the diagonal.
                let twice = if other.velocity == mover.velocity { 2.0 } else { 1.0 };
                add(other.velocity, twice * value);
                apart = pose.position - data.poses[other.parent].position;
                below = other.parent;
            }
            if model.base == Base::Floating {
                force.angular += apart.cross(&force.linear);
                let rows = force.to_vector();
                rows.iter().enumerate().for_each(|(row, value)| add(row, *value));
            }
        }
        if model.base == Base::Floating {
            add_base(&composites[0], size, out);
        }
        for column in 1..size {
            for row in 0..column {
                out[row * size + column] = out[column * size + row];
            }
        }
    }
}

/// Writes the upper triangle of the floating base's own block, for all bodies about its origin.
fn add_base(all: &WorldInertia, size: usize, out: &mut [f64]) {
    let WorldInertia { mass, moment, inertia } = all;
    let coupling = -moment.cross_matrix();
    let inertia = inertia.to_matrix();
    for column in 0..3 {
        out[column * size + column] = *mass;
        let turning = &mut out[(column + 3) * size..];
        turning.iter_mut().zip(&coupling.column(column)).for_each(|(out, own)| *out = *own);
        let turning = turning.iter_mut().skip(3).take(column + 1);
        turning.zip(&inertia.column(column)).for_each(|(out, own)| *out = *own);
    }
}
